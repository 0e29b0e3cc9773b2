"""Start-ups and brakings of the benchmark: every contender comes to the same angle, rest and loss."""

from __future__ import annotations

import math

import pytest

from gearidae.engine import solve
from gearidae.engine.setup.build import make_problem
from gearidae_bench.contender import unused
from gearidae_bench.start_stop import CONTENDERS, Reached, StartStop, measure_start_stop, start_stop_scenes
from gearidae_bench.start_stop_table import relative_error, series_errors, start_stop_page

FULL = 2.43e-11  # [N m]
SHORT = start_stop_scenes()["start_up"].replace(
    {
        "coating.sam_fraction": 0.9,
        "run.duration": 0.6e-3,
        "drive.schedule": [(0.0, 0.0), (0.2e-3, FULL), (0.3e-3, FULL), (0.35e-3, 0.0)],
    }
)
"""A run-up from rest, a run and a braking to rest: knots, stick and slip."""


@pytest.fixture(scope="module")
def reached():
    problem = make_problem(SHORT)
    return {
        name: runner(unused(problem), 0.05 if "RK4" in name else 1e-9)
        for name, (runner, _) in CONTENDERS.items()
    }


@pytest.mark.parametrize("name", CONTENDERS)
def test_contenders_come_to_the_same(reached, name):
    """Local tolerances of 1e-9, or a fixed step of an error below 1e-5; a missed knot or stick is an error of 1e-2."""
    ours = reached["auto"]
    assert ours.angle > 0.5
    assert 0.1e-3 < ours.rest < 0.6e-3
    for quantity in ("angle", "rest"):
        assert relative_error(reached[name], ours, quantity) < 1e-4
    follows = name == "auto" or "loss" in name
    assert math.isnan(reached[name].loss) != follows
    if follows:
        assert relative_error(reached[name], ours, "loss") < 1e-3


def test_rest_is_the_one_that_a_run_says(reached):
    extremes = solve(SHORT, rtol=1e-9).extremes
    assert extremes.rest_time == pytest.approx(reached["auto"].rest, rel=1e-9)


def test_a_run_that_is_near_by_chance_is_not_accurate():
    exact = Reached(1.0, 1.0, 1.0, 1)
    entries = [
        type("Entry", (), {"reached": Reached(1.0 + e, 1.0, 1.0, 1)}) for e in (1e-3, 1e-9, 1e-5, 1e-6)
    ]
    assert series_errors(entries, exact, "angle") == pytest.approx([1e-3, 1e-5, 1e-5, 1e-6], rel=1e-6)


def test_what_is_measured_is_kept_and_printed(tmp_path):
    names = ("auto", "auto alone", "bdf alone", "DOP853", "DOP853 with loss")
    result = measure_start_stop({"a run": SHORT}, 2, contenders=names, ladders=slice(1, 6, 2))
    assert all(len(entry.times) == 2 for entry in result.timed)
    result.save(tmp_path / "kept.json")
    page = start_stop_page(result)
    assert start_stop_page(StartStop.load(tmp_path / "kept.json")) == page
    (row,) = (line for line in page.splitlines() if line.startswith("| a run |") and "(DOP853)" in line)
    assert row.count(" / ") == 3
    assert row.count("(DOP853)") == 4
