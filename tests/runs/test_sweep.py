"""Sweeps: the same runs as one by one, wherever they are computed, and whatever becomes of some of them."""

from __future__ import annotations

import dataclasses
import itertools
import json
import os
import signal
import threading
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae import engine
from gearidae.errors import SolverError
from gearidae.progress import sweep_progress
from gearidae.records import GEAR_COLUMNS
from gearidae.runs import sweeping
from sweeps import without_times

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3, "run.samples": 201})
KEY = "coating.sam_fraction"
FRACTIONS = [1.0, 0.5, 0.45]


@pytest.fixture
def no_engine(monkeypatch):
    def solve(*arguments, **options):
        pytest.fail("the engine was started")

    monkeypatch.setattr(engine, "solve", solve)


def replace_engine(monkeypatch, deed):
    """Let `deed(scene, solve, options)` stand in for the engine."""
    solve = engine.solve
    monkeypatch.setattr(engine, "solve", lambda scene, **options: deed(scene, solve, options))


def test_a_sweep_is_its_runs():
    ds = gd.sweep(LOW, {KEY: FRACTIONS})
    assert ds[KEY.rpartition(".")[2]].values.tolist() == FRACTIONS
    for fraction in FRACTIONS:
        run = gd.simulate(LOW.replace({KEY: fraction}))
        swept = ds.sel(sam_fraction=fraction)
        for name in GEAR_COLUMNS:
            assert np.array_equal(swept[name], run[name]), name
        assert np.array_equal(ds.event_time[ds.event_sam_fraction == fraction], run.event_time)
        for name in ("steps", "residual_evaluations", "jacobian_evaluations"):
            assert swept[name].item() == run.attrs[name]


@pytest.mark.parametrize("jobs", [1, 2, 8])
def test_threads_change_nothing(jobs):
    expected = without_times(gd.sweep(LOW, {KEY: FRACTIONS}, jobs=1))
    xr.testing.assert_identical(without_times(gd.sweep(LOW, {KEY: FRACTIONS}, jobs=jobs)), expected)


def test_any_executor_will_do():
    class OnTheSpot(ThreadPoolExecutor):
        """Compute on submission, last result first."""

        submitted = 0

        def submit(self, function, *arguments, **options):
            self.submitted += 1
            future = Future()
            future.set_result(function(*arguments, **options))
            return future

    executor = OnTheSpot()
    ds = gd.sweep(LOW, {KEY: FRACTIONS}, executor)
    assert executor.submitted == 3
    xr.testing.assert_identical(without_times(ds), without_times(gd.sweep(LOW, {KEY: FRACTIONS}, jobs=1)))


