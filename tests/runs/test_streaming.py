"""Runs into an archive: readable at any instant, and the same run whatever has stopped it on the way."""

from __future__ import annotations

import errno
import faulthandler
import itertools
import json
import multiprocessing
import os
import random
import resource
import shutil
import signal
import time
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.archive import definition, journal, lock, netcdf, unfinished
from gearidae.archive.journal import journal_of
from gearidae.cli import main
from gearidae.engine import native, portable
from gearidae.engine.integrate import driver
from gearidae.records import COUNTERS
from gearidae.runs import streaming
from gearidae.runs.kept_validity import largest_force
from gearidae.runs.validity import validity_attribute
from gearidae.scene.sampled import columns_of

LOW = gd.preset("teodorescu2009_low_speed").replace(
    {"coating.sam_fraction": 0.5, "run.duration": 0.0025, "run.samples": 201}
)
START_UP = gd.load_case(Path(__file__).parents[2] / "cases" / "start_up.toml")
HANGS = 60.0
"""Seconds after which a child counts as hanging: its work takes less than five on a busy machine."""
STEPS = 150
"""Of the portable driver between checkpoints, of which a run shall have some; each starts the solver anew."""
MOMENTARY = ("history", "date_created", "wall_time")
"""Attributes in which two runs of one scene may differ."""


@pytest.fixture
def path(tmp_path):
    return tmp_path / "run.nc"


@pytest.fixture(scope="module")
def whole():
    """The run of `LOW` with checkpoints as in `many_small_blocks`, in memory."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(portable, "CHECKPOINT_STEPS", STEPS)
        return gd.simulate(LOW, backend="sksundae")


@pytest.fixture
def many_small_blocks(monkeypatch):
    """Blocks, frames and checkpoints all the time, by the driver whose limits are not compiled in."""
    monkeypatch.setattr(portable, "CHECKPOINT_STEPS", STEPS)
    monkeypatch.setattr(portable, "BLOCK_SECONDS", 0.0)
    monkeypatch.setattr(driver, "BLOCK_ROWS", 7)
    monkeypatch.setattr(unfinished, "CHECKPOINT_SECONDS", 0.0)
    monkeypatch.setattr(unfinished, "CHECKPOINT_SHARE", 0.0)
    monkeypatch.setattr(unfinished, "FRAME_SHARE", 0.0)


def assert_same(first, second):
    """Two archives, or an archive and what was computed in memory, which has no attribute ``validity``."""
    first, second = first.copy(), second.copy()
    limits = validity_attribute(gd.Scene.from_dict(json.loads(first.attrs["scene"])), largest_force(first))
    for ds in (first, second):
        assert ds.attrs.pop("validity", limits) == limits
    for name in MOMENTARY:
        first.attrs.pop(name)
        second.attrs.pop(name)
    xr.testing.assert_identical(first, second)


def assert_sound(path, whole):
    """What can be read of a run that is not finished is its beginning."""
    part = gd.open_archive(path)
    if part.attrs["status"] == "finished":
        assert_same(part, whole)
    else:
        for name in whole.variables:
            if whole[name].dims:
                np.testing.assert_array_equal(part[name], whole[name][: part[name].size])
    return part


def child(work, *arguments):
    """Start a copy of this process that does some work; its exit code is what the work returns."""

    def act():
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
        faulthandler.dump_traceback_later(HANGS, exit=True)  # says where, if it hangs
        os._exit(work(*arguments) or 0)

    process = multiprocessing.get_context("fork").Process(target=act)
    process.start()
    return process


def end_of(process):
    process.join(2.0 * HANGS)
    assert process.exitcode is not None
    return process.exitcode


def simulate(path, scene=LOW, backend="sksundae", **options):
    gd.simulate(scene, archive=path, backend=backend, **options)


# -- killed --------------------------------------------------------------------------------------------------


def is_there(path):
    """Whether anything of a run is on the disk."""
    return path.exists() or journal_of(path).exists()


def die_at_write(number):
    """Be killed in the middle of the call of that number that changes what is on the disk."""
    count = itertools.count()

    def dying(call, half):
        def do(*arguments, **options):
            if next(count) == number:
                half(*arguments)
                os.kill(os.getpid(), signal.SIGKILL)
            return call(*arguments, **options)

        return do

    def append_half(self, header, arrays):
        content = b"".join(map(bytes, journal._packed(header, arrays)))
        self._file.seek(self.end)
        self._file.write(content[: len(content) // 2])

    journal.Journal.append = dying(journal.Journal.append, append_half)
    journal.Journal.cut = dying(journal.Journal.cut, lambda self, end: None)
    os.fsync = dying(os.fsync, lambda descriptor: None)
    Path.replace = dying(Path.replace, lambda path, target: None)
    Path.unlink = dying(Path.unlink, lambda path, **_: None)


@pytest.mark.usefixtures("many_small_blocks")
def test_killed_within_any_write_the_archive_is_sound_and_the_run_goes_on(path, whole):
    """Half of a write is the worst that a kill leaves behind; tried at many of them, one run after the other."""

    def killed(number):
        die_at_write(number)
        simulate(path, resume=True)

    assert end_of(child(killed, 0)) == -signal.SIGKILL
    assert not is_there(path)  # the journal appears with its head
    for number in (2, 3, 5, 40, 7, 66, 14, 2):
        assert end_of(child(killed, number)) == -signal.SIGKILL
        assert_sound(path, whole)
    simulate(path, resume=True)
    assert_same(gd.open_archive(path), whole)
    assert [file.name for file in path.parent.iterdir()] == [path.name]


def kill_again_and_again(path, scene, backend, kills, share):
    """Run a scene to its end through kills at random instants, at most a share of the whole run's time apart."""
    rng = random.Random(2009)
    gd.simulate(scene, backend=backend, t_end=1e-9, samples=11)  # loads what is compiled
    began = time.monotonic()
    whole = gd.simulate(scene, backend=backend)
    longest = share * (time.monotonic() - began)
    done = 0
    while done < kills and not path.exists():
        process = child(lambda: simulate(path, scene, backend, resume=True))
        time.sleep(rng.uniform(0.0, longest))
        process.kill()
        end_of(process)
        done += 1
        if is_there(path):
            assert_sound(path, whole)
    simulate(path, scene, backend, resume=True)
    assert_same(gd.open_archive(path), whole)
    return done


