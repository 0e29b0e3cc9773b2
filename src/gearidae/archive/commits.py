"""What a growing archive says of itself in its last bytes: how much of it is committed, and checksums of that.

A damaged structure can end the process in which netCDF's library reads it. So the structure is checked first, from the
bytes of the file; values are checked when they are there. Two records take turns: a kill can spoil the newer one only.
"""

from __future__ import annotations

import json
import mmap
import subprocess
import sys
import zlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gearidae.records import ROWS

RECORDS: Final = "commit_records"
"""The last variable of a growing archive: two records, each a checksum and JSON, filled up with blanks."""
LENGTH: Final = 4096
"""Bytes of a record."""
COPIED: Final = 2**20
"""Rows read at a time."""
COUNTS: Final[Mapping[str, str]] = {
    "time": "committed_samples",
    **{kind.dim: f"committed_{kind.field}" for kind in ROWS},
}
"""Dimensions that grow, each with the variable that says to readers of other programs how much is committed."""
_READ_ALL: Final = "import sys, netCDF4; [v[...] for v in netCDF4.Dataset(sys.argv[1]).variables.values()]"


@dataclass(frozen=True, slots=True)
class Commit:
    """A state of a growing archive.

    Attributes
    ----------
    lengths : mapping of str to int
        How much is committed along each dimension that grows.
    checksums : mapping of str to int
        CRC-32 of the committed values of each variable that grows.
    number : int
        Which commit it is, counted from 0.
    structure : tuple of int
        Bytes before the data of the first variable, and their CRC-32.
    constants : int
        CRC-32 of the values of all other variables.
    """

    lengths: Mapping[str, int] = field(default_factory=dict)
    checksums: Mapping[str, int] = field(default_factory=dict)
    number: int = 0
    structure: tuple[int, int] = (0, 0)
    constants: int = 0

    @classmethod
    def first(cls, file: Any, path: Path) -> Commit:
        """Describe an archive that has been laid out, and written to the disk."""
        data = sum(
            -(-variable.size * variable.dtype.itemsize // 4) * 4 for variable in file.variables.values()
        )
        with path.open("rb") as bytes_of:
            begin = path.stat().st_size - data
            structure = (begin, zlib.crc32(bytes_of.read(begin)))
        return cls(structure=structure, constants=constants_of(file))

    def write(self, file: Any) -> None:
        """Write the record in the place of the one before the last."""
        text = json.dumps(asdict(self)).encode()
        text = f"{zlib.crc32(text):08x}".encode() + text
        if len(text) > LENGTH:
            raise OSError("it has too many variables for its records")
        place = LENGTH * (self.number % 2)
        file[RECORDS][place : place + LENGTH] = np.frombuffer(text.ljust(LENGTH), np.uint8)

    def checksum(self, name: str, values: NDArray[Any]) -> int:
        """Checksum of a variable after more values."""
        return _checksum(values, self.checksums.get(name, 0))

    def holds(self, file: Any) -> bool:
        """Whether the committed values are in an open file, as they were written."""
        return all(
            checksum_of(file[name], self.lengths[file[name].dimensions[0]]) == was
            for name, was in self.checksums.items()
        )


def check_bytes(path: Path) -> list[Commit]:
    """Make sure that netCDF's library survives a file, and return the records of a growing archive, the newest first.

    Parameters
    ----------
    path : Path

    Returns
    -------
    list of Commit
        Empty of another file. One in the classic format, such as an unfinished run of version 0.2.0, has been read in a
        process of its own.

    Raises
    ------
    ValueError
        If the file is cut or altered.
    """
    with path.open("rb") as file:
        if not file.read(4).startswith(b"CDF"):
            return []
        file.seek(-min(2 * LENGTH, path.stat().st_size), 2)
        tail = file.read()
        commits = [commit for text in (tail[:LENGTH], tail[LENGTH:]) if (commit := _read(text)) is not None]
        if commits:
            file.seek(0)
            length, was = commits[0].structure
            if zlib.crc32(file.read(length)) != was:
                raise ValueError("its structure has been altered")
            return sorted(commits, key=lambda commit: -commit.number)
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
            if content.find(RECORDS.encode()) >= 0:
                raise ValueError("its end is missing or altered")
    if subprocess.run([sys.executable, "-c", _READ_ALL, path], capture_output=True, check=False).returncode:
        raise ValueError("netCDF's library cannot read it")
    return []


def checksum_of(variable: Any, length: int, before: int = 0) -> int:
    """Checksum of the first values of a variable in an open file, after those of another checksum."""
    checksum = before
    for start in range(0, length, COPIED):
        checksum = _checksum(variable[start : min(start + COPIED, length)], checksum)
    return checksum


def _checksum(values: NDArray[Any], before: int) -> int:
    values = np.ascontiguousarray(values)
    return zlib.crc32(values.astype(values.dtype.newbyteorder("<"), copy=False).tobytes(), before)


def constants_of(file: Any) -> int:
    """Checksum of all values that are there from the first."""
    checksum = 0
    for name, variable in file.variables.items():
        if not {*COUNTS} & set(variable.dimensions) and name not in (RECORDS, *COUNTS.values()):
            checksum = _checksum(variable[...], checksum)
    return checksum_of(file["time"], file["time"].size, checksum) if "time" in file.variables else checksum


def with_lengths(fields: dict[str, Any]) -> dict[str, Any]:
    """Fields of a commit or a checkpoint, of which older versions counted samples and events by themselves."""
    if "lengths" in fields:
        return fields
    lengths = {"time": fields.pop("samples"), "event": fields.pop("events")}
    return {**fields, "lengths": lengths}


def _read(text: bytes) -> Commit | None:
    try:
        if int(text[:8], 16) != zlib.crc32(text[8:].rstrip()):
            return None
        fields = with_lengths(json.loads(text[8:]))
        return Commit(**{**fields, "structure": tuple(fields["structure"])})
    except (ValueError, TypeError, KeyError):
        return None
