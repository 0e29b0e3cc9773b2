"""Keys of friction: defaults, units, and what does not go together."""

from __future__ import annotations

import math
from typing import Any

import pytest

import gearidae as gd
from gearidae.runs.rubbing import sliding
from gearidae.scene.friction import friction_values, has_flank_friction
from gearidae.scene.joints import has_joint_friction, joints

HIGH = gd.preset("teodorescu2009")
ENGINE = {"name": "microengine", "radius": 1e-5, "force": 1e-5, "frequency": 600.0}
HUBS = {"gears.pinion_hub_radius": "3 um", "gears.gear_hub_radius": "6 um"}


def test_presets_have_no_friction() -> None:
    for name in ("teodorescu2009", "teodorescu2009_low_speed", "roller_slow"):
        scene = gd.preset(name)
        assert friction_values(scene) == {"bare": 0.0, "coated": 0.0, "mixed": 0.0}
        assert not has_flank_friction(scene)
        assert not has_joint_friction(scene)


def test_the_monolayer_has_the_flanks_friction_unless_given() -> None:
    scene = HIGH.replace({"contact.friction": 0.3})
    assert friction_values(scene) == {"bare": 0.3, "coated": 0.3, "mixed": 0.3}
    scene = scene.replace({"coating.friction": 0.1})
    assert friction_values(scene) == {"bare": 0.3, "coated": 0.1, "mixed": 0.1}
    assert has_flank_friction(scene)


def test_a_material_that_flanks_do_not_have_rubs_nothing() -> None:
    bare_alone = {"contact.friction": 0.3, "coating.friction": 0.0}
    assert not has_flank_friction(HIGH.replace({**bare_alone, "coating.sam_fraction": 1.0}))
    assert has_flank_friction(HIGH.replace({**bare_alone, "coating.sam_fraction": 0.5}))


def test_strengths_with_units() -> None:
    scene = HIGH.replace({"contact.friction_law": "shear", "contact.shear_strength": "100 MPa"})
    assert friction_values(scene) == {"bare": 1e8, "coated": 1e8, "mixed": 1e8}
    scene = scene.replace({"coating.shear_strength": "10 MPa"})
    assert friction_values(scene)["coated"] == 1e7
    assert gd.Scene.from_dict(scene.to_dict()) == scene


def test_hubs_with_units() -> None:
    scene = HIGH.replace({"gears.hub_friction": 0.3, **HUBS})
    assert scene.gears is not None
    assert (scene.gears.pinion_hub_radius, scene.gears.gear_hub_radius) == (3e-6, 6e-6)
    assert has_joint_friction(scene)
    assert not has_flank_friction(scene)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"contact.friction": -0.1}, "contact.friction"),
        ({"contact.friction": 1.7}, "contact.friction"),  # the preset locks at 1.615
        ({"contact.friction": 0.1, "coating.friction": 1.7}, "coating.friction"),
        ({"contact.friction_law": "stick"}, "contact.friction_law"),
        ({"contact.friction_law": "shear"}, "contact.shear_strength"),
        ({"contact.shear_strength": 1e7}, "contact.shear_strength"),
        ({"coating.shear_strength": 1e7}, "coating.shear_strength"),
        (
            {"contact.friction_law": "shear", "contact.shear_strength": 1e7, "contact.friction": 0.1},
            "contact.friction",
        ),
        ({"gears.hub_friction": 0.1}, "gears.pinion_hub_radius"),
        (
            {"gears.hub_friction": 2.0, "gears.pinion_hub_radius": 20e-6, "gears.gear_hub_radius": 6e-6},
            "gears.pinion_hub_radius",
        ),
        (
            {"gears.hub_friction": 1.0, "gears.pinion_hub_radius": 3e-6, "gears.gear_hub_radius": 139e-6},
            "gears.gear_hub_radius",
        ),
        ({"gears.pinion_hub_adhesion": 1e-6}, "gears.pinion_hub_radius"),
        ({"gears.gear_axial_load": 1e-6}, "gears.gear_dimple_radius"),
        ({"gears.gear_axial_load": -1e-6}, "gears.gear_axial_load"),
        ({"drive.pin_radius": 1e-6}, "drive.pin_radius"),
        ({"drive.pin_friction": 0.3}, "drive.pin_friction"),
        ({"drive.orientation": 0.3}, "drive.orientation"),
        ({"drive.law": ENGINE, "drive.pin_friction": 0.3}, "drive.pin_radius"),
        (
            {
                "drive.law": ENGINE,
                "drive.pin_radius": 2e-6,
                "drive.pin_friction": 2.0,
                "gears.hub_friction": 2.0,
                "gears.pinion_hub_radius": 3.1e-6,
            },
            "drive.pin_radius",  # takes 4 + 6.2 um of an arm of 10 um
        ),
        ({"load.law": ENGINE}, "load.law.name"),
    ],
)
def test_bad_friction_is_refused_by_its_key(changes: dict[str, Any], key: str) -> None:
    with pytest.raises(gd.SceneError) as caught:
        HIGH.replace(changes)
    assert caught.value.key == key


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"contact.friction": 0.1}, "contact.friction"),
        ({"coating.friction": 0.1}, "coating.friction"),
        ({"contact.shear_strength": 1e7}, "contact.shear_strength"),
        ({"contact.friction_law": "shear"}, "contact.friction_law"),
    ],
)
def test_a_roller_has_no_friction(changes: dict[str, Any], key: str) -> None:
    with pytest.raises(gd.SceneError) as caught:
        gd.preset("roller_slow").replace(changes)
    assert caught.value.key == key


