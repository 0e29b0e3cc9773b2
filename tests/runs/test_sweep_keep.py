"""What the runs of a sweep leave behind: what is kept is what it would have been, and nothing else is."""

from __future__ import annotations

import json
import tracemalloc

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.archive.journal import Journal, journal_of
from gearidae.archive.output_selection import GROUPS
from gearidae.cli import main
from sweeps import without_times

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3, "run.samples": 11})
ROLLER = gd.preset("roller_slow").replace({"run.samples": 11, "contact.bodies": "rigid"})
OVER = {"coating.sam_fraction": [1.0, 0.5], "drive.torque": [4e-18, 5e-18]}
LEAST = {
    *("status", "message", "wall_time", "verdict", "impacts", "flank_changes", "stick_time", "stick_exits"),
    *("back_time", "holding", "followed_time", "advance", "free_advance", "settled", "turned_back"),
}


@pytest.fixture(scope="module")
def whole():
    return gd.sweep(LOW, OVER)


def equal_where_kept(kept, whole):
    for name in set(kept.variables) - {"verdict", "impacts", "flank_changes", "wall_time", "scene"}:
        assert kept[name].identical(whole[name]), name
    assert kept.verdict.values.ravel().tolist() == [outcome.verdict for outcome in outcomes(whole)]
    assert kept.impacts.values.ravel().tolist() == [outcome.impacts for outcome in outcomes(whole)]


@pytest.mark.parametrize(
    "keep", [[], ["verdict"], "verdict", ("min_gear_speed", "steps"), ["energy_balance"]]
)
def test_without_samples_and_events(whole, keep):
    ds = gd.sweep(LOW, OVER, keep=keep)
    assert set(ds.dims) == {"sam_fraction", "torque"}
    assert set(ds.data_vars) >= LEAST
    if "verdict" in keep or not keep:
        assert set(ds.data_vars) == LEAST
    for name in ("min_gear_speed", "steps", "drive_work"):
        assert (name in ds) == (name in keep or (name == "drive_work" and keep == ["energy_balance"]))
    # statistics count the steps of a run that no sample has to be read from
    equal_where_kept(ds.drop_vars("steps", errors="ignore"), whole)


def test_samples_and_events_by_their_names(whole):
    ds = gd.sweep(LOW, OVER, keep=["gear_speed", "events"])
    assert set(ds.data_vars) >= {"gear_speed", "event_kind", "event_torque", "event_sam_fraction", "verdict"}
    assert not {"mesh_force", "steps", "scene"} & set(ds.variables)
    equal_where_kept(ds, whole)
    assert ds.sel(sam_fraction=0.5, torque=5e-18).gearidae.scene == LOW.replace(
        {"coating.sam_fraction": 0.5, "drive.torque": 5e-18}
    )
    alone = gd.simulate(LOW.replace({"coating.sam_fraction": 0.5, "drive.torque": 5e-18}))
    picked = ds.gearidae.run(sam_fraction=0.5, torque=5e-18)
    assert np.array_equal(picked.event_time, alone.event_time)
    assert np.array_equal(picked.gear_speed, alone.gear_speed)


def test_every_group_together_is_everything(whole):
    ds = gd.sweep(LOW, OVER, keep=[*GROUPS, "reached", "skipped"])
    assert set(whole.variables) | {"verdict", "impacts", "flank_changes"} == set(ds.variables)
    equal_where_kept(ds, whole)
    assert ds.scene.identical(whole.scene)


def test_of_a_roller():
    over = {"roller.speed": [0.01, 0.02]}
    ds, whole = gd.sweep(ROLLER, over, keep=["extremes"]), gd.sweep(ROLLER, over)
    assert ds.verdict.values.tolist() == [outcome.verdict for outcome in outcomes(whole)]
    assert ds.gearidae.verdicts().largest_mesh_force.tolist() == whole.largest_mesh_force.values.tolist()


@pytest.mark.parametrize("keep", [["verdikt"], [3], ["height"], 7])
def test_unknown_names(keep):
    with pytest.raises(gd.SceneError) as error:
        gd.sweep(LOW, OVER, keep=keep)
    assert error.value.key == "keep"
    if keep == ["verdikt"]:
        assert "did you mean verdict" in str(error.value)


