"""netCDF's library: Ctrl-C is heeded when the file is whole and no lock is left taken; threads and locks of others."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
import tracemalloc
from contextlib import contextmanager

import netCDF4
import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.archive import definition, netcdf_access, save
from gearidae.archive.netcdf import CheckedStore
from gearidae.archive.netcdf_access import LIBRARY, loaded, uninterrupted
from gearidae.cli import main


@pytest.fixture(scope="module")
def ds():
    return gd.simulate(gd.preset("roller_slow"), samples=11)


@pytest.fixture(autouse=True)
def interruptible():
    usual = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
    yield
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    signal.signal(signal.SIGINT, usual)


def interrupting(function):
    """The same function, which is interrupted as it begins."""

    def act(*arguments, **options):
        os.kill(os.getpid(), signal.SIGINT)
        return function(*arguments, **options)

    return act


def test_what_is_saved_is_whole_before_the_interrupt_counts(ds, tmp_path, monkeypatch):
    path = tmp_path / "roller.nc"
    with monkeypatch.context() as patched:
        patched.setattr(definition, "opened", interrupting(definition.opened))
        with pytest.raises(KeyboardInterrupt):
            gd.save(ds, path)
    xr.testing.assert_identical(gd.open_archive(path), ds)


def test_an_archive_can_be_opened_again_after_an_interrupt(ds, tmp_path, monkeypatch):
    path = gd.save(ds, tmp_path / "roller.nc")
    with monkeypatch.context() as patched:
        patched.setattr(CheckedStore, "open", interrupting(CheckedStore.open))
        with pytest.raises(KeyboardInterrupt):
            gd.open_archive(path)
    xr.testing.assert_identical(gd.open_archive(path), ds)


def test_an_interrupt_at_the_end_of_a_run_leaves_its_archive_finished(tmp_path, monkeypatch):
    """While the archive is written, where it once left a lock taken that closing the file waited for."""
    path = tmp_path / "roller.nc"
    with monkeypatch.context() as patched:
        patched.setattr(definition, "opened", interrupting(definition.opened))
        with pytest.raises(KeyboardInterrupt):
            gd.simulate(gd.preset("roller_slow"), samples=11, archive=path)
    resumed = gd.simulate(gd.preset("roller_slow"), samples=11, archive=path, resume=True)
    assert resumed.attrs["status"] == "finished"


def test_other_threads_and_ignored_interrupts_are_left_alone():
    done = []

    def work():
        with uninterrupted():
            done.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert done == [signal.default_int_handler]
    usual = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with uninterrupted():
            assert signal.getsignal(signal.SIGINT) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, usual)


THREADS = """
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import gearidae as gd

scene = gd.preset("roller_slow")
ds = gd.simulate(scene, samples=11)

def work(number):
    for _ in range(2):
        path = gd.save(ds, Path(sys.argv[1]) / f"{number}.nc", overwrite=True)
        assert gd.open_archive(path).identical(ds)
        gd.simulate(scene, samples=11, archive=path, overwrite=True)

with ThreadPoolExecutor(4) as executor:
    list(executor.map(work, range(4)))
