"""Reading and writing that is sure: all of a buffer, at its place, and on the disk when that matters.

Systems differ in what they have for it: Windows has neither ``pread`` nor ``pwrite``, nor folders that can be waited
for; macOS has no ``fdatasync``. What is there is used, and the next best thing where it is not.
"""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

__all__ = ["DiskError", "commit", "disk_errors", "open_file", "part_beside", "read_at", "sync", "write_at"]

_BINARY: Final[int] = getattr(os, "O_BINARY", 0)  # or Windows would take line ends for texts'


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


def open_file(path: Path) -> int:
    """Open a file to read and write at any place of it; its descriptor, which no other program inherits."""
    return os.open(path, os.O_RDWR | _BINARY)


def part_beside(target: Path, ending: str = "") -> Path:
    """Name of a hidden file beside a target, of this process alone: written first, and renamed when it is whole."""
    return target.with_name(f".{target.name}.{os.getpid()}-{secrets.token_hex(4)}.part{ending}")


def commit(descriptor: int) -> None:
    """Wait until what has been written to an open file is on the disk."""
    getattr(os, "fdatasync", os.fsync)(descriptor)


def sync(path: Path) -> None:
    """Wait until a file, or a folder's list of names where the system can wait for that, is on the disk."""
    is_folder = path.is_dir()
    if is_folder and not hasattr(os, "O_DIRECTORY"):
        return
    # Windows waits only for files that are open for writing
    descriptor = os.open(path, os.O_RDONLY) if is_folder else open_file(path)
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
        written = _write(descriptor, rest, place)
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
        part = _read(descriptor, size, place)
        if not part:
            raise OSError("the file has been cut short")
        parts.append(part)
        size, place = size - len(part), place + len(part)
    return b"".join(parts)


def _write(descriptor: int, data: memoryview, place: int) -> int:
    """Write as much as the system takes at once; the number of bytes."""
    at_place = getattr(os, "pwrite", None)
    if at_place is not None:
        return int(at_place(descriptor, data, place))
    os.lseek(descriptor, place, os.SEEK_SET)
    return os.write(descriptor, data)


def _read(descriptor: int, size: int, place: int) -> bytes:
    """Read as much as the system gives at once, nothing at the file's end."""
    at_place = getattr(os, "pread", None)
    if at_place is not None:
        return bytes(at_place(descriptor, size, place))
    os.lseek(descriptor, place, os.SEEK_SET)
    return os.read(descriptor, size)
