"""Journals: what unfinished work has done so far, frame after frame in one file beside its archive.

A frame is a header in JSON and arrays of 8-byte numbers, after their lengths and checksums (CRC-32). Frames are only
appended: whoever reads while another writes, after a kill or on a full disk, finds whole frames and at most the
beginning of one more. Numbers come back to the last bit, and nothing in a file is ever executed.
"""

from __future__ import annotations

import json
import math
import os
import struct
import threading
import zlib
from array import array
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from gearidae.archive.disk import sync

SIGNATURE: Final = b"gearidae journal 1\n"
"""How the file begins; the number is that of the layout."""
_LEAD: Final = struct.Struct("<4sIQI")
"""Before each frame: mark, bytes of the header, bytes of the arrays, CRC-32 of both; then CRC-32 of all that."""
_MARK: Final = b"\x93frm"
_SUM: Final = struct.Struct("<I")
_TYPES: Final = {"f": "<f8", "u": "<u8"}
_PIECE: Final = 2**20
"""Bytes read at a time."""


def journal_of(archive: Path) -> Path:
    """Where the journal of an archive is: ``OUT.nc.journal`` beside ``OUT.nc``."""
    return archive.with_name(f"{archive.name}.journal")


def file_of(archive: Path) -> Path:
    """Where what there is of an archive is: in its own file, or in its journal until it is finished."""
    journal = journal_of(archive)
    return journal if journal.exists() and not archive.exists() else archive


@dataclass(frozen=True, slots=True)
class Frame:
    """A whole frame of a journal.

    Attributes
    ----------
    header : dict
    shapes : mapping of str to tuple of int
        Of the arrays.
    begin, end : int
        Places in the file where it begins and behind it.
    """

    header: dict[str, Any]
    shapes: Mapping[str, tuple[int, ...]]
    begin: int
    end: int
    _places: Mapping[str, tuple[int, str]]