"""


def test_threads_write_and_read_archives_side_by_side(tmp_path):
    """In a process of its own: netCDF's library ended it by a signal, each time."""
    done = subprocess.run([sys.executable, "-c", THREADS, str(tmp_path)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@contextmanager
def locked(path, seconds):
    """HDF5's lock on a file of a writer that has closed it, as a process that was started meanwhile has it."""
    fcntl = pytest.importorskip("fcntl")
    script = "import sys, time; sys.stdout.write('.'); sys.stdout.flush(); time.sleep(float(sys.argv[1]))"
    with path.open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        heir = subprocess.Popen(
            [sys.executable, "-c", script, str(seconds)], pass_fds=[file.fileno()], stdout=subprocess.PIPE
        )
        assert heir.stdout.read(1) == b"."  # it runs
    try:
        yield
    finally:
        heir.kill()
        heir.communicate()


def test_a_lock_that_a_process_inherited_is_waited_for(ds, tmp_path, monkeypatch):
    monkeypatch.setattr(netcdf_access, "_PATIENCE", 30.0)  # the process may be kept waiting itself
    path = gd.save(ds, tmp_path / "roller.nc")
    with locked(path, 0.2):
        xr.testing.assert_identical(gd.open_archive(path), ds)


def test_a_lock_that_lasts_is_an_error(ds, tmp_path, monkeypatch):
    monkeypatch.setattr(netcdf_access, "_PATIENCE", 0.5)
    path = gd.save(ds, tmp_path / "roller.nc")
    with locked(path, 60.0), pytest.raises(gd.SceneError, match="damaged or not a netCDF4 file"):
        gd.open_archive(path)
    xr.testing.assert_identical(gd.open_archive(path), ds)


# -- forks -----------------------------------------------------------------------------------------------------------


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_fork_while_a_thread_writes_can_use_the_library(ds, tmp_path):
    save(ds, tmp_path / "run.nc")
    writing = threading.Event()

    def write():
        with LIBRARY:
            writing.set()
            time.sleep(0.2)

    thread = threading.Thread(target=write)
    thread.start()
    writing.wait()
    child = os.fork()
    if not child:
        try:
            read = LIBRARY.acquire(timeout=20.0) and gd.open_archive(tmp_path / "run.nc").identical(ds)
            os._exit(0 if read else 1)
        finally:
            os._exit(2)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    thread.join()
    assert LIBRARY.acquire(timeout=20.0)
    LIBRARY.release()


# -- files that declare more than they hold --------------------------------------------------------------------------


def declaring(path, samples, **storage):
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", samples)
        for name, unit in (("time", "s"), ("gear_speed", "rad s-1"), *((f"x{n}", "1") for n in range(4))):
            file.createVariable(name, "f8", ("time",), chunksizes=(2**16,), **storage).units = unit


READERS = {
    "archive": gd.open_archive,
    "signal": gd.analysis.read_signal,
    "map": gd.analysis.open_map,
    "life": gd.studies.open_life,
}


@pytest.mark.parametrize("reader", READERS)
def test_a_small_file_that_declares_gigabytes_is_refused(reader, tmp_path):
    declaring(tmp_path / "large.nc", 200_000_000)
    assert (tmp_path / "large.nc").stat().st_size < 100_000
    tracemalloc.start()
    with pytest.raises(gd.SceneError, match=r"declares 9.6 GB and has 0.0\d+ MB"):
        READERS[reader](tmp_path / "large.nc")
    assert tracemalloc.get_traced_memory()[1] < 100e6
    tracemalloc.stop()


@pytest.mark.parametrize("command", [["info"], ["plot"], ["report"]])
def test_commands_refuse_it_in_one_line(command, tmp_path, capfd, monkeypatch):
    monkeypatch.chdir(tmp_path)
    declaring("large.nc", 200_000_000)
    assert main([*command, "large.nc"]) == 2
    (line,) = capfd.readouterr().err.splitlines()
    assert "declares 9.6 GB" in line


def test_a_chunk_that_is_too_large_is_refused(tmp_path):
    with netCDF4.Dataset(tmp_path / "large.nc", "w") as file:
        file.createDimension("time", None)
        for name in ("time", "gear_speed"):
            variable = file.createVariable(name, "f8", ("time",), chunksizes=(2**28,), zlib=True)
            variable.units = "s"
    with pytest.raises(gd.SceneError, match=r"declares 4\.29 GB"):
        gd.analysis.read_signal(tmp_path / "large.nc")


def test_what_compression_shrinks_most_is_read(tmp_path):
    """Deflate at its best: 160 MB of zeros."""
    path = tmp_path / "zeros.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", 20_000_000)
        variable = file.createVariable(
            "rest", "f8", ("time",), zlib=True, complevel=9, chunksizes=(20_000_000,)
        )
        variable[:] = np.zeros(20_000_000)
    assert path.stat().st_size < 170_000
    assert loaded(path).rest.size == 20_000_000


@pytest.mark.parametrize("how", ["simulate", "save"])
def test_an_archive_is_read_again_while_it_is_open(how, tmp_path):
    """netCDF's library ends the program where such a file holds a single text of varying length."""
    scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": "1 ms", "run.samples": 11})
    path = tmp_path / "run.nc"
    run = gd.simulate(scene, archive=path if how == "simulate" else None)
    if how == "save":
        save(run, path)
    program = (
        "import sys, xarray\n"
        "kept = xarray.open_dataset(sys.argv[1])\n"
        "for _ in range(3):\n"
        "    with xarray.open_dataset(sys.argv[1], cache=False) as again:\n"
        "        again.load()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, path], capture_output=True, text=True, timeout=120, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert gd.open(path).identical(run)
