"""Runs that are sent to other processes: alone until it is known how long they take, then several together."""

from __future__ import annotations

from concurrent.futures import BrokenExecutor, Executor, Future

import pytest
import xarray as xr

import gearidae as gd
from gearidae.runs import batch, run_result
from sweeps import without_times

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 1e-3})
VARY = {"coating.sam_fraction": "uniform(0.4, 1)"}


class Elsewhere(Executor):
    """Computes on submission, and notes how many runs came together.

    Parameters
    ----------
    lost : int
        How many groups of several are lost with their worker.
    broken_after : int
        How many submissions it takes.
    """

    def __init__(self, lost=0, broken_after=10_000):
        self.sizes, self._lost, self._broken_after = [], lost, broken_after

    def submit(self, function, scenes, *arguments):
        if len(self.sizes) >= self._broken_after:
            raise BrokenExecutor("a process ended")
        self.sizes.append(len(scenes))
        future = Future()
        if len(scenes) > 1 and self._lost:
            self._lost -= 1
            future.set_exception(RuntimeError("the worker is lost"))
        else:
            future.set_result(function(scenes, *arguments))
        return future


@pytest.fixture(scope="module")
def expected():
    return without_times(gd.studies.ensemble(LOW, VARY, 40, jobs=1))


def run(executor, size=40):
    return without_times(gd.studies.ensemble(LOW, VARY, size, executor=executor))


def test_short_runs_go_together_and_are_the_same(expected):
    executor = Elsewhere()
    xr.testing.assert_identical(run(executor), expected)
    assert executor.sizes[:16] == [1] * 16
    assert sum(executor.sizes) == 40
    assert len(executor.sizes) < 40


def test_long_runs_stay_alone(monkeypatch):
    monkeypatch.setattr(batch, "_TOGETHER", 1e-9)
    executor = Elsewhere()
    run(executor)
    assert executor.sizes == [1] * 40


def test_a_worker_that_is_lost_takes_no_run_along(expected):
    executor = Elsewhere(lost=1)
    xr.testing.assert_identical(run(executor), expected)
    assert executor.sizes.count(1) > 16


def test_one_that_dies_does_not_end_the_others_of_its_group(monkeypatch, expected):
    def deed(scene, backend, keep, on_progress=None):
        if scene.coating.sam_fraction < 0.6:
            raise MemoryError("too large")
        return solved(scene, backend, keep, on_progress)

    solved = run_result.solve_and_leave
    monkeypatch.setattr(run_result, "solve_and_leave", deed)
    ds = run(Elsewhere())
    low = ds.sam_fraction.values < 0.6
    assert (ds.status.values[low] == "crashed").all()
    assert low.any()
    xr.testing.assert_identical(ds.min_gear_speed[~low], expected.min_gear_speed[~low])


def test_a_broken_pool_is_a_label_of_the_runs_it_did_not_do():
    ds = run(Elsewhere(broken_after=16))
    assert ds.status.values.tolist() == ["finished"] * 16 + ["crashed"] * 24
    assert set(ds.message.values[16:]) == {"BrokenExecutor: a process ended"}