@pytest.mark.usefixtures("many_small_blocks")
def test_killed_at_five_random_instants_and_resumed_is_the_same_run(path):
    # if this process has to wait the run may reach its end before the fifth
    assert 2 <= kill_again_and_again(path, LOW, "sksundae", 5, 0.2) <= 5


@pytest.mark.by_hand
@pytest.mark.usefixtures("many_small_blocks")
def test_killed_at_fifteen_random_instants_and_resumed_is_the_same_run(path):
    """As many as it takes to hit all that a run does."""
    scene = LOW.replace({"run.duration": 0.1, "run.samples": 801})
    assert kill_again_and_again(path, scene, "sksundae", 15, 0.05) == 15


@pytest.mark.by_hand
def test_start_up_killed_at_random_instants_is_the_same_run(path, monkeypatch):
    """The native driver takes a checkpoint about every fifth of a second, which is compiled in."""
    monkeypatch.setattr(unfinished, "CHECKPOINT_SECONDS", 0.0)
    scene = START_UP.replace({"run.duration": 0.015})
    assert kill_again_and_again(path, scene, "native", 50, 0.5) > 2


# -- read while it runs --------------------------------------------------------------------------------------


def test_readable_at_any_time_while_the_run_goes_on(path, monkeypatch):
    monkeypatch.setattr(native, "BLOCK_STEPS", 500)
    scene = START_UP.replace({"run.duration": 5e-3, "run.samples": 10_001})
    looks, next_wait = multiprocessing.Value("i", 0), [0.05]

    def await_looks(reached, events):
        """Go on when somebody has looked since the last twentieth of the run, on however slow a machine."""
        if reached >= next_wait[0] * scene.run.duration:
            next_wait[0] += 0.05
            wanted = looks.value + 2  # the first may have begun before
            while looks.value < wanted:
                time.sleep(1e-3)

    process = child(lambda: simulate(path, scene, "native", progress=await_looks))
    seen = []
    while process.is_alive():
        if is_there(path):
            looks.value += 1
            part = gd.open_archive(path)
            assert part.attrs["status"] in ("running", "interrupted", "finished")
            assert np.isfinite(part.gear_speed).all()
            seen.append(part.sizes["time"])
    assert end_of(process) == 0
    assert seen == sorted(seen)
    assert len(set(seen)) > 5
    assert not journal_of(path).exists()
    assert gd.open_archive(path).attrs["status"] == "finished"


