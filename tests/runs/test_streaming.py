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
import signal
import time
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.archive import growing
from gearidae.cli import main
from gearidae.engine.integrate import driver, native, portable
from gearidae.runs import streaming
from gearidae.runs.kept_validity import largest_force
from gearidae.runs.validity import validity_attribute

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
    """Blocks, checkpoints and growth of the file all the time, by the driver whose limits are not compiled in."""
    monkeypatch.setattr(portable, "CHECKPOINT_STEPS", STEPS)
    monkeypatch.setattr(portable, "BLOCK_SECONDS", 0.0)
    monkeypatch.setattr(driver, "BLOCK_ROWS", 7)
    monkeypatch.setattr(growing, "CHECKPOINT_SECONDS", 0.0)
    monkeypatch.setattr(growing, "ROOM", {"event": 16, "passage": 1})
    monkeypatch.setattr(growing, "COPIED", 50)


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
    """What can be read of an unfinished archive is the beginning of the whole run."""
    with xr.open_dataset(path) as plain:
        assert plain.time[-1] == whole.time[-1]
        reached = int(plain.committed_samples)
    part = gd.open_archive(path)
    assert part.sizes["time"] == reached
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


def die_at_write(number):
    """Be killed in the middle of the call of that number that changes the archive."""
    count = itertools.count()

    def dying(call, half):
        def do(*arguments):
            if next(count) == number:
                half(*arguments)
                os.kill(os.getpid(), signal.SIGKILL)
            return call(*arguments)

        return do

    def write_half(self, name, first, values):
        write(self, name, first, values[: len(values) // 2])
        self._file.sync()

    write = growing.GrowingArchive._write
    growing.GrowingArchive._write = dying(write, write_half)
    growing.GrowingArchive._commit = dying(growing.GrowingArchive._commit, lambda self: None)
    os.fsync = dying(os.fsync, lambda descriptor: None)
    Path.replace = dying(Path.replace, lambda path, target: None)


@pytest.mark.usefixtures("many_small_blocks")
def test_killed_within_any_write_the_archive_is_sound_and_the_run_goes_on(path, whole):
    """Half of a write is the worst that a kill leaves behind; tried at many of them, one run after the other."""

    def killed(number):
        die_at_write(number)
        simulate(path, resume=True)

    for number in (0, 1, 3, 40, 7, 66, 14, 2):
        assert end_of(child(killed, number)) == -signal.SIGKILL
        if path.exists():
            with xr.open_dataset(path) as ds:
                ds.load()
            if "committed_samples" in ds:
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
    while done < kills and not (path.exists() and gd.open_archive(path).attrs["status"] == "finished"):
        process = child(lambda: simulate(path, scene, backend, resume=True))
        time.sleep(rng.uniform(0.0, longest))
        process.kill()
        end_of(process)
        done += 1
        if path.exists() and gd.open_archive(path).attrs["status"] != "finished":
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
    monkeypatch.setattr(growing, "CHECKPOINT_SECONDS", 0.0)
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
        if path.exists():
            looks.value += 1
            with xr.open_dataset(path) as plain:
                assert plain.sizes["time"] == 10_001
                if "committed_samples" in plain:
                    count = int(plain.committed_samples)
                    assert np.isfinite(plain.gear_speed[:count]).all()
                    seen.append(count)
            assert gd.open_archive(path).attrs["status"] in ("running", "interrupted", "finished")
    assert end_of(process) == 0
    assert seen == sorted(seen)
    assert len(set(seen)) > 5
    assert gd.open_archive(path).attrs["status"] == "finished"


def test_a_run_may_look_at_its_own_archive_and_nobody_else_may_write_it(path, monkeypatch):
    monkeypatch.setattr(native, "BLOCK_STEPS", 50)
    monkeypatch.setattr(native, "FIRST_STEPS", 50)
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


@pytest.mark.parametrize("name", ["committed_samples", "event_kind", "passage_pair", "gear_speed"])
def test_an_unfinished_archive_that_lacks_a_variable_is_refused(path, name):
    with pytest.raises(gd.Interrupted):
        simulate(path, progress=interrupt_after(0.5))
    with netCDF4.Dataset(path, "r+") as file:
        file.renameVariable(name, name[::-1])
    with pytest.raises(gd.SceneError, match=r"run\.nc: "):
        simulate(path, resume=True)


def test_ctrl_c_is_exit_130_and_resumable(path):
    """A signal to the program, as a terminal sends it."""
    arguments = ["run", "teodorescu2009", "--set", "run.duration=20 ms", "run.samples=2001", "-o", str(path)]

    def slowly():
        native.BLOCK_STEPS, take = 500, growing.GrowingArchive.take
        growing.GrowingArchive.take = lambda *block, **last: (time.sleep(0.02), take(*block, **last))
        return main(arguments)

    process = child(slowly)
    while not (path.exists() and gd.open_archive(path).sizes["time"] > 1):
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
    before = path.read_bytes()
    for changes, key in (
        ({"coating.sam_fraction": 0.6}, "coating.sam_fraction"),
        ({"run.rtol": 1e-7}, "run.rtol"),
        ({"run.samples": 202}, "run.samples"),
    ):
        with pytest.raises(gd.SceneError, match=rf"another scene \({key} differs\)"):
            simulate(path, LOW.replace(changes), resume=True)
    assert path.read_bytes() == before


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


def test_no_room_at_all_is_said_before_anything_is_run(path, capfd):
    simulate(path, gd.preset("roller_slow"))  # compiled code is kept before the limit
    path.unlink()

    def limited():
        resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))
        return main(["run", "roller_slow", "--set", "run.samples=100001", "-o", str(path)])

    assert end_of(child(limited)) == 3
    assert "could not be made" in capfd.readouterr().err
    assert list(path.parent.iterdir()) == []