@pytest.mark.slow
def test_processes_change_nothing():
    """Scenes, solutions and errors survive the trip; a fresh process finds the compiled code on the disk."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as executor:
        ds = gd.sweep(LOW, {KEY: FRACTIONS}, executor)
    xr.testing.assert_identical(without_times(ds), without_times(gd.sweep(LOW, {KEY: FRACTIONS}, jobs=1)))


def test_two_keys_make_a_product_with_units():
    ds = gd.sweep(LOW, {KEY: [1.0, 0.5], "mesh.backlash": ["0.2 um", "0.1 um"]}, samples=11)
    assert ds.gear_speed.dims == ("sam_fraction", "backlash", "time")
    assert ds.backlash.values.tolist() == [2e-7, 1e-7]
    assert ds.backlash.attrs["units"] == "m"
    assert json.loads(ds.attrs["swept"]) == {KEY: [1.0, 0.5], "mesh.backlash": [2e-7, 1e-7]}
    run = gd.simulate(LOW.replace({KEY: 0.5, "mesh.backlash": 1e-7}), samples=11)
    assert np.array_equal(ds.gear_speed.sel(sam_fraction=0.5, backlash=1e-7), run.gear_speed)


def test_lists_and_their_entries_can_be_swept():
    harmonic = {"amplitude": 1e-19, "frequency": 1e3}
    scene = LOW.replace({"drive.harmonic": harmonic})
    ds = gd.sweep(scene, {"drive.harmonic.0.amplitude": [1e-19, 2e-19]}, samples=11)
    assert ds.amplitude.values.tolist() == [1e-19, 2e-19]
    assert ds.amplitude.attrs["units"] == "N m"
    ds = gd.sweep(LOW, {"drive.harmonic": [[], [harmonic]]}, samples=11)
    assert ds.harmonic.values.tolist() == [0, 1]
    assert not np.array_equal(ds.gear_speed[0], ds.gear_speed[1])


@pytest.mark.parametrize(
    "over",
    [
        {"coating.sam_fraction": range(10**12)},
        {"coating.sam_fraction": itertools.count()},
        {"coating.sam_fraction": range(2000), "coating.energy": range(2000)},
    ],
)
def test_a_sweep_of_too_many_runs_is_refused_before_it_is_planned(over):
    with pytest.raises(gd.SceneError, match="a sweep has 1000000 runs at most"):
        gd.sweep(LOW, over)


def test_numpy_values_and_generators():
    for values in (
        np.array([1.0, 0.5]),
        (f for f in (1.0, 0.5)),
        np.linspace(1.0, 0.5, 2).astype(np.float32),
    ):
        assert gd.sweep(LOW, {KEY: values}, samples=11).sam_fraction.values.tolist() == [1.0, 0.5]


def test_settings_and_archive(tmp_path):
    ds = gd.sweep(LOW, {KEY: FRACTIONS}, rtol=1e-5, t_end=1e-3, samples=21, archive=tmp_path / "sweep.nc")
    assert (ds.attrs["rtol"], ds.attrs["t_end"], ds.sizes["time"]) == (1e-5, 1e-3, 21)
    xr.testing.assert_identical(gd.open_archive(tmp_path / "sweep.nc"), ds)


def test_one_failed_run_is_a_label_and_not_the_end(monkeypatch):
    def deed(scene, solve, options):
        if scene.coating.sam_fraction == 0.5:
            raise SolverError("no start", time=0.0, state={}, last_event="none", advice="try less")
        solution = solve(scene, **options)
        if scene.coating.sam_fraction == 0.45:
            early = {name: values[:50] for name, values in solution.samples.items()}
            return dataclasses.replace(
                solution, time=solution.time[:50], samples=early, status="chatter", message="it chatters"
            )
        return solution

    replace_engine(monkeypatch, deed)
    ds = gd.sweep(LOW, {KEY: FRACTIONS})
    assert ds.status.values.tolist() == ["finished", "failed", "chatter"]
    assert "no start" in ds.message.values[1]
    assert np.isfinite(ds.gear_speed.values).sum(axis=1).tolist() == [201, 0, 50]
    assert ds.attrs["status"] == "partial"


@pytest.mark.parametrize("jobs", [1, 2])
def test_not_even_a_crash_takes_the_others_along(monkeypatch, jobs):
    def deed(scene, solve, options):
        if scene.coating.sam_fraction == 0.5:
            raise MemoryError("too large")
        return solve(scene, **options)

    replace_engine(monkeypatch, deed)
    ds = gd.sweep(LOW, {KEY: FRACTIONS}, jobs=jobs)
    assert ds.status.values.tolist() == ["finished", "crashed", "finished"]
    assert ds.message.values[1] == "MemoryError: too large"


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_scene_beyond_the_engine_is_bad_input(monkeypatch, jobs, tmp_path):
    def deed(scene, solve, options):
        raise gd.SceneError("contact.bodies", "elastic", "cannot be run")

    replace_engine(monkeypatch, deed)
    with pytest.raises(gd.SceneError, match="cannot be run"):
        gd.sweep(LOW, {KEY: FRACTIONS}, jobs=jobs, archive=tmp_path / "sweep.nc")
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("jobs", [1, 2])
def test_ctrl_c_keeps_the_finished_runs(monkeypatch, jobs, tmp_path):
    """The signal arrives during the last run, as from a terminal; that run has to be ended from inside."""
    ended = threading.Event()

    def deed(scene, solve, options):
        if scene.coating.sam_fraction != 0.45:
            return solve(scene, **options)
        try:
            os.kill(os.getpid(), signal.SIGINT)
            for _ in range(10_000):
                threading.Event().wait(0.001)
                options["on_progress"](1e-3, 0)
        finally:
            ended.set()
        pytest.fail("the run never got the signal to end")

    replace_engine(monkeypatch, deed)
    with pytest.raises(KeyboardInterrupt, match=r"sweep\.nc"):
        gd.sweep(LOW, {KEY: FRACTIONS}, jobs=jobs, archive=tmp_path / "sweep.nc")
    assert ended.is_set()
    ds = gd.open_archive(tmp_path / "sweep.nc")
    assert ds.status.values[-1] == "interrupted"
    # The last run began when one of the others was done, at the earliest.
    finished = ds.isel(sam_fraction=ds.status.values == "finished")
    assert finished.sizes["sam_fraction"] >= 1
    assert np.isfinite(finished.gear_speed).all()


def test_progress_counts_runs():
    seen = []
    gd.sweep(LOW, {KEY: FRACTIONS}, jobs=1, progress=lambda done, total: seen.append((done, total)))
    done = [count for count, _ in seen]
    assert sorted(done) == done
    assert done[-1] == 3.0
    assert {total for _, total in seen} == {3}


@pytest.mark.usefixtures("no_engine")
@pytest.mark.parametrize(
    ("over", "key"),
    [
        ({}, "over"),
        ([KEY], "over"),
        ({KEY: []}, KEY),
        ({KEY: 0.5}, KEY),
        ({KEY: "1,0.5"}, KEY),
        ({KEY: [1.0, 1.5]}, KEY),
        ({KEY: [1.0, float("nan")]}, KEY),
        ({KEY: [1.0, 0.5, 1]}, KEY),
        ({"mesh.backlash": ["0.2 um", 2e-7]}, "mesh.backlash"),
        ({"mesh.backlash": ["0.2 s"]}, "mesh.backlash"),
        ({"coating.sam": [1.0]}, "coating.sam"),
        ({"roller.mass": [1e-10]}, "roller.mass"),
        ({"run.samples": [10, 20]}, "run.samples"),
        ({"run.duration": [1e-3]}, "run.duration"),
        ({3: [1.0]}, "3"),
    ],
)
def test_bad_values_are_refused_before_anything_runs(over, key):
    with pytest.raises(gd.SceneError) as caught:
        gd.sweep(LOW, over)
    assert str(caught.value.key) == key
    assert "\n" not in str(caught.value)


@pytest.mark.usefixtures("no_engine")
@pytest.mark.parametrize("jobs", [0, -1, 1.5, "two", True])
def test_bad_jobs(jobs):
    with pytest.raises(gd.SceneError, match="jobs"):
        gd.sweep(LOW, {KEY: FRACTIONS}, jobs=jobs)


@pytest.mark.usefixtures("no_engine")
def test_an_archive_that_exists_is_refused_before_anything_runs(tmp_path):
    (tmp_path / "sweep.nc").write_bytes(b"precious")
    with pytest.raises(gd.SceneError, match="exists already"):
        gd.sweep(LOW, {KEY: FRACTIONS}, archive=tmp_path / "sweep.nc")
    assert (tmp_path / "sweep.nc").read_bytes() == b"precious"


def test_studies_show_their_progress_unless_they_are_told_not_to(monkeypatch):
    """As the commands do: with an estimate, and no words of a number of cores that somebody else's executor decides."""
    shown = []

    def watched(wanted, runs, expected):
        shown.append((wanted, runs, expected()))
        return sweep_progress(False, runs)

    monkeypatch.setattr(sweeping, "sweep_progress", watched)
    long = LOW.replace({"run.duration": 1e-4, "run.samples": "off", "initial.gap": "30 nm"})
    vary = {"drive.torque": "uniform(4e-18, 5e-18)"}
    gd.studies.ensemble(long, vary, 2, jobs=1)
    gd.sweep(long, {KEY: [1.0]}, progress=False)
    with ThreadPoolExecutor(1) as executor:
        gd.sweep(long, {KEY: [1.0, 0.9]}, executor)
    assert shown == [(True, 2, "less than a second"), (False, 1, "less than a second"), (True, 2, "")]
