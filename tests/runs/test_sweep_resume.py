"""Sweeps that are cut off go on where they were, and end as if nothing had happened."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae import engine
from gearidae.errors import Interrupted
from gearidae.records import Events, Solution, Statistics
from gearidae.runs.run_cache import RunCache
from sweeps import without_times

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3, "run.samples": 101})
KEY = "coating.sam_fraction"
FRACTIONS = [1.0, 0.8, 0.6, 0.5, 0.48, 0.45]
SHOT = """
import os, pathlib, signal, sys
import gearidae as gd

low = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3, "run.samples": 101})

def shoot(done, total):
    if len(list(pathlib.Path(sys.argv[1] + ".runs").glob("*.npz"))) >= 3:
        os.kill(os.getpid(), signal.SIGKILL)

gd.sweep(low, {"coating.sam_fraction": [1.0, 0.8, 0.6, 0.5, 0.48, 0.45]}, jobs=1,
         archive=sys.argv[1], progress=shoot)
"""


@pytest.fixture
def computed(monkeypatch):
    """Fractions that the engine is asked for."""
    fractions = []
    solve = engine.solve

    def note(scene, **options):
        fractions.append(scene.coating.sam_fraction)
        return solve(scene, **options)

    monkeypatch.setattr(engine, "solve", note)
    return fractions


@pytest.fixture(scope="module")
def expected():
    return without_times(gd.sweep(LOW, {KEY: FRACTIONS}, jobs=1))


@pytest.fixture
def cut_off(tmp_path, monkeypatch):
    """Archive of a sweep that was cut off after four runs, as its folder remains."""
    archive = tmp_path / "sweep.nc"

    class CutOffError(Exception):
        pass

    def cut(done, total):
        if done > 4.0:  # the fifth has begun: the fourth is kept
            raise CutOffError

    with pytest.raises(CutOffError):
        gd.sweep(LOW, {KEY: FRACTIONS}, jobs=1, archive=archive, progress=cut)
    assert not archive.exists()
    return archive


def kept_files(archive):
    return sorted(archive.with_name(f"{archive.name}.runs").iterdir())


def test_a_killed_sweep_goes_on_and_equals_one_that_was_not(tmp_path, computed, expected):
    """The process shoots itself as soon as three runs are kept; what it had done is not done again."""
    archive = tmp_path / "sweep.nc"
    shot = subprocess.run([sys.executable, "-c", SHOT, archive], capture_output=True, check=False)
    assert shot.returncode == -signal.SIGKILL, shot.stderr
    assert not archive.exists()
    assert len(kept_files(archive)) == 3

    ds = gd.sweep(LOW, {KEY: FRACTIONS}, archive=archive, resume=True)
    assert len(computed) == len(FRACTIONS) - 3
    xr.testing.assert_identical(without_times(ds), expected)
    xr.testing.assert_identical(gd.open_archive(archive), ds)
    assert list(tmp_path.iterdir()) == [archive]


def test_a_sweep_that_is_not_cut_off_leaves_its_archive_only(tmp_path):
    gd.sweep(LOW, {KEY: FRACTIONS[:2]}, archive=tmp_path / "sweep.nc")
    assert list(tmp_path.iterdir()) == [tmp_path / "sweep.nc"]


def test_progress_begins_with_what_is_there(cut_off):
    seen = []
    gd.sweep(
        LOW,
        {KEY: FRACTIONS},
        jobs=1,
        archive=cut_off,
        resume=True,
        progress=lambda done, total: seen.append(done),
    )
    assert seen[0] == 4.0
    assert seen[-1] == 6.0


def test_an_unfinished_sweep_is_not_lost_by_mistake(cut_off, computed):
    with pytest.raises(gd.SceneError, match=r"4 of its runs are in sweep\.nc\.runs.*--resume.*--overwrite"):
        gd.sweep(LOW, {KEY: FRACTIONS}, archive=cut_off)
    assert len(kept_files(cut_off)) == 4
    assert computed == []


def test_overwrite_starts_anew(cut_off, computed, expected):
    ds = gd.sweep(LOW, {KEY: FRACTIONS}, jobs=1, archive=cut_off, overwrite=True)
    assert computed == FRACTIONS
    xr.testing.assert_identical(without_times(ds), expected)
    assert list(cut_off.parent.iterdir()) == [cut_off]


def test_ctrl_c_keeps_runs_to_go_on_from(tmp_path, monkeypatch, expected):
    """The archive of the interrupted sweep is replaced by the whole one."""
    archive = tmp_path / "sweep.nc"

    def interrupt(done, total):
        if done > 2.0:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(Interrupted, match="--resume") as caught:
        gd.sweep(LOW, {KEY: FRACTIONS}, jobs=1, archive=archive, progress=interrupt)
    assert caught.value.dataset.status.values.tolist() == ["finished"] * 2 + ["interrupted"] * 4
    xr.testing.assert_identical(gd.open_archive(archive), caught.value.dataset)
    assert len(kept_files(archive)) == 2
    ds = gd.sweep(LOW, {KEY: FRACTIONS}, archive=archive, resume=True)
    xr.testing.assert_identical(without_times(ds), expected)
    assert list(tmp_path.iterdir()) == [archive]


def test_a_whole_sweep_is_not_computed_again(tmp_path, computed):
    archive = tmp_path / "sweep.nc"
    ds = gd.sweep(LOW, {KEY: FRACTIONS[:2]}, archive=archive, resume=True)  # nothing to go on from: a start
    assert len(computed) == 2
    xr.testing.assert_identical(gd.sweep(LOW, {KEY: FRACTIONS[:2]}, archive=archive, resume=True), ds)
    assert len(computed) == 2


@pytest.mark.parametrize(
    ("changes", "settings"),
    [
        ({}, {"rtol": 1e-4}),
        ({}, {"samples": 51}),
        ({"drive.torque": 1e-9}, {}),
        ({}, {"backend": "sksundae"}),
    ],
)
def test_resume_replaces_no_archive_of_another_sweep(tmp_path, changes, settings):
    archive = tmp_path / "sweep.nc"
    gd.sweep(LOW, {KEY: FRACTIONS[:2]}, archive=archive)
    before = archive.read_bytes()
    with pytest.raises(gd.SceneError, match="another sweep"):
        gd.sweep(LOW.replace(changes), {KEY: FRACTIONS[:2]}, archive=archive, resume=True, **settings)
    with pytest.raises(gd.SceneError, match="another sweep"):
        gd.sweep(LOW, {KEY: FRACTIONS[:3]}, archive=archive, resume=True)
    assert archive.read_bytes() == before


def test_resume_replaces_no_other_file(tmp_path):
    archive = tmp_path / "sweep.nc"
    archive.write_bytes(b"precious")
    with pytest.raises(gd.SceneError, match="cannot be resumed"):
        gd.sweep(LOW, {KEY: FRACTIONS}, archive=archive, resume=True)
    assert archive.read_bytes() == b"precious"


def test_resume_needs_an_archive():
    with pytest.raises(gd.SceneError, match="resume"):
        gd.sweep(LOW, {KEY: FRACTIONS}, resume=True)


def flip(path):
    """Turn over one bit of one sample."""
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(bytes(content))


@pytest.mark.parametrize(
    "deed",
    [
        flip,
        lambda path: path.write_bytes(b""),
        lambda path: path.write_bytes(path.read_bytes()[:3000]),
        lambda path: path.write_bytes(b"\x80\x04\x95 not even a zip file"),
        lambda path: np.savez(path, samples=np.zeros(3)),
    ],
    ids=["one bit", "empty", "cut", "no zip", "no run"],
)
def test_damaged_runs_are_computed_again(cut_off, computed, expected, deed):
    deed(kept_files(cut_off)[1])
    with pytest.warns(UserWarning, match="ignored and its run computed again"):
        ds = gd.sweep(LOW, {KEY: FRACTIONS}, archive=cut_off, resume=True)
    assert len(computed) == 3
    xr.testing.assert_identical(without_times(ds), expected)
    assert list(cut_off.parent.iterdir()) == [cut_off]


def test_a_run_under_a_wrong_name_is_not_taken(cut_off, computed, expected):
    first, second, *_ = kept_files(cut_off)
    shutil.copy(first, second)
    with pytest.warns(UserWarning, match="another scene"):
        ds = gd.sweep(LOW, {KEY: FRACTIONS}, archive=cut_off, resume=True)
    assert len(computed) == 3
    xr.testing.assert_identical(without_times(ds), expected)


@pytest.mark.parametrize(
    "settings", [{"rtol": 1e-4}, {"samples": 51}, {"t_end": 1e-3}, {"backend": "sksundae"}]
)
def test_runs_with_other_settings_are_left_alone(cut_off, computed, settings):
    files = kept_files(cut_off)
    with pytest.warns(UserWarning, match="4 of the runs kept .* left there"):
        ds = gd.sweep(LOW, {KEY: FRACTIONS[:2]}, archive=cut_off, resume=True, **settings)
    assert len(computed) == 2
    fresh = gd.sweep(LOW, {KEY: FRACTIONS[:2]}, **settings)
    xr.testing.assert_identical(without_times(ds), without_times(fresh))
    assert kept_files(cut_off) == files


def test_other_files_in_the_folder_stay(cut_off):
    note = cut_off.with_name("sweep.nc.runs") / "note.txt"
    note.write_text("mine")
    gd.sweep(LOW, {KEY: FRACTIONS}, archive=cut_off, resume=True)
    assert kept_files(cut_off) == [note]


def test_what_a_kill_leaves_half_written_goes(cut_off):
    first = kept_files(cut_off)[0]
    half = first.with_name(f".{first.name}.123-0123abcd.part")
    half.write_bytes(b"half")
    gd.sweep(LOW, {KEY: FRACTIONS}, archive=cut_off, resume=True)
    assert list(cut_off.parent.iterdir()) == [cut_off]


def test_a_longer_list_takes_what_fits(cut_off, computed):
    gd.sweep(LOW, {KEY: [0.9, *FRACTIONS]}, jobs=1, archive=cut_off, resume=True)
    assert computed == [0.9, 0.48, 0.45]


def test_runs_that_failed_are_tried_again(tmp_path, monkeypatch):
    """Memory that ran out, or a worker that was lost, may be no trouble next time."""
    solve = engine.solve
    trouble = [0.8]

    def deed(scene, **options):
        if scene.coating.sam_fraction in trouble:
            raise MemoryError
        if scene.coating.sam_fraction == 0.5:
            raise KeyboardInterrupt
        return solve(scene, **options)

    monkeypatch.setattr(engine, "solve", deed)
    archive = tmp_path / "sweep.nc"
    with pytest.raises(KeyboardInterrupt):
        gd.sweep(LOW, {KEY: FRACTIONS}, jobs=1, archive=archive)
    assert len(kept_files(archive)) == 2
    monkeypatch.setattr(engine, "solve", solve)
    ds = gd.sweep(LOW, {KEY: FRACTIONS}, jobs=1, archive=archive, resume=True)
    assert set(ds.status.values) == {"finished"}


def test_a_folder_that_takes_no_runs_is_one_warning_and_not_the_end(tmp_path, expected):
    (tmp_path / "sweep.nc.runs").write_text("in the way")
    with pytest.warns(UserWarning, match="cannot be kept") as caught:
        ds = gd.sweep(LOW, {KEY: FRACTIONS}, archive=tmp_path / "sweep.nc")
    assert len(caught) == 1
    xr.testing.assert_identical(without_times(ds), expected)


def test_every_number_survives(tmp_path):
    """Values at the edges of their types, of which a run hardly has all."""
    numbers = np.array([0.0, -0.0, np.nan, np.inf, 5e-324, 1.0 + 2.0**-52])
    for count in (0, 6):
        events = Events(
            numbers[:count],
            np.arange(count, dtype=np.int8),
            np.array([0, -1, 2**52, 2**53, -(2**53), 1], np.int64)[:count],
            np.array([-1, 0, 1, 9, 127, -128], np.int8)[:count],
            -numbers[:count],
        )
        statistics = Statistics(1, 2, 3, 4, 5, 6, 7, 0.1, "native", {"coast": np.int64(3), "drag": True})
        samples = {"height": numbers[:count], "speed": -numbers[:count]}
        run = Solution(np.arange(float(count)), samples, events, statistics, "finished", "", 0.1 * count)
        kept = RunCache(tmp_path / "a.nc", LOW, "native")
        kept.keep(LOW, run)
        back, *judged = kept.take(LOW)
        for mine, theirs in [
            (run.time, back.time),
            *zip(run.samples.values(), back.samples.values(), strict=True),
            *((getattr(events, name), getattr(back.events, name)) for name in events.columns),
        ]:
            assert mine.dtype == theirs.dtype
            assert mine.tobytes() == theirs.tobytes()
        assert list(back.samples) == list(run.samples)
        assert (back.statistics, back.status, back.message) == (statistics, "finished", "")
        assert back.reached == 0.1 * count
        assert judged == [{}]
