"""Limits that no key has alone: what cannot be computed is refused by its key."""

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.asperities.ranges import GAP_LOW
from gearidae.errors import SceneError
from gearidae.scene.limits import MOST_PAIRS, check_reach, pairs_within_reach
from reference.random_scenes import random_scene

LOW = gd.preset("teodorescu2009_low_speed")


def test_pairs_within_reach_are_those_that_geometry_brings_near():
    """Counted one by one: pairs whose relief is less than the depth of the tables, over a pitch of the mesh's turn."""
    scene = LOW.replace({"mesh.tip_relief_radius": "30 mm"})
    geometry, sigma = scene.geometry, scene.surface.roughness
    place = np.arange(-200, 201) * geometry.base_pitch
    outside = np.maximum(0.0, np.maximum(-place, place - geometry.path_length))
    near = outside**2 / (2.0 * scene.mesh.tip_relief_radius) < -GAP_LOW * sigma
    assert abs(np.count_nonzero(near) - pairs_within_reach(scene, 0.0)) <= 1.0


def test_the_relief_that_a_refusal_names_is_the_limit():
    with pytest.raises(SceneError, match=r"tip_relief_radius.*pairs would be in touch") as caught:
        LOW.replace({"mesh.tip_relief_radius": 0.5})
    most = float(caught.value.allowed.split("must be below ")[1].split(" m")[0])
    assert pairs_within_reach(LOW.replace({"mesh.tip_relief_radius": 0.99 * most}), 0.0) < MOST_PAIRS
    with pytest.raises(SceneError):
        LOW.replace({"mesh.tip_relief_radius": 1.01 * most})


def test_a_larger_cut_off_brings_more_pairs_within_reach():
    scene = LOW.replace({"mesh.tip_relief_radius": "55 mm"})
    check_reach(scene)
    with pytest.raises(SceneError, match="tip_relief_radius"):
        check_reach(scene, cutoff=13.0)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"surface.roughness": 1e-12, "coating.sam_fraction": 0.0}, "surface.roughness"),
        ({"surface.youngs_modulus": 1e3, "coating.sam_fraction": 0.0}, "surface.roughness"),
        ({"gears.pinion_base_radius": 0.9, "gears.pinion_teeth": 30, "mesh.backlash": 0.09, "surface.roughness": 1e-11,
          "contact.asperity": "hertz"}, "mesh.backlash"),
        ({"initial.gap": 1e-23}, "initial.gap"),
    ],
)  # fmt: skip
def test_what_cannot_be_computed_names_its_key(changes, key):
    with pytest.raises(SceneError) as caught:
        LOW.replace(changes)
    assert caught.value.key == key


@pytest.mark.parametrize("key", ["roller.radius", "roller.width", "roller.mass"])
def test_a_roller_of_no_size_is_refused(key):
    """A radius or width of 1e-300 m would hang."""
    with pytest.raises(SceneError, match=key):
        gd.preset("roller_slow").replace({key: 1e-300})


def test_only_laws_that_stretch_have_a_limit_of_stretch():
    soft = {"surface.roughness": 1e-12, "contact.asperity": "hertz", "initial.gap": 1e-8}
    assert LOW.replace(soft).surface.roughness == 1e-12


def test_knots_may_jump_within_a_step_but_no_closer_than_a_double_can_step():
    LOW.replace({"drive.schedule": [[0.1, 1e-18], [0.1 + 1e-12, 2e-18]]})
    with pytest.raises(SceneError, match="too close to step between"):
        LOW.replace({"drive.schedule": [[0.1, 1e-18], [math.nextafter(0.1, 1.0), 2e-18]]})


@pytest.mark.parametrize("number", range(0, 60, 7))
def test_limits_leave_the_random_scenes_alone(number):
    scene = random_scene(1, number)
    assert scene.from_dict(scene.to_dict()) == scene