def test_a_run_may_look_at_its_own_archive_and_nobody_else_may_write_it(path, monkeypatch):
    monkeypatch.setattr(native, "BLOCK_STEPS", 50)
    monkeypatch.setattr(native, "FIRST_STEPS", 50)
    monkeypatch.setattr(lock, "_PATIENCE", 0.02)  # the lock is held for good
    looked = []

    def look(reached, events):
        ds = gd.open_archive(path)
        assert ds.attrs["status"] == "running"
        assert ds.sizes["event"] == events
        for option in ("resume", "overwrite"):
            with pytest.raises(gd.SceneError, match="being written by another run"):
                simulate(path, backend="native", **{option: True})
        looked.append(ds.sizes["time"])

    simulate(path, backend="native", progress=look)
    assert len(looked) > 3
    assert looked[0] < looked[-1] == 201


# -- interrupted, and taken up again -------------------------------------------------------------------------


def interrupt_after(share):
    def on_progress(reached, events):
        if reached > share * LOW.run.duration:
            raise KeyboardInterrupt

    return on_progress


@pytest.mark.usefixtures("many_small_blocks")
def test_interrupted_and_resumed_is_the_same_run(path, whole):
    for share in (0.2, 0.6):
        with pytest.raises(gd.errors.Interrupted) as caught:
            simulate(path, resume=True, progress=interrupt_after(share))
        part = assert_sound(path, whole)
        assert part.attrs["status"] == "interrupted"
        assert part.time[-1] >= 0.9 * share * LOW.run.duration
        xr.testing.assert_identical(part, caught.value.dataset)
    wall_time = part.attrs["wall_time"]
    simulate(path, resume=True)
    finished = gd.open_archive(path)
    assert_same(finished, whole)
    assert finished.attrs["wall_time"] > wall_time > 0.0


@pytest.mark.parametrize(
    ("change", "allowed"),
    [
        ({"samples": np.zeros((2, 3))}, "is not of its scene"),
        ({"events": np.zeros((3, 3))}, "is not of its scene"),
        ({"state": np.zeros((2, 2), np.uint64)}, "is not of its scene"),
        ({"samples": np.zeros((len(columns_of(LOW)), 500))}, "more samples than its scene"),
        ({"samples": np.zeros((len(columns_of(LOW)), 0)), "state": np.zeros(9, np.uint64)}, "KeyError"),
    ],
    ids=["columns", "rows", "state", "length", "header"],
)
def test_a_journal_that_does_not_fit_its_scene_is_refused(path, change, allowed):
    """Made by hand, with sound checksums."""
    with pytest.raises(gd.Interrupted):
        simulate(path, progress=interrupt_after(0.5))
    with journal.Journal(journal_of(path), "run", "a") as file:
        *_, last = file.frames()
        tables = {name: file.table(last, name) for name in last.shapes}
        file.append({"time": 0.0}, {**tables, **change})
    for read in (gd.open, lambda path: simulate(path, resume=True)):
        with pytest.raises(gd.SceneError, match=allowed):
            read(path)


