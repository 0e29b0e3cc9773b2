"""Look at the global heaps of an HDF5 file, which have no checksum, before the library does.

A heap lists objects, each with a header that states its size. HDF5 goes from header to header and never comes to an
end at a size of zero, which a single changed bit can make it see; no Ctrl-C ends that. All else that describes a file's
variables has checksums.

Format: HDF5 File Format Specification version 3.0, section III.E, "Disk Format: Level 1E - Global Heap".
"""

from __future__ import annotations

import mmap
import struct
from pathlib import Path
from typing import Final

from gearidae.errors import SceneError

__all__ = ["check_heaps"]

_SIGNATURE: Final = b"GCOL\x01\x00\x00\x00"
_HEAP: Final = struct.Struct("<8sQ")
_OBJECT: Final = struct.Struct("<HHIQ")
_SEARCHED: Final = 16 * 2**20
"""Bytes from the beginning in which heaps are looked for; they are written with the definitions, before the data."""


def check_heaps(name: str, path: Path) -> None:
    """Refuse a file with a heap whose objects do not fill it from the first to the last.

    Parameters
    ----------
    name : str
        How the error calls the file.
    path : Path
        A file that is there and not empty.

    Raises
    ------
    SceneError
        If a heap is damaged.
    """
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        end = min(len(content), _SEARCHED)
        place = content.find(_SIGNATURE, 0, end)
        while place >= 0:
            if not _is_whole(content, place):
                raise SceneError(name, path, f"is damaged (global heap at byte {place})")
            place = content.find(_SIGNATURE, place + 1, end)


def _is_whole(content: mmap.mmap, place: int) -> bool:
    """Whether the objects of a heap follow each other up to its end."""
    if place + _HEAP.size > len(content):
        return False
    end: int = place + _HEAP.unpack_from(content, place)[1]
    if end > len(content):
        return False
    at: int = place + _HEAP.size
    while at + _OBJECT.size <= end:
        index: int
        size: int
        index, _, _, size = _OBJECT.unpack_from(content, at)
        if index == 0:  # free space, whose size has the header in it
            return at + size == end
        at += _OBJECT.size + -(-size // 8) * 8
    return at <= end
