"""Doubts: said of what cannot be meant, and of nothing else."""

from __future__ import annotations

import json
import logging
import math
from pathlib import Path

import pytest

import gearidae as gd
from gearidae.runs.plausibility import doubts
from gearidae.runs.validity import validity_attribute
from reference.own_pair import OWN_PAIR
from reference.random_scenes import random_scene
from reference.trains import chain

CASES = sorted((Path(__file__).parents[2] / "cases").glob("*.toml"))
LOW = gd.preset("teodorescu2009_low_speed")
ROLLER = gd.preset("roller_slow")
DISCS = LOW.replace({"gears": OWN_PAIR["gears"]})
"""Gears of 18 and 54 teeth, solid discs."""


@pytest.mark.parametrize("case", [pytest.param(path, id=path.stem) for path in CASES])
def test_nothing_is_said_of_the_shipped_cases(case):
    assert doubts(gd.load_case(case)) == []


def half_turns(t, angle, speed, p):
    return p[0] if math.cos(angle) > 0.0 else 0.0


@pytest.mark.parametrize("scene", [LOW, gd.Scene.from_dict(chain())])
def test_a_law_that_jumps_with_the_angle_is_named(scene):
    """Of pairs and of trains, at a quarter of a turn and at three."""
    gd.register_torque("half_turns", parameters=1)(half_turns)
    try:
        lines = doubts(scene.replace({"drive.law": {"name": "half_turns", "parameters": [1e-18]}}))
    finally:
        gd.unregister_torque("half_turns")
    words = "drive.law = half_turns jumps at an angle of 1.5708 rad and 1 more in a turn"
    assert [line.startswith(words) for line in lines].count(True) == 1


@pytest.mark.parametrize(
    ("scene", "changes", "words"),
    [
        (
            LOW,
            {"surface.roughness": 0.21e-6},
            "surface.roughness = 210 nm is larger than mesh.backlash = 200 nm",
        ),
        (LOW, {"surface.roughness": 10e-6}, "addendum of the teeth, 3.89 um"),
        (LOW, {"surface.asperity_radius": 5e-6}, "surface.asperity_radius = 5 um is larger than the tooth"),
        (LOW, {"surface.asperity_density": 1e11}, "asperities stand 3.16 um apart"),
        (
            LOW,
            {"gears.gear_axial_load": 8e-8, "gears.gear_dimple_radius": 8e-6},
            "gears.gear_axial_load = 80 nN has no effect without gears.hub_friction",
        ),
        (LOW, {"mesh.film_gap": 30e-9}, "mesh.film_gap = 30 nm has no effect without mesh.film_damping"),
        (
            LOW,
            {"load.harmonic": {"amplitude": 1e-18, "frequency": 1e3}},
            "load.harmonic swings by 1 aN m about a dry resistance of 0 N m: it is cut off",
        ),
        (
            LOW,
            {
                "load.torque": 1e-18,
                "load.schedule": [[0, 3e-18], [0.1, 0]],
                "load.harmonic": [{"amplitude": -1e-18, "frequency": f} for f in (1e3, 2e3)],
            },
            "load.harmonic swings by 2 aN m about a dry resistance of 1 aN m",
        ),
        (
            LOW,
            {"gears.gear_teeth": 117},
            "is still that of the presets, whose gear has 76 teeth",
        ),
        (
            DISCS,
            {"gears.gear_teeth": 117},
            "is 22 times lighter than a solid disc of silicon of its size: give gears.density",
        ),
        (ROLLER, {"surface.roughness": 1e-6}, "higher than roller.radius = 5 um"),
    ],
)
def test_what_can_hardly_be_meant_is_said_with_key_and_number(scene, changes, words):
    assert any(words in doubt for doubt in doubts(scene.replace(changes)))


def test_the_limits_themselves():
    assert not doubts(
        LOW.replace({"load.torque": 1e-18, "load.harmonic": {"amplitude": 1e-18, "frequency": 1e3}})
    )
    assert not doubts(LOW.replace({"surface.roughness": 0.199e-6, "run.duration": 1e-9}))


def test_a_run_says_them_once_and_goes_on(caplog):
    scene = LOW.replace({"surface.asperity_density": 1e11, "run.duration": 1e-4})
    with caplog.at_level(logging.WARNING, logger="gearidae"):
        ds = gd.simulate(scene)
    said = [record for record in caplog.records if "asperities stand" in record.getMessage()]
    assert len(said) == 1
    assert ds.attrs["status"] == "finished"


def test_no_scene_is_too_odd_to_be_judged():
    """Random scenes over wide ranges: neither an exception nor a floating-point warning, which would be an error."""
    for number in range(25):
        scene = random_scene(3, number)
        assert all(isinstance(doubt, str) for doubt in doubts(scene))
        assert json.loads(validity_attribute(scene))


def test_ageing_of_nothing_and_memory_of_unusual_length_are_named():
    ageing = {
        "gears.hub_ageing_time": "1 ms",
        "gears.hub_memory_length": "1 um",
        "gears.gear_hub_radius": "5 um",
    }
    idle = gd.preset("teodorescu2009").replace(
        {**ageing, "initial.rest_time": "1 s", "gears.hub_friction": 0.2}
    )
    for key in ("gears.hub_ageing_time = 1 ms", "gears.hub_memory_length = 1 um", "initial.rest_time = 1 s"):
        assert f"{key} has no effect without gears.hub_friction_rise" in doubts(idle)
    (line,) = doubts(idle.replace({"gears.hub_friction_rise": 0.1}))
    assert line.startswith("gear hub: a memory length of 1 um is unusual")
    assert doubts(idle.replace({"gears.hub_friction_rise": 0.1, "gears.hub_memory_length": "50 nm"})) == []
