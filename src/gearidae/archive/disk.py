"""Files that are on the disk when that matters, and what may go wrong with them."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


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


def part_beside(target: Path, ending: str = "") -> Path:
    """Name of a hidden file beside a target, of this process alone: written first, and renamed when it is whole."""
    return target.with_name(f".{target.name}.{os.getpid()}-{secrets.token_hex(4)}.part{ending}")


def sync(path: Path) -> None:
    """Wait until a file, or a folder's list of names where the system can wait for that, is on the disk."""
    is_folder = path.is_dir()
    if is_folder and not hasattr(os, "O_DIRECTORY"):
        return
    # Windows waits only for files that are open for writing
    descriptor = os.open(path, os.O_RDONLY if is_folder else os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
