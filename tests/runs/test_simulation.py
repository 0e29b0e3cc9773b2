"""One call from a scene to a dataset: what is promised about it, and what is refused before anything runs."""

from __future__ import annotations

import json
from types import ModuleType

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae import progress
from gearidae.engine import backend
from gearidae.records import GEAR_COLUMNS, ROLLER_COLUMNS, Ending
from gearidae.scene.prefixes import with_prefix

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3, "run.samples": 201})
ROLLER = gd.preset("roller_slow").replace({"run.samples": 101})


@pytest.fixture
def no_engine(monkeypatch):
    """Fail the test if anything is run."""

    def run_blocks(*arguments, **options):
        pytest.fail("the engine was started")

    monkeypatch.setattr(backend, "run_blocks", run_blocks)


def test_gear_run():
    ds = gd.simulate(LOW)
    assert set(GEAR_COLUMNS) <= set(ds.data_vars)
    assert np.array_equal(ds.time, np.linspace(0.0, 2e-3, 201))
    assert ds.attrs["status"] == "finished"
    assert ds.gear_speed[0] == LOW.initial.gear_speed
    # gear_angle is the integral of gear_speed: trapezoids over 10 us are good to 1e-3 of this smooth a speed.
    travelled = np.trapezoid(ds.gear_speed, ds.time)
    assert (ds.gear_angle[-1] - ds.gear_angle[0]).item() == pytest.approx(travelled, rel=1e-3, abs=0)


def test_roller_run():
    ds = gd.simulate(ROLLER)
    assert set(ROLLER_COLUMNS) <= set(ds.data_vars)
    assert ds.height[0] == ROLLER.roller.height
    assert ds.speed[0] == -ROLLER.roller.speed


def test_settings_of_the_call_end_up_in_the_scene():
    ds = gd.simulate(LOW, rtol=1e-5, t_end=1e-3, samples=51)
    run = json.loads(ds.attrs["scene"])["run"]
    assert run == {
        "duration": 1e-3,
        "samples": 51,
        "rtol": 1e-5,
        "method": "auto",
        "stop": "time",
        "exposures": 0,
        "balance": True,
        "passages": True,
        "impacts": False,
        "asperity_events": True,
    }
    assert (ds.attrs["rtol"], ds.attrs["t_end"]) == (1e-5, 1e-3)
    assert (ds.sizes["time"], ds.time[-1]) == (51, 1e-3)
    same = gd.simulate(LOW.replace({"run.rtol": 1e-5, "run.duration": 1e-3, "run.samples": 51}))
    xr.testing.assert_equal(ds, same)


def test_the_scene_in_the_dataset_runs_again_to_the_same_numbers():
    ds = gd.simulate(LOW)
    again = gd.simulate(gd.Scene.from_dict(json.loads(ds.attrs["scene"])))
    for name in ("history", "date_created", "wall_time"):
        del ds.attrs[name], again.attrs[name]
    xr.testing.assert_identical(ds, again)


def test_archive_holds_what_is_returned(tmp_path):
    ds = gd.simulate(LOW, archive=tmp_path / "run.nc")
    xr.testing.assert_identical(gd.open_archive(tmp_path / "run.nc"), ds)


def test_progress_is_told_to_a_function():
    seen = []
    ds = gd.simulate(LOW, progress=lambda time, events: seen.append((time, events)))
    times, events = zip(*seen, strict=True)
    assert sorted(times) == list(times)
    assert times[-1] == pytest.approx(LOW.run.duration, rel=1e-12, abs=0)
    assert events[-1] == ds.sizes["event"]


def test_progress_is_silent_where_there_is_no_terminal(capfd):
    gd.simulate(LOW, progress=True)
    assert capfd.readouterr() == ("", "")