@pytest.mark.usefixtures("many_small_blocks")
def test_a_disk_that_fills_up_leaves_what_was_written(path, whole, monkeypatch):
    """Room for the file as it begins, not for all the events; then room again."""
    write = growing.GrowingArchive._write

    def write_some(self, name, first, values):
        if name.startswith("event") and first >= whole.sizes["event"] // 2:
            full(path)
        write(self, name, first, values)

    monkeypatch.setattr(growing.GrowingArchive, "_write", write_some)
    with pytest.raises(gd.SolverError, match=r"could not be written \(No space left.*resume") as caught:
        simulate(path)
    part = assert_sound(path, whole)
    assert 0 < part.sizes["event"] < whole.sizes["event"]
    xr.testing.assert_identical(part, caught.value.dataset)
    monkeypatch.undo()
    monkeypatch.setattr(portable, "CHECKPOINT_STEPS", STEPS)
    simulate(path, resume=True)
    assert_same(gd.open_archive(path), whole)


def test_a_file_that_may_not_grow_ends_the_run_and_is_resumed(path):
    """As the system refuses it, in the library: the file may be a little larger than it begins."""
    scene = gd.preset("teodorescu2009").replace({"run.duration": 5e-3, "run.samples": 101})
    whole = gd.simulate(scene)
    case = path.with_name("case.toml")
    case.write_text(gd.dump_case(scene))

    def limited():
        native.BLOCK_STEPS, growing.ROOM = 500, {"event": 1024, "passage": 16}
        resource.setrlimit(resource.RLIMIT_FSIZE, (400_000, 400_000))
        return main(["run", str(case), "-o", str(path)])

    assert end_of(child(limited)) == 3
    part = assert_sound(path, whole)
    assert part.attrs["status"] == "interrupted"
    simulate(path, scene, "auto", resume=True)
    assert_same(gd.open_archive(path), whole)


def full(path):
    raise OSError(errno.ENOSPC, "No space left on device", str(path))


def test_no_room_for_the_final_form(path, monkeypatch):
    """The run is over, its archive still in the form of one under way: nothing is computed a second time."""
    whole = gd.simulate(LOW, backend="sksundae")
    monkeypatch.setattr(growing.GrowingArchive, "_compact", lambda self, template, part, **_: full(part))
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
