"""netCDF's library: one thread at a time, no Ctrl-C in the middle, and files whose locks outlive their closing."""

from __future__ import annotations

import math
import os
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final, Literal

import netCDF4
import xarray as xr

from gearidae.archive.integrity import check_content, check_seal
from gearidae.archive.signals import signals_put_off

_PATIENCE: Final = 5.0
"""Time [s] for which a file's lock is waited for."""

LIBRARY: Final = threading.RLock()
"""To be held while netCDF's library is used, which may end the program if two threads do so at once."""
if hasattr(os, "register_at_fork"):
    # a process that is forked while a thread writes would find the lock taken for ever, and the library half changed
    os.register_at_fork(
        before=LIBRARY.acquire, after_in_parent=LIBRARY.release, after_in_child=LIBRARY.release
    )

_MOST_SHRUNK: Final = 1032
"""Bytes that one byte in a file can stand for: deflate, which HDF5 compresses by, shrinks nothing further."""
_ALWAYS_READ: Final = 128 * 2**20
"""Bytes that a file may declare in any case."""


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold `LIBRARY`, and put what a signal raises off until the block is left, or the function that this decorates.

    xarray takes its locks of HDF5 in Python code: an interrupt between taking one and entering what it guards leaves it
    taken, and the next call that closes the file waits for ever.
    """
    with signals_put_off(), LIBRARY:
        yield


@contextmanager
def opened(path: Path, mode: Literal["r", "a", "x"] = "r") -> Iterator[netCDF4.Dataset]:
    """Open a netCDF file of ours, with `LIBRARY` held.

    Parameters
    ----------
    mode : {"r", "a", "x"}, optional
        To read, to write into it, or to make it.
    """
    with LIBRARY:
        await_lock(path)
        file = netCDF4.Dataset(path, mode, keepweakref=True)
        try:
            yield file
        finally:
            close(file, written=mode != "r")


def close(file: netCDF4.Dataset, *, written: bool) -> None:
    """Close a file that was opened with weak references.

    Where the disk does not take the rest of a file, netCDF's library must close it once only: a second time, when the
    object goes, it uses memory that it has freed. So writing is tried before, and such a file closes with its object.

    Raises
    ------
    OSError, RuntimeError
        If the disk does not take it.
    """
    if written:
        file.sync()
    file.close()


def loaded(path: Path) -> xr.Dataset:
    """Read any netCDF file into memory; a damaged one may make the netCDF stack raise any exception.

    The classic format, which has no checksums, is left to scipy: netCDF's library may end the program there.
    """
    with path.open("rb") as file:
        is_classic = file.read(3) == b"CDF"
    if is_classic:
        with xr.open_dataset(path, decode_times=False, engine="scipy") as file:
            return file.load()
    with uninterrupted():
        check_seal(path)
        await_lock(path)
        with netCDF4.Dataset(path) as declared:
            check_size(declared, path)
        with xr.open_dataset(path, decode_times=False) as file:
            ds = file.load()
    check_content(ds)
    return ds


def check_size(file: netCDF4.Dataset, path: Path) -> None:
    """Refuse a file that declares more than it can hold: what is missing in it would be made up in memory.

    Parameters
    ----------
    file : netCDF4.Dataset
        As it has been opened.

    Raises
    ------
    ValueError
        If it does.
    """
    size = path.stat().st_size
    declared = sum(map(_declared, file.variables.values()))
    if declared > max(_MOST_SHRUNK * size, _ALWAYS_READ):
        raise ValueError(f"it declares {declared / 1e9:.3g} GB and has {size / 1e6:.3g} MB")


def _declared(variable: Any) -> int:
    """Bytes that a variable takes in memory, or one of its chunks if that is larger."""
    chunks = variable.chunking()
    pieces = chunks if isinstance(chunks, list) else variable.shape
    count: int = max(math.prod(variable.shape), math.prod(pieces))
    return count * int(getattr(variable.dtype, "itemsize", 8))


def await_lock(path: Path) -> None:
    """Wait for some seconds at most until a file can be opened for reading or writing beside nobody who writes it.

    HDF5 locks the files that it writes, and a process that another thread starts meanwhile has its copy of the lock
    until it closes what it inherited: the file, closed by then, could not be opened. Windows' processes inherit none.
    """
    end = time.monotonic() + _PATIENCE
    try:
        descriptor = os.open(path, os.O_RDONLY)
    except OSError:
        return  # opening it raises the error
    try:
        while not _is_free(descriptor) and time.monotonic() < end:
            time.sleep(0.001)
    except (ImportError, OSError):
        return  # no locks on this system, or file system
    finally:
        os.close(descriptor)  # which lifts the lock


def _is_free(descriptor: int) -> bool:
    """Whether no process holds a writer's lock on an open file, which is then locked as a reader does it."""
    if sys.platform != "win32":
        import fcntl

        try:
            fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
    return True