def test_self_locking_bounds_the_coefficient() -> None:
    """1.615 from the gear's side, the smaller of both sides, for the preset's mesh."""
    assert HIGH.replace({"contact.friction": 1.61}).contact.friction == 1.61
    with pytest.raises(gd.SceneError, match=r"must be below 1\.615"):
        HIGH.replace({"contact.friction": 1.62})


# -- friction that ages ----------------------------------------------------------------------------------------------

AGEING = {
    "gears.hub_friction": 0.2,
    "gears.hub_friction_rise": 0.4,
    "gears.hub_ageing_time": "1 ms",
    "gears.hub_memory_length": "50 nm",
    "gears.pinion_hub_radius": "8 um",
    "gears.gear_hub_radius": "20 um",
}
PUSHED = {"drive.law": ENGINE, "drive.pin_radius": 1e-6}


@pytest.mark.parametrize(
    ("changes", "key", "allowed"),
    [
        ({"gears.hub_ageing_time": None}, "gears.hub_ageing_time", "required with gears.hub_friction_rise"),
        (
            {"gears.hub_memory_length": None},
            "gears.hub_memory_length",
            "required with gears.hub_friction_rise",
        ),
        ({"gears.hub_friction_rise": 5.1}, "gears.hub_friction_rise", "must lie in 0..5"),
        ({"gears.hub_friction_rise": -0.1}, "gears.hub_friction_rise", "must lie in 0..5"),
        ({"drive.pin_friction_rise": 0.1}, "drive.pin_friction_rise", "needs a torque law that has a force"),
        ({"initial.rest_time": -1.0}, "initial.rest_time", "must lie in 0.."),
        # fresh it would turn
        (
            {"gears.hub_friction_rise": 5.0, "gears.pinion_hub_radius": "8 um"},
            "gears.pinion_hub_radius",
            "locks",
        ),
    ],
)
def test_ageing_that_cannot_be_is_refused(changes, key, allowed):
    with pytest.raises(gd.SceneError, match=allowed) as error:
        HIGH.replace(AGEING | changes)
    assert error.value.key == key


def test_a_pin_ages_as_the_hubs_unless_it_has_a_coefficient_of_its_own():
    def pin(**changes):
        there = joints(HIGH.replace(AGEING | PUSHED | changes))[-1]
        return there.coefficient, there.rise, there.ageing_time, there.memory_length

    assert pin() == (0.2, 0.4, 1e-3, 5e-8)
    assert pin(**{"drive.pin_friction": 0.1})[:2] == (0.1, 0.0)
    assert pin(**{"drive.pin_friction_rise": 0.3}) == (0.2, 0.3, 1e-3, 5e-8)
    own = {"drive.pin_friction_rise": 0.3, "drive.pin_ageing_time": 2.0, "drive.pin_memory_length": 3e-8}
    assert pin(**own, **{"drive.pin_friction": 0.0}) == (0.0, 0.3, 2.0, 3e-8)


def test_a_steady_speed_has_the_friction_of_its_own_sliding():
    """Constant coefficients of that speed balance at the same one; it lies below that of fresh contacts."""
    scene = HIGH.replace(AGEING | {"gears.hub_memory_length": "100 um", "drive.harmonic": None})
    speed = gd.studies.steady_speed(scene)
    assert speed < gd.studies.steady_speed(scene.replace({"gears.hub_friction_rise": 0.0}))
    pinion, gear = sliding(scene, speed)
    assert pinion.coefficient == pytest.approx(0.2 - 0.4 * math.expm1(-1e-4 / (4.0 * speed * 8e-6) / 1e-3))
    mean = 0.5 * (pinion.coefficient + gear.coefficient)
    constant = gd.studies.steady_speed(
        scene.replace({"gears.hub_friction_rise": 0.0, "gears.hub_friction": mean})
    )
    assert speed == pytest.approx(constant, rel=5e-3)
