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

from gearidae.archive.disk import part_beside, sync
from gearidae.archive.signals import signals_put_off

SIGNATURE: Final = b"gearidae journal 1\n"
"""How the file begins; the number is that of the layout."""
_PREAMBLE: Final = struct.Struct("<4sIQII")
"""Before each frame: mark, bytes of the header, bytes of the arrays, CRC-32 of both, and of what precedes it."""
_MARK: Final = b"\x93frm"
_TYPES: Final = {"f": "<f8", "u": "<u8"}
RUN, TRAIN, RUNS = "run", "train", "runs"
_OF: Final = {RUN: "a single run", TRAIN: "a single run of a train", RUNS: "a sweep or study"}
"""What a journal may be of."""
_CHUNK: Final = 2**20
"""Bytes read at a time."""


def journal_of(archive: Path) -> Path:
    """Where the journal of an archive is: ``OUT.nc.journal`` beside ``OUT.nc``."""
    return archive.with_name(f"{archive.name}.journal")


def kind_of(path: Path) -> str:
    """Say what a journal is of, `RUN` where it does not say it; who opens it looks at the rest.

    Raises
    ------
    OSError
        If the file cannot be read.
    """
    for kind in (TRAIN, RUNS):
        try:
            Journal(path, kind).close()
        except ValueError:
            continue
        return kind
    return RUN


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
        Offsets in the file at which it begins and behind it.
    """

    header: dict[str, Any]
    shapes: Mapping[str, tuple[int, ...]]
    begin: int
    end: int
    _offsets: Mapping[str, tuple[int, str]]


class Journal:
    """A journal, open for reading, or for reading and appending by the one who has claimed its archive.

    Parameters
    ----------
    path : Path
    kind : str
        What it is of: `RUN`, `TRAIN` or `RUNS`.
    mode : {"r", "a"}, optional
        To read, or to append too.

    Attributes
    ----------
    head : Frame
        Its first frame.
    end : int
        Offset behind the last frame that `frames` or `append` has met, where the next one goes.

    Raises
    ------
    OSError
        If the disk does not give or take it.
    ValueError
        If the file is no journal of this kind, or altered at its head.
    """

    def __init__(self, path: Path, kind: str, mode: Literal["r", "a"] = "r") -> None:
        self.path = path
        self._using = threading.Lock()
        self._file = path.open({"r": "rb", "a": "r+b"}[mode], buffering=0)
        try:
            if self._read(0, len(SIGNATURE)) != SIGNATURE:
                raise ValueError("it is no journal of this version of gearidae")
            self.head = self.frame(len(SIGNATURE))
            if (found := str(self.head.header.get("kind"))) != kind:
                raise ValueError(f"it is of {_OF.get(found, 'something else')}")
        except BaseException:
            self.close()
            raise
        self.end = self.head.end

    @classmethod
    def create(cls, path: Path, kind: str, **head: Any) -> Journal:
        """Make a journal in the place of whatever is there; it appears with its head or not at all."""
        # what a kill leaves of it goes with the next that is written under the archive's name
        part = part_beside(path.with_suffix(""))
        with signals_put_off():  # a Ctrl-C between opening and closing would leave the file open
            try:
                part.write_bytes(SIGNATURE + b"".join(_packed({"kind": kind, **head}, {})))
                part.replace(path)
            finally:
                with suppress(OSError):
                    part.unlink(missing_ok=True)
        return cls(path, kind, "a")

    def frames(self) -> Iterator[Frame | None]:
        """Go through the frames behind the head, with all checksums: 0.3 s for 1 GB.

        Yields
        ------
        Frame or None
            None in the place of a frame whose content is altered. The last one is that before one that is cut off, or
            whose lengths are altered.
        """
        self.end, size = self.head.end, self._file.seek(0, os.SEEK_END)
        while (preamble := self._preamble(self.end, size)) is not None:
            begin, self.end = self.end, self.end + _PREAMBLE.size + preamble[0] + preamble[1]
            yield self._frame(begin, *preamble)

    def frame(self, begin: int) -> Frame:
        """Read the frame that begins at an offset, with its checksums.

        Raises
        ------
        ValueError
            If it is not there any more, or altered.
        """
        preamble = self._preamble(begin, self._file.seek(0, os.SEEK_END))
        if preamble is None or (frame := self._frame(begin, *preamble)) is None:
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
        offset, dtype = frame._offsets[name]
        last = math.prod(frame.shapes[name]) if last is None else last
        content = self._read(offset + 8 * first, 8 * (last - first))
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
        begin, contents = self.end, _packed(header, arrays)
        try:
            with self._using:
                self._file.seek(begin)
                for content in contents:
                    left = memoryview(content)
                    while left:  # as much as there is room for is written without an error
                        left = left[self._file.write(left) :]
        except BaseException:
            with suppress(OSError):
                self.cut(begin)  # which frees what a full disk lacks
            raise
        self.end = begin + sum(map(len, contents))
        return _described(contents[1], begin, self.end)

    def cut(self, end: int) -> None:
        """Take back all that is behind an offset, the end of a frame."""
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

    def _preamble(self, offset: int, size: int) -> tuple[int, int, int] | None:
        """Lengths and checksum of the frame at an offset; None if there is no whole one."""
        preamble = self._read(offset, _PREAMBLE.size)
        if len(preamble) < _PREAMBLE.size:
            return None
        mark, text_size, array_size, checksum, own = _PREAMBLE.unpack(preamble)
        is_whole = offset + _PREAMBLE.size + text_size + array_size <= size
        if mark != _MARK or own != zlib.crc32(preamble[:-4]) or not is_whole:
            return None
        return text_size, array_size, checksum

    def _frame(self, begin: int, text_size: int, array_size: int, checksum: int) -> Frame | None:
        """Read a frame of which the lengths are known; None if its content is altered."""
        offset = begin + _PREAMBLE.size
        text = self._read(offset, text_size)
        found, end = zlib.crc32(text), offset + text_size + array_size
        for start in range(offset + text_size, end, _CHUNK):
            found = zlib.crc32(self._read(start, min(_CHUNK, end - start)), found)
        return _described(text, begin, end) if found == checksum else None

    def _read(self, offset: int, size: int) -> bytes:
        with self._using:  # threads share the file's position
            self._file.seek(offset)
            content: bytes = self._file.read(size)
            return content


def _packed(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> list[Any]:
    """Bytes of a frame: preamble, header, and each array."""
    parts = {name: np.ascontiguousarray(values, _TYPES[values.dtype.kind]) for name, values in arrays.items()}
    layout = [[name, part.dtype.str, part.shape] for name, part in parts.items()]
    text = json.dumps({**header, "arrays": layout}, default=_plain).encode()
    contents: list[Any] = [text, *(part.reshape(-1).view(np.uint8) for part in parts.values())]
    checksum = 0
    for content in contents:
        checksum = zlib.crc32(content, checksum)
    preamble = _PREAMBLE.pack(_MARK, len(text), sum(part.nbytes for part in parts.values()), checksum, 0)[:-4]
    return [preamble + zlib.crc32(preamble).to_bytes(4, "little"), *contents]


def _described(text: bytes, begin: int, end: int) -> Frame:
    """Make a frame of its header, and refuse arrays that do not fit into it: the file says where they are."""
    shapes: dict[str, tuple[int, ...]] = {}
    offsets: dict[str, tuple[int, str]] = {}
    offset = begin + _PREAMBLE.size + len(text)
    try:
        header = json.loads(text)
        for name, dtype, shape in header.pop("arrays"):
            if dtype not in _TYPES.values() or not all(
                type(length) is int and length >= 0 for length in shape
            ):
                raise ValueError(f"its array {name} is of another kind")
            shapes[name], offsets[name] = tuple(shape), (offset, dtype)
            offset += 8 * math.prod(shape)
    except (RecursionError, KeyError, TypeError, AttributeError) as error:
        raise ValueError("the header of one of its frames is not readable") from error
    if offset != end:
        raise ValueError("its arrays are not as long as they say")
    return Frame(header, shapes, begin, end, offsets)


def _plain(value: Any) -> Any:
    """What JSON has not: arrays, and numpy's integers."""
    return value.tolist() if isinstance(value, array) else int(value)