def test_a_state_that_is_none_of_this_scene_is_refused_by_the_engine(path):
    """Its checksums are sound; what the words mean, the engine checks."""
    with pytest.raises(gd.Interrupted):
        simulate(path, progress=interrupt_after(0.5))
    counts = {counter.name: 1 for counter in COUNTERS}
    with journal.Journal(journal_of(path), "run", "a") as file:
        *_, last = file.frames()
        tables = {name: file.table(last, name) for name in last.shapes} | {
            "state": np.full(40, 2**62, np.uint64)
        }
        header = {"time": 1e-3, "wall_time": 0.0, "statistics": counts, "balance": None, "extremes": None}
        file.append(header, {**tables, "samples": tables["samples"][:, :0]})
    with pytest.raises(gd.SceneError, match="checkpoint"):
        simulate(path, resume=True)


def test_what_version_0_3_0_has_not_finished_is_refused(path):
    names = b"CDF\x05" + bytes(8) + b"\0\0\0\x0brecord_byte"
    path.write_bytes(names + bytes(5000))
    for read in (gd.open, lambda path: simulate(path, resume=True)):
        with pytest.raises(gd.SceneError, match=r"gearidae 0\.3\.0 has not finished: finish it"):
            read(path)


def test_files_beside_an_unfinished_run_are_refused_by_name(path):
    """Nobody begins a run, a sweep or a file by mistake where another has not been finished."""
    with pytest.raises(gd.Interrupted):
        simulate(path, progress=interrupt_after(0.5))
    before = journal_of(path).read_bytes()
    over = {"coating.sam_fraction": [0.5]}
    for write in (
        simulate,
        lambda path: gd.save(gd.open(path), path),
        lambda path: gd.sweep(LOW, over, archive=path),
        lambda path: gd.sweep(LOW, over, archive=path, resume=True),
    ):
        with pytest.raises(gd.SceneError, match=r"run\.nc\.journal.*overwrite"):
            write(path)
    assert journal_of(path).read_bytes() == before
    ds = gd.sweep(LOW, over, archive=path, overwrite=True)
    xr.testing.assert_identical(gd.open(path), ds)
    assert [file.name for file in path.parent.iterdir()] == [path.name]


def test_a_journal_is_opened_by_its_own_name_too(path):
    with pytest.raises(gd.Interrupted):
        simulate(path, progress=interrupt_after(0.5))
    xr.testing.assert_identical(gd.open(journal_of(path)), gd.open(path))


def test_ctrl_c_is_exit_130_and_resumable(path):
    """A signal to the program, as a terminal sends it."""
    arguments = ["run", "teodorescu2009", "--set", "run.duration=20 ms", "run.samples=2001", "-o", str(path)]

    def slowly():
        native.BLOCK_STEPS, take = 500, unfinished.RunJournal.take
        unfinished.RunJournal.take = lambda *block, **last: (time.sleep(0.02), take(*block, **last))
        return main(arguments)

    process = child(slowly)
    while not (is_there(path) and gd.open_archive(path).sizes["time"] > 1):
        assert process.is_alive()
        time.sleep(0.005)
    os.kill(process.pid, signal.SIGINT)
    assert end_of(process) == 130
    assert gd.open_archive(path).attrs["status"] == "interrupted"
    assert main([*arguments, "--resume"]) == 0
    whole = gd.simulate(gd.preset("teodorescu2009"), t_end=20e-3, samples=2001)
    assert_same(gd.open_archive(path), whole)


