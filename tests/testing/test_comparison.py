"""Runs compared with each other, and messages of the assertion."""

from __future__ import annotations

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.testing import assert_runs_close

SCENE = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 0.02, "run.samples": 21})


@pytest.fixture(scope="module")
def run():
    return gd.simulate(SCENE)


def test_a_run_equals_itself(run):
    table = gd.compare(run, gd.simulate(SCENE))
    assert (table["relative"] == 0.0).all()
    assert {"gear_speed", "max_gear_speed", "drive_work", "verdict", "events"} <= set(table.index)
    assert not {"wall_time", "steps", "residual"} & set(table.index)
    assert_runs_close(run, gd.simulate(SCENE), rtol=0.0)


def test_a_difference_is_named_with_its_place_and_scale(run):
    other = run.copy(deep=True)
    other["gear_speed"][7] += 1e-3
    table = gd.compare(run, other)
    row = table.loc["gear_speed"]
    assert table.index[0] == "gear_speed"
    assert row["difference"] == pytest.approx(1e-3, rel=1e-9, abs=0)
    assert row["relative"] == pytest.approx(1e-3 / float(np.abs(other["gear_speed"]).max()), rel=1e-9)
    assert row["where"] == f"time={float(run.time[7]):.6g} s"
    with pytest.raises(
        AssertionError, match=r"gear_speed: 0.000\d+ of its scale \(0.001\) at time=0.007 s; allowed 1e-06"
    ):
        assert_runs_close(run, other)
    assert_runs_close(run, other, per={"gear_speed": 1e-3})
    assert_runs_close(run, other, rtol=1e-3)


def test_missing_numbers_are_equal_to_missing_ones_only(run):
    other = run.copy(deep=True)
    assert gd.compare(run, other).loc["stick_time", "relative"] == 0.0  # NaN in both
    other["stick_time"] = 0.01
    assert gd.compare(run, other).loc["stick_time", "relative"] == math.inf


def test_events_are_compared_one_by_one(run):
    other = run.copy(deep=True)
    other["event_time"][5] += 2e-9
    row = gd.compare(run, other).loc["events"]
    assert row["difference"] == pytest.approx(2e-9, rel=1e-6, abs=0)
    assert row["relative"] == pytest.approx(2e-9 / 0.02, rel=1e-6, abs=0)
    assert row["where"].startswith("in order, event 5: ")
    other["event_pair"][3] += 1
    with pytest.raises(
        AssertionError, match=r"events: event 3: \w+ of pair \d+ at \S+ s and \w+ of pair \d+"
    ):
        assert_runs_close(run, other, per={"events": 1.0})
    assert_runs_close(run, other, per={"events": math.inf})
    shorter = run.isel(event=slice(0, -1))
    assert "no more than" in gd.compare(run, shorter).loc["events", "where"]


def test_runs_at_other_tolerances_are_close_and_the_message_names_the_key(run):
    finer = gd.simulate(SCENE, rtol=1e-9)
    assert_runs_close(run, finer, rtol=1e-3)
    with pytest.raises(AssertionError, match=r"their scenes differ in run\.rtol"):
        assert_runs_close(run, finer, rtol=1e-12)


def test_sweeps_are_compared_run_by_run():
    sweep = gd.sweep(SCENE, {"coating.sam_fraction": [1.0, 0.6]})
    other = sweep.copy(deep=True)
    other["mesh_force"][1, 4] *= 1.01
    row = gd.compare(sweep, other).loc["mesh_force"]
    assert row["where"] == f"sam_fraction=0.6, time={float(sweep.time[4]):.6g} s"
    with pytest.raises(gd.SceneError, match="sam_fraction"):
        gd.compare(sweep, sweep.isel(sam_fraction=[0]))
    with pytest.raises(gd.SceneError, match="compare"):
        gd.compare(sweep, gd.simulate(SCENE))


def test_other_sample_times_are_refused(run):
    with pytest.raises(gd.SceneError, match="as many values"):
        gd.compare(run, run.isel(time=slice(0, 5)))
    with pytest.raises(gd.SceneError, match="same values"):
        gd.compare(run, run.assign_coords(time=run.time * 1.5))


def test_rollers_are_compared_too():
    scene = gd.preset("roller_slow").replace({"run.samples": 11})
    run = gd.simulate(scene)
    assert_runs_close(run, gd.simulate(scene), rtol=0.0)
    assert "height" in gd.compare(run, run).index


@pytest.mark.parametrize(
    ("options", "key"),
    [({"rtol": -1.0}, "rtol"), ({"rtol": math.nan}, "rtol"), ({"per": {"speeed": 1.0}}, "per")],
)
def test_tolerances_are_checked(run, options, key):
    with pytest.raises(gd.SceneError, match=key):
        assert_runs_close(run, run, **options)
