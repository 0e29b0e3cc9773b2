"""Reading and writing that is sure: all of a buffer, at its place, and on the disk when that matters."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

__all__ = ["DiskError", "disk_errors", "read_at", "sync", "write_at"]


class DiskError(Exception):
    """The disk is full, or does not take or give the data for another reason."""


@contextmanager
def disk_errors() -> Iterator[None]:
    """Name what may go wrong with a file, which Python reports as one thing and netCDF4 as another."""
    try:
        yield
    except (OSError, RuntimeError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise DiskError(reason) from error


def sync(path: Path) -> None:
    """Wait until a file, or a folder's list of names, is on the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def write_at(descriptor: int, data: NDArray[np.generic] | bytes, place: int) -> None:
    """Write all of `data` at byte `place` of a file.

    Raises
    ------
    OSError
        If the disk does not take it.
    """
    rest = memoryview(data if isinstance(data, bytes) else data.tobytes())
    while rest:
        written = os.pwrite(descriptor, rest, place)
        rest, place = rest[written:], place + written


def read_at(descriptor: int, size: int, place: int) -> bytes:
    """Read `size` bytes from byte `place` of a file.

    Raises
    ------
    OSError
        If the file ends before, or cannot be read.
    """
    parts = []
    while size > 0:
        part = os.pread(descriptor, size, place)
        if not part:
            raise OSError("the file has been cut short")
        parts.append(part)
        size, place = size - len(part), place + len(part)
    return b"".join(parts)