def test_ctrl_c_after_the_last_step_is_resumable(path, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    whole = gd.simulate(LOW, backend="sksundae")
    with monkeypatch.context() as patched:
        patched.setattr(streaming, "log_imbalance", interrupted)
        with pytest.raises(gd.Interrupted, match="--resume"):
            simulate(path)
    assert gd.open_archive(path).sizes["time"] == whole.sizes["time"]
    simulate(path, resume=True)
    assert_same(gd.open_archive(path), whole)


def test_resuming_what_is_finished_says_so(path, capfd):
    arguments = ["run", "roller_slow", "-o", str(path), "--resume"]
    assert main(arguments) == 0  # nothing there yet: the run begins
    assert "before" not in capfd.readouterr().out
    before = path.read_bytes()
    assert main(arguments) == 0
    assert "already finished" in capfd.readouterr().out
    assert path.read_bytes() == before


@pytest.mark.parametrize("share", [0.5, 2.0], ids=["interrupted", "finished"])
def test_another_scene_is_refused_and_named(path, share):
    try:
        simulate(path, progress=interrupt_after(share))
    except KeyboardInterrupt:
        assert share < 1.0
    file = path if share > 1.0 else journal_of(path)
    before = file.read_bytes()
    for changes, key in (
        ({"coating.sam_fraction": 0.6}, "coating.sam_fraction"),
        ({"run.rtol": 1e-7}, "run.rtol"),
        ({"run.samples": 202}, "run.samples"),
    ):
        with pytest.raises(gd.SceneError, match=rf"another scene \({key} differs\)"):
            simulate(path, LOW.replace(changes), resume=True)
    assert file.read_bytes() == before


def test_what_cannot_be_resumed_is_refused(path, end_early):
    path.write_bytes(b"precious")
    with pytest.raises(gd.SceneError, match="not a netCDF4 file"):
        simulate(path, resume=True)
    path.unlink()
    gd.sweep(LOW, {"coating.sam_fraction": [0.5]}, archive=path)
    with pytest.raises(gd.SceneError, match="of a sweep"):
        simulate(path, resume=True)
    end_early("chatter")
    with pytest.raises(gd.SolverError):
        simulate(path, overwrite=True)
    with pytest.raises(gd.SceneError, match="ended early"):
        simulate(path, resume=True)
    end_early("interrupted")
    with pytest.raises(KeyboardInterrupt):
        simulate(path, overwrite=True)
    with pytest.raises(gd.SceneError, match="goes on with nothing else"):
        simulate(path, backend="native", resume=True)


# -- disk full -----------------------------------------------------------------------------------------------


def limited(path, room, *settings):
    """Run a roller where no file may be larger than some bytes; the exit code."""

    def run():
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))
        return main(["run", "roller_slow", "-o", str(path), "--resume", *settings])

    return end_of(child(run))


def test_no_room_at_all_is_said_before_anything_is_run(path, capfd, monkeypatch):
    simulate(path, gd.preset("roller_slow"))  # compiled code is kept before the limit
    path.unlink()
    assert limited(path, 1000) == 3
    assert "could not be made (File too large)" in capfd.readouterr().err
    assert list(path.parent.iterdir()) == []
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: Mock(free=80_000))
    assert main(["run", "roller_slow", "--set", "run.samples=100001", "-o", str(path)]) == 3
    assert "could not be made (No space left on device)" in capfd.readouterr().err
    assert list(path.parent.iterdir()) == []


def test_a_disk_that_fills_up_anywhere_is_exit_3_and_the_run_goes_on(path, capfd):
    """The system refuses what is beyond some size: of the journal, and of the archive."""
    scene = gd.preset("roller_slow").replace({"run.samples": 2001})
    whole = gd.simulate(scene)
    simulate(path, scene, "auto")
    needed = path.stat().st_size
    path.unlink()
    endings = []
    for room in (5_000, 10_000, 20_000, 40_000, 60_000, needed - 1):
        endings.append(limited(path, room, "--set", "run.samples=2001"))
        *before, said = capfd.readouterr().err.splitlines()
        assert "File too large" in said
        assert all("begins anew" in line for line in before)
        if is_there(path):
            assert assert_sound(path, whole).attrs["status"] == "interrupted"
        assert not path.exists()
    assert endings == [3] * len(endings)
    assert limited(path, needed + 10_000, "--set", "run.samples=2001") == 0
    assert_same(gd.open_archive(path), whole)