class Journal:
    """A journal, open for reading, or for reading and appending by the one who has claimed its archive.

    Parameters
    ----------
    path : Path
    mode : {"r", "a", "w"}, optional
        To read, to append to it, or to make it in the place of whatever is there.

    Attributes
    ----------
    end : int
        Place behind the last frame that `frames` or `append` has met, where the next one goes.

    Raises
    ------
    OSError
        If the disk does not give or take it.
    ValueError
        If the file is no journal.
    """

    def __init__(self, path: Path, mode: Literal["r", "a", "w"] = "r") -> None:
        self.path = path
        self._using = threading.Lock()
        self._file = path.open({"r": "rb", "a": "r+b", "w": "w+b"}[mode], buffering=0)
        self.end = len(SIGNATURE)
        try:
            if mode == "w":
                self._write(0, SIGNATURE)
            elif self._read(0, self.end) != SIGNATURE:
                raise ValueError("it is no journal of this version of gearidae")
        except BaseException:
            self.close()
            raise

    def frames(self) -> Iterator[Frame | None]:
        """Go through the frames from the first on, with all checksums: 0.3 s for 1 GB.

        Yields
        ------
        Frame or None
            None in the place of a frame whose content is altered. The last one is that before one that is cut off, or
            whose lengths are altered.
        """
        self.end, size = len(SIGNATURE), self._file.seek(0, os.SEEK_END)
        while (lead := self._lead(self.end, size)) is not None:
            begin, self.end = self.end, self.end + _LEAD.size + _SUM.size + lead[0] + lead[1]
            yield self._frame(begin, *lead)

    def frame(self, begin: int) -> Frame:
        """Read the frame that begins at a place, with its checksums.

        Raises
        ------
        ValueError
            If it is not there any more, or altered.
        """
        lead = self._lead(begin, self._file.seek(0, os.SEEK_END))
        if lead is None or (frame := self._frame(begin, *lead)) is None:
            raise ValueError("it has been altered")
        return frame

    def values(self, frame: Frame, name: str, first: int = 0, last: int | None = None) -> NDArray[Any]:
        """Read an array, or its numbers from `first` to before `last`, in the order in which they are stored.

        Returns
        -------
        ndarray, shape (n,)

        Raises
        ------
        OSError
            If the file has been cut since it was opened.
        """
        place, dtype = frame._places[name]
        last = math.prod(frame.shapes[name]) if last is None else last
        content = self._read(place + 8 * first, 8 * (last - first))
        if len(content) < 8 * (last - first):
            raise OSError(f"{self.path.name} has been cut while it was read: open it again")
        return np.frombuffer(content, dtype)

    def table(self, frame: Frame, name: str) -> NDArray[Any]:
        """Read an array in its shape."""
        return self.values(frame, name).reshape(frame.shapes[name])

    def append(self, header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> Frame:
        """Write a frame at the end, whole or not at all.

        Parameters
        ----------
        header : mapping
            Ready for JSON; arrays become lists, and numpy's integers plain ones.
        arrays : mapping of str to ndarray
            Of 8-byte floating-point numbers or words.

        Raises
        ------
        OSError
            If the disk does not take it; the journal is then as before.
        """
        parts = {
            name: np.ascontiguousarray(values, _TYPES[values.dtype.kind]) for name, values in arrays.items()
        }
        layout = [[name, part.dtype.str, part.shape] for name, part in parts.items()]
        text = json.dumps({**header, "arrays": layout}, default=_plain).encode()
        contents: list[Any] = [text, *(part.reshape(-1).view(np.uint8) for part in parts.values())]
        checksum = 0
        for content in contents:
            checksum = zlib.crc32(content, checksum)
        size = sum(part.nbytes for part in parts.values())
        lead = _LEAD.pack(_MARK, len(text), size, checksum)
        begin = self.end
        try:
            end = self._write(begin, lead + _SUM.pack(zlib.crc32(lead)), *contents)
        except BaseException:
            with suppress(OSError):
                self.cut(begin)  # which frees what a full disk lacks
            raise
        self.end = end
        return _described(text, begin, end, size)

    def cut(self, end: int) -> None:
        """Take back all that is behind a place, the end of a frame."""
        with self._using:
            self._file.truncate(end)
        self.end = end

    def sync(self) -> None:
        """Wait until all frames are on the disk."""
        sync(self.path)

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _lead(self, place: int, size: int) -> tuple[int, int, int] | None:
        """Lengths and checksum of the frame at a place; None if there is no whole one."""
        lead = self._read(place, _LEAD.size + _SUM.size)
        if (
            len(lead) < _LEAD.size + _SUM.size
            or zlib.crc32(lead[: _LEAD.size]) != _SUM.unpack(lead[_LEAD.size :])[0]
        ):
            return None
        mark, text_size, array_size, checksum = _LEAD.unpack(lead[: _LEAD.size])
        if mark != _MARK or place + len(lead) + text_size + array_size > size:
            return None
        return text_size, array_size, checksum

    def _frame(self, begin: int, text_size: int, array_size: int, checksum: int) -> Frame | None:
        """Read a frame of which the lengths are known; None if its content is altered."""
        place = begin + _LEAD.size + _SUM.size
        text = self._read(place, text_size)
        place += text_size
        found = zlib.crc32(text)
        for start in range(place, place + array_size, _PIECE):
            found = zlib.crc32(self._read(start, min(_PIECE, place + array_size - start)), found)
        return _described(text, begin, place + array_size, array_size) if found == checksum else None

    def _read(self, place: int, size: int) -> bytes:
        with self._using:  # threads share the file's position
            self._file.seek(place)
            content: bytes = self._file.read(size)
            return content

    def _write(self, place: int, *contents: Any) -> int:
        """Write at a place and return the one behind."""
        with self._using:
            self._file.seek(place)
            for content in contents:
                left = memoryview(content)
                while left:  # as much as there is room for is written without an error
                    left = left[self._file.write(left) :]
            return self._file.tell()


def _described(text: bytes, begin: int, end: int, size: int) -> Frame:
    """Make a frame of its header, and refuse arrays that do not fit into it: the file says where they are."""
    try:
        header = json.loads(text)
    except RecursionError:
        raise ValueError("the header of one of its frames is nested too deep") from None
    shapes: dict[str, tuple[int, ...]] = {}
    places: dict[str, tuple[int, str]] = {}
    place = end - size
    for name, dtype, shape in header.pop("arrays"):
        if dtype not in _TYPES.values() or not all(type(length) is int and length >= 0 for length in shape):
            raise ValueError(f"its array {name} is of another kind")
        shapes[name], places[name] = tuple(shape), (place, dtype)
        place += 8 * math.prod(shape)
    if place != end:
        raise ValueError("its arrays are not as long as they say")
    return Frame(header, shapes, begin, end, places)


def _plain(value: Any) -> Any:
    """What JSON has not: arrays, and numpy's integers."""
    return value.tolist() if isinstance(value, array) else int(value)
