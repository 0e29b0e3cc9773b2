"""Files that are on the disk when that matters, and what may go wrong with them."""

from __future__ import annotations

import errno
import os
import re
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

_NO_ROOM: Final = {getattr(errno, name) for name in ("ENOSPC", "EDQUOT", "EFBIG") if hasattr(errno, name)}
"""A full disk, a full share of one, and a limit of the system (``ulimit -f``)."""
_PROBE: Final = 2**16
"""Bytes."""


class DiskError(Exception):
    """The disk is full, or does not take or give the data for another reason."""


def no_room(error: Exception, part: Path) -> str:
    """Say what the system says if there is no room for a file: empty if that was not why it could not be written.

    netCDF's library calls a full disk by many names ("Permission denied", "HDF error"), so more is written to what
    there is of the file.
    """
    for said in (error, error.__cause__):
        if isinstance(said, OSError) and said.errno in _NO_ROOM:
            return said.strerror or str(said)
    try:
        with part.open("ab", buffering=0) as file:
            # as much as there is room for is written without an error
            while file.write(bytes(_PROBE)) < _PROBE:
                pass
    except OSError as refused:
        return (refused.strerror or "") if refused.errno in _NO_ROOM else ""
    return ""


def refuse_too_small(folder: Path, nbytes: int) -> None:
    """Refuse a disk that has no room for so many bytes in a folder.

    Raises
    ------
    OSError
        As the system says it when it is full.
    """
    if shutil.disk_usage(folder).free < nbytes:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@contextmanager
def disk_errors(part: Path | None = None) -> Iterator[None]:
    """Name what may go wrong with a file, which Python reports as one thing and netCDF4 as another.

    Parameters
    ----------
    part : Path, optional
        A file in the making, which is asked whether there is room for it.
    """
    try:
        yield
    except (OSError, RuntimeError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise DiskError((part and no_room(error, part)) or reason) from error


def part_beside(target: Path, ending: str = "") -> Path:
    """Name of a hidden file beside a target, of this process alone: written first, and renamed when it is whole."""
    return target.with_name(f".{target.name}.{os.getpid()}-{secrets.token_hex(4)}.part{ending}")


def drop_parts(target: Path) -> None:
    """Delete what processes that were killed while they wrote a target have left beside it."""
    name = re.compile(rf"\.{re.escape(target.name)}\.[0-9]+-[0-9a-f]{{8}}\.part")
    for path in target.parent.iterdir():
        if name.fullmatch(path.name):
            path.unlink(missing_ok=True)


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