@pytest.mark.usefixtures("many_small_blocks")
def test_a_disk_that_fills_up_leaves_what_was_written(path, whole, monkeypatch):
    """Room for the first half of the run; then room again."""
    append = journal.Journal.append

    def append_some(self, header, arrays):
        if self.end > 40_000:
            full(path)
        return append(self, header, arrays)

    monkeypatch.setattr(journal.Journal, "append", append_some)
    with pytest.raises(gd.SolverError, match=r"could not be written \(No space left.*resume") as caught:
        simulate(path)
    part = assert_sound(path, whole)
    assert 0 < part.sizes["event"] < whole.sizes["event"]
    xr.testing.assert_identical(part, caught.value.dataset)
    monkeypatch.undo()
    monkeypatch.setattr(portable, "CHECKPOINT_STEPS", STEPS)
    simulate(path, resume=True)
    assert_same(gd.open_archive(path), whole)


def full(path):
    raise OSError(errno.ENOSPC, "No space left on device", str(path))


def test_no_room_for_the_final_form(path, monkeypatch):
    """The run is over, and still in its journal: nothing is computed a second time."""
    whole = gd.simulate(LOW, backend="sksundae")
    monkeypatch.setattr(netcdf, "write", lambda ds, part, **_: full(part))
    with pytest.raises(gd.SolverError, match="No space left"):
        simulate(path)
    assert assert_sound(path, whole).sizes["time"] == whole.sizes["time"]
    monkeypatch.undo()
    monkeypatch.setattr("gearidae.engine.backend.run_blocks", lambda *_: pytest.fail("the run was repeated"))
    simulate(path, resume=True)
    assert_same(gd.open_archive(path), whole)


# -- memory, and what is sampled -----------------------------------------------------------------------------


def peak_memory(path, samples):
    """Peak of a run's memory beyond what this process held before [MB]."""
    scene = gd.preset("roller_slow").replace({"run.samples": samples})
    answer = multiprocessing.get_context("fork").SimpleQueue()

    def run():
        Path("/proc/self/clear_refs").write_text("5")
        before = high_water()
        simulate(path, scene, "native", overwrite=True)
        answer.put((high_water() - before) / 1e6)

    assert end_of(child(run)) == 0
    return answer.get()


def high_water():
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


def test_memory_does_not_depend_on_the_length(path, monkeypatch):
    """A run of 64 MB takes as much as one of 3 MB, within the size of a few buffers (8 MB each)."""
    monkeypatch.setattr(streaming, "open_archive", lambda path: None)  # measured is the run, not its reader
    for module in (streaming, definition):
        monkeypatch.setattr(module, "LONGEST_WHOLE", 2**20)
    simulate(path, gd.preset("roller_slow"), "native")
    short, long = peak_memory(path, 100_001), peak_memory(path, 2_000_001)
    assert long < short + 30.0
    monkeypatch.undo()
    with xr.open_dataset(path) as ds:
        assert ds.nbytes > 60e6


@pytest.mark.parametrize("archived", [False, True])
def test_samples_off_keeps_the_events(archived, path):
    whole = gd.simulate(LOW)
    ds = gd.simulate(LOW, samples="off", **({"archive": path} if archived else {}))
    assert ds.sizes["time"] == 0
    assert ds.gear_speed.dims == ("time",)
    xr.testing.assert_equal(ds.event_time, whole.event_time)
    xr.testing.assert_equal(ds.event_kind, whole.event_kind)
    assert f"simulated {LOW.run.duration:g} s" in ds.attrs["history"]


def test_samples_at_a_rate():
    ds = gd.simulate(LOW, samples="5 kHz", t_end=2e-3)
    np.testing.assert_array_equal(ds.time, np.linspace(0.0, 2e-3, 11))
