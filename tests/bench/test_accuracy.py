"""Accuracy over the shipped cases: that they are those, and that references follow stick, slip and knots."""

import math
from datetime import date
from pathlib import Path

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from gearidae.records import EventKind
from gearidae_bench.accuracy import RTOLS, SHORTENED, Achieved, accuracy_scenes, measure_accuracy
from gearidae_bench.accuracy_report import page, quantiles

CASES = Path(__file__).parents[2] / "cases"
SCENES = {bench.name: bench for bench in accuracy_scenes()}


@pytest.mark.parametrize(
    ("file", "name", "share"),
    [
        ("low_speed", "low speed", 1.0),
        ("high_speed", "high speed", 1.0),
        ("start_up", "run-up", SHORTENED),
        ("braking", "braking", SHORTENED),
        ("alternating", "alternation", SHORTENED),
        ("roller_slow", "slow roller, elastic bodies", 1.0),
        ("roller_fast", "fast roller, elastic bodies", 1.0),
    ],
)
def test_the_scenes_are_the_shipped_cases(file, name, share):
    case, scene = gd.load_case(CASES / f"{file}.toml"), SCENES[f"{name}, worn"].scene
    changes = {"coating.sam_fraction": 0.6, "contact.bodies": scene.contact.bodies, "name": scene.name}
    changes |= {f"run.{key}": getattr(scene.run, key) for key in ("duration", "samples")}
    if case.drive and case.drive.schedule:
        changes["drive.schedule"] = [[share * time, torque] for time, torque in case.drive.schedule]
        assert scene.run.duration == pytest.approx(share * case.run.duration, rel=1e-12)
    expected, ours = case.replace(changes).to_dict(), scene.to_dict()
    if "drive" in ours:
        knots = expected["drive"].pop("schedule", []), ours["drive"].pop("schedule", [])
        np.testing.assert_allclose(*(np.array(points, float) for points in knots), rtol=1e-12)
    assert ours == expected


def test_every_case_is_there():
    measured = {"low_speed", "high_speed", "start_up", "braking", "alternating", "roller_slow", "roller_fast"}
    # whose new terms have closed forms, in tests/engine/test_speed_and_viscous.py and test_torque_of_angle.py
    # and, of the train, numbers of an independent prototype in tests/engine/train
    elsewhere = {"inspection", "running", "run_down", "microengine", "transmission"}
    assert {path.stem for path in CASES.glob("*.toml")} == measured | elsewhere
    assert len(SCENES) == 3 * (5 + 4)


@pytest.mark.parametrize(
    ("name", "kinds"),
    [
        ("braking, whole", {EventKind.STICK, EventKind.SCHEDULE_KNOT}),
        pytest.param("run-up, whole", {EventKind.SLIP, EventKind.SCHEDULE_KNOT}, marks=pytest.mark.by_hand),
    ],
)
def test_stick_and_slip_and_knots_are_those_of_the_reference(name, kinds):
    """A gear that stopped or broke away at another time would make another run, however tight the tolerance."""
    chosen = (SCENES[name],)
    assert kinds <= set(solve(chosen[0].scene).events.kind)
    for result in measure_accuracy(chosen):
        assert result.reference == "Gauss-Legendre"
        assert result.own_error < 1e-9
        assert result.turning_points > 100
        assert len(result.errors) == len(RTOLS)
        # over six decades of the tolerance errors fall by four at the least (the loosest ones are of order one)
        assert result.errors[-1] < 1e-4


def test_where_bodies_give_way_the_reference_is_the_engines_own():
    (result,) = measure_accuracy((SCENES["slow roller, elastic bodies, whole"],))
    assert result.reference.startswith("itself")
    assert result.own_error < 1e-7
    assert result.errors[-1] < 1e-5


def test_the_page_has_every_scene_and_the_distribution():
    results = [
        Achieved("one", "Gauss-Legendre", 1e-12, 7, tuple(10.0 * rtol for rtol in RTOLS)),
        Achieved("two", "itself", 1e-10, 9, (math.inf, *(1000.0 * rtol for rtol in RTOLS[1:]))),
    ]
    assert quantiles(results)["all"][-1] == math.inf
    assert quantiles(results)["1e-06"] == pytest.approx((10.0, 10.0, 1000.0, 1000.0))
    text = page(results, date(2026, 1, 2))
    assert "2026-01-02" in text
    assert "| one |" in text
    assert "| two |" in text
    assert "| 1e-06 | 10 | 10 | 1e+03 | 1e+03 |" in text