@pytest.mark.parametrize("keep", [["verdict"], ["gear_speed"], ["events", "extremes", "scene"]])
def test_the_archive_holds_the_same(tmp_path, keep):
    ds = gd.sweep(LOW, OVER, keep=keep, archive=tmp_path / "kept.nc")
    again = gd.open_archive(tmp_path / "kept.nc")
    xr.testing.assert_identical(again, ds)
    assert again.gearidae.verdicts().equals(ds.gearidae.verdicts())
    assert gd.sweep(LOW, OVER, keep=keep, archive=tmp_path / "kept.nc", resume=True).identical(ds)
    with pytest.raises(gd.SceneError, match="of another sweep"):
        gd.sweep(LOW, OVER, archive=tmp_path / "kept.nc", resume=True)


@pytest.mark.parametrize("name", ["verdict", "time", "gear_speed", "status"])
def test_an_archive_that_lacks_what_it_says_it_keeps_is_damaged(tmp_path, name):
    ds = gd.sweep(LOW, OVER, keep=["gear_speed"]).drop_vars(name)
    gd.save(ds, tmp_path / "kept.nc")
    with pytest.raises(gd.SceneError, match=f"it lacks {name}"):
        gd.open_archive(tmp_path / "kept.nc")


@pytest.mark.parametrize("keep", ["[", '["heat"]', "3"])
def test_an_archive_that_does_not_say_what_it_keeps_is_damaged(tmp_path, keep):
    gd.save(gd.sweep(LOW, OVER, keep=[]).assign_attrs(keep=keep), tmp_path / "kept.nc")
    with pytest.raises(gd.SceneError, match="is damaged"):
        gd.open_archive(tmp_path / "kept.nc")


def test_resumed_runs_are_judged_as_they_were(tmp_path):
    """Interrupted in the middle; the other half is computed, and all is as if nothing had happened."""
    archive = tmp_path / "kept.nc"

    def stop(done, total):
        if done >= 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        gd.sweep(LOW, OVER, keep=["extremes"], archive=archive, progress=stop, jobs=1)
    with Journal(journal_of(archive), "runs") as journal:
        assert 1 <= len(list(journal.frames())) < 4
    with pytest.raises(gd.SceneError, match="cut off"):
        gd.sweep(LOW, OVER, archive=archive)
    resumed = gd.sweep(LOW, OVER, keep=["extremes"], archive=archive, resume=True)
    xr.testing.assert_identical(without_times(resumed), without_times(gd.sweep(LOW, OVER, keep=["extremes"])))


def test_pictures_say_that_there_is_nothing_to_draw():
    ds = gd.sweep(LOW, OVER, keep=[])
    with pytest.raises(gd.SceneError, match="no samples of it"):
        gd.plot.gear_speed(ds)
    with pytest.raises(gd.SceneError, match="have not been kept"):
        ds.gearidae.events()


def test_command_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    over = ["--over", "coating.sam_fraction=1,0.5", "--set", "run.duration=2 ms", "run.samples=11"]
    sweep = [
        "sweep",
        "teodorescu2009_low_speed",
        *over,
        "--keep",
        "verdict",
        "min_gear_speed",
        "-o",
        "kept.nc",
    ]
    assert main(sweep) == 0
    assert "turned smoothly" in capsys.readouterr().out
    ds = gd.open_archive("kept.nc")
    assert set(ds.data_vars) == LEAST | {"min_gear_speed"}
    assert json.loads(ds.attrs["keep"]) == ["min_gear_speed", "verdict"]
    assert main(["info", "kept.nc"]) == 0
    out = capsys.readouterr().out
    assert "no samples" in out
    assert main(["plot", "kept.nc"]) == 0  # the outcomes, where there are no samples
    assert main(["plot", "kept.nc", "--picture", "gear_speed", "-o", "speed.png"]) == 2
    assert "no samples of it" in capsys.readouterr().err
    assert main(["report", "kept.nc"]) == 0
    assert "turned smoothly" in (tmp_path / "kept.html").read_text(encoding="utf-8")


def test_a_run_leaves_next_to_nothing():
    """With verdicts only each run adds less than 24 kB: its scene and some numbers, no model and no samples."""
    peaks = []
    for runs in (20, 20, 80):  # what is made once is made in the first
        over = {"drive.torque": np.linspace(4e-18, 5e-18, runs)}
        tracemalloc.start()
        try:
            ds = gd.sweep(LOW, over, keep=[], jobs=1)
            peaks.append(tracemalloc.get_traced_memory()[1])
        finally:
            tracemalloc.stop()
        assert ds.sizes == {"torque": runs}
    assert peaks[2] - peaks[1] < 60 * 24_000
