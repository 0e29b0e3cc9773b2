"""Finished runs that are a few numbers each, line by line in one file."""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Collection
from pathlib import Path
from typing import Final

from gearidae.archive.disk import part_beside

__all__ = ["RunJournal"]

_BEFORE_KEY: Final = b'{"key": "'
_BEFORE_SUM: Final = b'", "checksum": "'
_BEFORE_RUN: Final = b'", "run": '
_HASH: Final = 64
"""Digits of SHA-256."""
_SUM_AT: Final = len(_BEFORE_KEY) + _HASH + len(_BEFORE_SUM)
_RUN_AT: Final = _SUM_AT + _HASH + len(_BEFORE_RUN)


class RunJournal:
    """A file in JSON Lines: each line has the key of a run, the checksum of its text, and the text.

    A line goes to the system in one piece as soon as its run is finished, so that a process that is killed loses none.
    It is not forced onto the disk; what a power failure leaves of a line is found by its checksum.

    Parameters
    ----------
    path : Path
        The file, which need not exist.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._found: dict[str, tuple[int, int]] | None = None  # place and length of the line of each key
        self._appended = False

    def __len__(self) -> int:
        """Count the runs that are there."""
        return len(self._lines())

    def keys(self) -> set[str]:
        """Keys of the runs that are there."""
        return set(self._lines())

    def append(self, key: str, text: str) -> None:
        """Add a run.

        Parameters
        ----------
        key : str
            64 hexadecimal digits.
        text : str
            JSON, without line breaks.

        Raises
        ------
        OSError
            If it cannot be written.
        """
        found = self._lines()
        line = _line(key, text.encode())
        with self.path.open("ab", buffering=0) as file:
            # a line that was cut off is to end before the first of ours
            apart = b"\n" if file.tell() and not self._appended else b""
            self._appended = file.write(apart + line) == len(apart + line)
            if not self._appended:
                raise OSError(f"{self.path} takes no more")
            found[key] = file.tell() - len(line), len(line)

    def read(self, key: str) -> str | None:
        """Return the text of a run; None if it is not there.

        Raises
        ------
        ValueError
            If its line is damaged.
        OSError
            If it cannot be read.
        """
        place = self._lines().get(key)
        if place is None:
            return None
        with self.path.open("rb") as file:
            file.seek(place[0])
            line = file.read(place[1])
        text = line[_RUN_AT:-2]
        if line != _line(key, text):
            raise ValueError("its checksum does not agree")
        return text.decode()

    def remove(self, keys: Collection[str]) -> None:
        """Delete runs; the file goes with the last of them."""
        left = [place for key, place in self._lines().items() if key not in keys]
        if not self.path.is_file():
            return
        if not left:
            self.path.unlink()
        else:
            part = part_beside(self.path)
            with self.path.open("rb") as file, part.open("wb") as shorter:
                for start, length in left:
                    file.seek(start)
                    shorter.write(file.read(length))
            part.replace(self.path)
        self._found, self._appended = None, False

    def _lines(self) -> dict[str, tuple[int, int]]:
        """Where the line of each run is."""
        if self._found is not None:
            return self._found
        self._found, damaged, start = {}, 0, 0
        if not self.path.is_file():
            return self._found
        with self.path.open("rb") as file:
            for line in file:
                if _is_whole(line):
                    key = line[len(_BEFORE_KEY) : len(_BEFORE_KEY) + _HASH]
                    self._found[key.decode("ascii", "replace")] = start, len(line)
                elif line != b"\n":
                    damaged += 1
                start += len(line)
        if damaged:
            lines = f"{damaged} damaged lines of {self.path} are ignored and their runs computed again"
            warnings.warn(lines, stacklevel=3)
        return self._found


def _line(key: str, text: bytes) -> bytes:
    checksum = hashlib.sha256(key.encode() + text).hexdigest().encode()
    return b"".join((_BEFORE_KEY, key.encode(), _BEFORE_SUM, checksum, _BEFORE_RUN, text, b"}\n"))


def _is_whole(line: bytes) -> bool:
    """Whether a line has its parts where they should be; whether its text is sound is asked when it is read."""
    return (
        line.startswith(_BEFORE_KEY)
        and line[_SUM_AT - len(_BEFORE_SUM) : _SUM_AT] == _BEFORE_SUM
        and line[_RUN_AT - len(_BEFORE_RUN) : _RUN_AT] == _BEFORE_RUN
        and line.endswith(b"}\n")
    )