@pytest.mark.usefixtures("no_engine")
@pytest.mark.parametrize(
    ("options", "key"),
    [
        ({"rtol": 0.0}, "run.rtol"),
        ({"rtol": float("nan")}, "run.rtol"),
        ({"rtol": "tight"}, "run.rtol"),
        ({"t_end": -1.0}, "run.duration"),
        ({"t_end": float("inf")}, "run.duration"),
        ({"samples": 1}, "run.samples"),
        ({"samples": 10.5}, "run.samples"),
        ({"samples": "2 um"}, "run.samples"),
        ({"samples": "1 mHz"}, "run.samples"),
        ({"backend": "magic"}, "backend"),
        ({"resume": True}, "resume"),
        ({"archive": 3}, "archive"),
        ({"archive": "/nowhere/at/all.nc"}, "archive"),
    ],
)
def test_bad_settings_are_refused_before_anything_runs(options, key):
    with pytest.raises(gd.SceneError, match=key) as caught:
        gd.simulate(LOW, **options)
    assert caught.value.key == key


@pytest.mark.usefixtures("no_engine")
@pytest.mark.parametrize("scene", [None, {}, "cases/low_speed.toml", LOW.to_dict()])
def test_what_is_no_scene_is_refused(scene):
    with pytest.raises(gd.SceneError, match="must be a Scene"):
        gd.simulate(scene)


@pytest.mark.usefixtures("no_engine")
def test_an_archive_that_exists_is_refused_before_anything_runs(tmp_path):
    path = tmp_path / "run.nc"
    path.write_bytes(b"precious")
    with pytest.raises(gd.SceneError, match="exists already"):
        gd.simulate(LOW, archive=path)
    assert path.read_bytes() == b"precious"


@pytest.mark.parametrize("archived", [False, True])
def test_a_solver_in_trouble_hands_over_what_it_reached(archived, end_early, tmp_path):
    whole = gd.simulate(LOW)
    end_early("chatter")
    options = {"archive": tmp_path / "run.nc"} if archived else {}
    with pytest.raises(gd.SolverError, match=Ending.CHATTER.message + " at t = ") as caught:
        gd.simulate(LOW, **options)
    error = caught.value
    assert error.dataset.sizes["time"] == 100
    assert error.dataset.attrs["status"] == "chatter"
    assert np.array_equal(error.dataset.gear_speed, whole.gear_speed[:100])
    assert error.time == pytest.approx(whole.time[99].item(), rel=1e-12, abs=0)
    assert error.state["gear_speed"] == whole.gear_speed[99]
    assert error.last_event != "none"
    assert "\n" not in str(error)
    if archived:
        xr.testing.assert_identical(gd.open_archive(tmp_path / "run.nc"), error.dataset)


@pytest.mark.parametrize("archived", [False, True])
def test_a_run_that_is_interrupted_is_kept(archived, end_early, tmp_path):
    whole = gd.simulate(LOW)
    end_early("interrupted")
    options = {"archive": tmp_path / "run.nc"} if archived else {}
    with pytest.raises(
        KeyboardInterrupt, match=r"run\.nc" if archived else r"stopped at t = 0\.00\d+ s of 0\.002 s"
    ) as caught:
        gd.simulate(LOW, **options)
    ds = caught.value.dataset
    assert ds.attrs["status"] == "interrupted"
    assert np.array_equal(ds.gear_speed, whole.gear_speed[:100])
    assert 0 < ds.sizes["event"] < whole.sizes["event"]
    if archived:
        xr.testing.assert_identical(gd.open_archive(tmp_path / "run.nc"), ds)


def test_modules_do_not_take_the_place_of_functions():
    """Importing a module binds it to its package under its last name, over whatever had that name."""

    assert not isinstance(gd.simulate, ModuleType)
    assert not isinstance(gd.sweep, ModuleType)


def test_progress_says_that_the_gear_is_held(monkeypatch):
    """By what, and since when; the words go when it turns."""
    reports = []

    class Report(progress.RunReport):
        def __call__(self, time, events):
            reports.append((time, self.doing))

    monkeypatch.setattr(progress, "RunReport", Report)
    worn = gd.preset("teodorescu2009_low_speed").replace(
        {"coating.sam_fraction": 0.45, "run.duration": 0.6, "run.samples": 11}
    )
    ds = gd.simulate(worn)
    stuck = f"held by adhesion since {with_prefix(float(ds.stick_time), 's')}"
    assert {doing for time, doing in reports if time < float(ds.stick_time)} == {""}
    assert {doing for time, doing in reports if time > float(ds.stick_time)} <= {"", stuck}
    assert reports[-1][1] == stuck
