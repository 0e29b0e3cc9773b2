"""What a finished file must be to be read as it was written: its bytes, and what it says in words and single numbers.

A damaged file can make HDF5 run for ever, or end the program: its global heaps and its lists of chunks have no
checksum (11 zeros in a heap, a size of 0 there, are a loop without end). So the bytes are checked before the library
sees them, by a seal behind the end of what is HDF5's: other programs do not see it, and one that writes into the file
cuts it off. What has been written anew elsewhere has no seal; an attribute then tells what has been changed.
"""

from __future__ import annotations

import json
import zlib
from pathlib import Path
from typing import Any, Final

import numpy as np
import xarray as xr

from gearidae.records import ROWS

CHECKSUMS: Final = "content_checksums"
"""Attribute of a file: CRC-32 of each attribute, and of each variable with its attributes."""
_FREE: Final = (CHECKSUMS, "history")
"""Attributes that other programs may change: CF asks them to add to the history."""
_IN_CHUNKS: Final = {"time", *(kind.dim for kind in ROWS)}
"""Dimensions of what is stored in chunks with a checksum of their own."""
_MARK: Final = b"\x93gearidae seal\r\n"
_SEAL: Final = len(_MARK) + 8 + 4
"""Bytes of a seal: the mark, the length of the file before it, and CRC-32 of all of that."""
_PIECE: Final = 2**20
"""Bytes read at a time."""


def seal(path: Path) -> None:
    """Put the seal behind a file that has been written and closed.

    Raises
    ------
    OSError
        If the disk does not take it.
    """
    checksum = _checksum_of(path, length := path.stat().st_size)
    with path.open("ab") as file:
        file.write(_MARK + length.to_bytes(8, "little") + checksum.to_bytes(4, "little"))


def check_seal(path: Path) -> None:
    """Compare a file that has a seal with it: 0.3 s for 1 GB.

    Raises
    ------
    ValueError
        If the file is cut or altered.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        file.seek(max(size - 2 * _SEAL, 0))
        tail = file.read()
    if (offset := tail.rfind(_MARK)) < 0:
        return
    length, numbers = size - len(tail) + offset, tail[offset + len(_MARK) :]
    if len(numbers) != _SEAL - len(_MARK) or int.from_bytes(numbers[:8], "little") != length:
        raise ValueError("its end is missing or altered")
    if _checksum_of(path, length) != int.from_bytes(numbers[8:], "little"):
        raise ValueError("its bytes have been altered since it was written")


def _checksum_of(path: Path, length: int) -> int:
    """Checksum of the beginning of a file."""
    checksum = 0
    with path.open("rb") as file:
        for start in range(0, length, _PIECE):
            checksum = zlib.crc32(file.read(min(_PIECE, length - start)), checksum)
    return checksum


def with_checksums(ds: xr.Dataset) -> xr.Dataset:
    """Add the checksums to a dataset that is about to be written.

    Samples and rows are left to the checksums of their chunks; they may still be missing.
    """
    attributes = {name: value for name, value in ds.attrs.items() if name not in _FREE}
    sums = {
        "attributes": {str(name): _checksum(value) for name, value in attributes.items()},
        "variables": {str(name): _of_variable(variable) for name, variable in ds.variables.items()},
    }
    return ds.assign_attrs({CHECKSUMS: json.dumps(sums)})


def check_content(ds: xr.Dataset) -> None:
    """Compare a dataset, as read from a file, with the checksums that it carries, and take them out of it.

    What has been added or left out since, or has another shape, as a part that was picked out has, is none of theirs.

    Raises
    ------
    ValueError
        With the name of what has been changed.
    """
    text = ds.attrs.pop(CHECKSUMS, None)
    if text is None:
        return
    try:
        sums = json.loads(text)
        attributes, variables = dict(sums["attributes"]), dict(sums["variables"])
        variables = {
            name: (int(about), list(shape), int(values)) for name, (about, shape, values) in variables.items()
        }
    except (TypeError, ValueError, KeyError) as error:
        raise ValueError(f"its attribute {CHECKSUMS} is not readable") from error
    for name, was in attributes.items():
        if name in ds.attrs and _checksum(ds.attrs[name]) != was:
            raise ValueError(f"its attribute {name} has been changed since it was written")
    for name, (about, shape, values) in variables.items():
        if name not in ds.variables:
            continue
        about_now, shape_now, values_now = _of_variable(ds.variables[name])
        if about != about_now or (shape == shape_now and values != values_now):
            raise ValueError(f"its variable {name} has been changed since it was written")


def _of_variable(variable: xr.Variable) -> tuple[int, list[int], int]:
    """Checksum of a variable's attributes, its shape, and a checksum of its values.

    Values in chunks with a checksum of their own, and of types that gearidae does not write, have neither.
    """
    about = _checksum(*sorted(variable.attrs.items()))
    if _IN_CHUNKS & {*variable.dims} or variable.dtype.kind not in "fiubOU":
        return about, [], 0
    return about, [*variable.shape], _checksum(variable.values)


def _checksum(*values: Any) -> int:
    """Checksum of texts and numbers, the same for the types that they come back as from a file."""
    checksum = 0
    for value in values:
        if isinstance(value, tuple):
            checksum = zlib.crc32(f"{_checksum(*value)}".encode(), checksum)
            continue
        array = np.ravel(value)
        if array.dtype.kind == "f":
            array = np.where(np.isnan(array), np.nan, array)  # which has more than one form
        if array.dtype.kind in "fiub":
            content = array.astype("<f8" if array.dtype.kind == "f" else "<i8").tobytes()
        else:
            # in JSON the ends of texts are told apart
            content = json.dumps([str(entry) for entry in array.tolist()]).encode()
        checksum = zlib.crc32(content, checksum)
    return checksum
