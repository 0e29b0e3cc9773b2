"""Sweeps that are cut off go on where they were, and end as if nothing had happened."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from contextlib import closing

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae import engine
from gearidae.archive.journal import Journal, journal_of
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
from gearidae.archive.journal import Journal

low = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3, "run.samples": 101})

def shoot(done, total):
    path = pathlib.Path(sys.argv[1] + ".journal")
    if path.exists() and sum(1 for frame in Journal(path, "runs").frames()) >= 3:
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


def kept(archive):
    """Frames of the runs in the journal beside an archive."""
    with Journal(journal_of(archive), "runs") as journal:
        return list(journal.frames())


def test_a_killed_sweep_goes_on_and_equals_one_that_was_not(tmp_path, computed, expected):
    """The process shoots itself as soon as three runs are kept; what it had done is not done again."""
    archive = tmp_path / "sweep.nc"
    shot = subprocess.run([sys.executable, "-c", SHOT, archive], capture_output=True, check=False)
    assert shot.returncode == -signal.SIGKILL, shot.stderr
    assert not archive.exists()
    assert len(kept(archive)) == 3

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
    with pytest.raises(
        gd.SceneError, match=r"4 of its runs are in sweep\.nc\.journal.*--resume.*--overwrite"
    ):
        gd.sweep(LOW, {KEY: FRACTIONS}, archive=cut_off)
    assert len(kept(cut_off)) == 4
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
    assert len(kept(archive)) == 2
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


@pytest.mark.parametrize("part", [0.01, 0.5, 0.99])
def test_damaged_runs_are_computed_again(cut_off, computed, expected, part):
    """One bit of a sample, or anything else of a run, is turned over: the others are taken."""
    _, second, *_ = kept(cut_off)
    path = journal_of(cut_off)
    content = bytearray(path.read_bytes())
    content[int(second.begin + 24 + part * (second.end - second.begin - 24))] ^= 1
    path.write_bytes(content)
    with pytest.warns(UserWarning, match="1 of the runs kept .* ignored and computed again"):
        ds = gd.sweep(LOW, {KEY: FRACTIONS}, archive=cut_off, resume=True)
    assert len(computed) == 3
    xr.testing.assert_identical(without_times(ds), expected)
    assert list(cut_off.parent.iterdir()) == [cut_off]


def test_runs_before_a_cut_are_taken(cut_off, computed, expected):
    _, second, *_ = kept(cut_off)
    os.truncate(journal_of(cut_off), second.end + 100)
    ds = gd.sweep(LOW, {KEY: FRACTIONS}, archive=cut_off, resume=True)
    assert len(computed) == 4
    xr.testing.assert_identical(without_times(ds), expected)
    assert list(cut_off.parent.iterdir()) == [cut_off]


@pytest.mark.parametrize(
    "content", [b"", b"gearidae", b"\x80\x04\x95 no journal" * 9], ids=["empty", "cut", "other"]
)
def test_what_is_no_journal_is_refused_and_overwritten(cut_off, computed, expected, content):
    journal_of(cut_off).write_bytes(content)
    for options in ({}, {"resume": True}):
        with pytest.raises(gd.SceneError, match=r"has no runs of a sweep.*overwrite") as caught:
            gd.sweep(LOW, {KEY: FRACTIONS}, archive=cut_off, **options)
        assert "\n" not in str(caught.value)
    assert journal_of(cut_off).read_bytes() == content
    assert computed == []
    ds = gd.sweep(LOW, {KEY: FRACTIONS}, archive=cut_off, overwrite=True)
    xr.testing.assert_identical(without_times(ds), expected)
    assert list(cut_off.parent.iterdir()) == [cut_off]


def test_runs_of_version_0_3_0_are_refused(tmp_path, computed):
    (tmp_path / "sweep.nc.runs").mkdir()
    (tmp_path / "sweep.nc.runs" / f"{'0' * 64}.npz").write_bytes(b"")
    for options in ({}, {"resume": True}, {"overwrite": True}):
        with pytest.raises(gd.SceneError, match=r"begun by gearidae 0\.3\.0: finish it with 0\.3\.0"):
            gd.sweep(LOW, {KEY: FRACTIONS}, archive=tmp_path / "sweep.nc", **options)
    assert computed == []


def test_a_run_that_is_no_run_is_computed_again(cut_off, computed, expected):
    """Made by hand, with sound checksums and a key that is asked for."""
    with Journal(journal_of(cut_off), "runs", "a") as journal:
        first, *_ = journal.frames()
        journal.append({"key": first.header["key"], "status": 3}, {})
    with pytest.warns(UserWarning, match="a run kept .* ignored and computed again"):
        ds = gd.sweep(LOW, {KEY: FRACTIONS}, archive=cut_off, resume=True)
    assert len(computed) == 3
    xr.testing.assert_identical(without_times(ds), expected)


@pytest.mark.parametrize(
    "settings", [{"rtol": 1e-4}, {"samples": 51}, {"t_end": 1e-3}, {"backend": "sksundae"}]
)
def test_runs_with_other_settings_are_left_alone(cut_off, computed, settings):
    before = journal_of(cut_off).read_bytes()
    with pytest.warns(UserWarning, match="4 of the runs kept .* left there"):
        ds = gd.sweep(LOW, {KEY: FRACTIONS[:2]}, archive=cut_off, resume=True, **settings)
    assert len(computed) == 2
    fresh = gd.sweep(LOW, {KEY: FRACTIONS[:2]}, **settings)
    xr.testing.assert_identical(without_times(ds), without_times(fresh))
    assert journal_of(cut_off).read_bytes().startswith(before)


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
    assert len(kept(archive)) == 2
    monkeypatch.setattr(engine, "solve", solve)
    ds = gd.sweep(LOW, {KEY: FRACTIONS}, jobs=1, archive=archive, resume=True)
    assert set(ds.status.values) == {"finished"}


def test_a_disk_that_takes_no_runs_is_one_warning_and_not_the_end(tmp_path, expected, monkeypatch):
    def full(self, *_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Journal, "append", full)
    with pytest.warns(UserWarning, match="cannot be kept") as caught:
        ds = gd.sweep(LOW, {KEY: FRACTIONS}, archive=tmp_path / "sweep.nc")
    assert len(caught) == 1
    xr.testing.assert_identical(without_times(ds), expected)
    assert [path.name for path in tmp_path.iterdir()] == ["sweep.nc"]


def test_a_disk_that_is_full_for_a_while_costs_the_runs_of_that_while(
    tmp_path, computed, expected, monkeypatch
):
    """What does not fit is taken back, so that the next runs are kept behind the last whole one."""
    archive, append, calls = tmp_path / "sweep.nc", Journal.append, []

    def sometimes(self, header, arrays):
        calls.append(1)
        if len(calls) in (2, 3):
            raise OSError(28, "No space left on device")
        return append(self, header, arrays)

    class CutOffError(Exception):
        pass

    def cut(done, total):
        if done > 5.0:
            raise CutOffError

    monkeypatch.setattr(Journal, "append", sometimes)
    with pytest.warns(UserWarning, match="cannot be kept"), pytest.raises(CutOffError):
        gd.sweep(LOW, {KEY: FRACTIONS}, jobs=1, archive=archive, progress=cut)
    del computed[:]
    ds = gd.sweep(LOW, {KEY: FRACTIONS}, jobs=1, archive=archive, resume=True)
    assert computed == [0.8, 0.6, 0.45]
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
        for act in ("keep", "take"):
            with closing(RunCache(tmp_path / "a.nc", LOW, "native")) as cache:
                if act == "keep":
                    cache.store(LOW, run)
                else:
                    back, *judged = cache.take(LOW)
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
