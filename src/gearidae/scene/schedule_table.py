"""Tables that stand for a schedule: columns of a CSV file, of arrays or of a DataFrame, with their units.

``{file = "drive.csv", time = "t [ms]", value = "M [pN m]", interpolation = "cubic"}`` in a case file; in Python also
``data`` (a DataFrame) in place of ``file``, arrays or pint quantities as ``time`` and ``value``, ``knots`` (pairs), or
a DataFrame of two columns as it is. ``repeat`` is the time after which the knots come again, ``after = "run"`` lets
their times count from the start of each run of a chain. The unit of a column stands in brackets in its name; without,
it is SI.

``packed`` holds many knots as text: the bits of the numbers, as differences, sorted by significance, compressed.
Nothing is lost; 10,000 knots at even times take some tens of kilobytes in place of half a megabyte.
"""

from __future__ import annotations

import base64
import binascii
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.scene.carried import numbers_of
from gearidae.scene.table_head import open_table
from gearidae.scene.tables import MOST_KNOTS
from gearidae.scene.text_table import column_of, listed, split_unit

_KEYS: Final = ("file", "data", "knots", "packed", "time", "value", "interpolation", "repeat", "after")
_CHOICES: Final = {"interpolation": ("linear", "cubic"), "after": ("chain", "run")}
_SOURCES: Final = ("file", "data", "knots", "packed")
_LARGEST: Final = 50_000_000  # bytes of a file


def read_schedule(value: object, unit: str) -> tuple[object, dict[str, Any]]:
    """Turn whatever stands for a schedule into pairs, and what else it says of them.

    Parameters
    ----------
    value : object
        A list or an array of pairs, a DataFrame of two columns, or a table as the module describes.
    unit : str
        SI unit of the values.

    Returns
    -------
    pairs : object
        [time, value] pairs, what they hold is still to be checked.
    settings : dict
        ``interpolation``, ``repeat`` and ``after`` as far as they are given; ``repeat`` is still to be checked.

    Raises
    ------
    ValueError
        If a table is none; the message names column and row.
    """
    if hasattr(value, "columns") and hasattr(value, "iloc"):
        value = {"data": value}
    if not isinstance(value, Mapping):
        settings = getattr(value, "settings", dict)
        return value, settings()
    if not value:
        return value, {}
    for key in value:
        if key not in _KEYS:
            raise ValueError(f"unknown key {str(key)[:40]!r}; a schedule's table has {', '.join(_KEYS)}")
    for key, words in _CHOICES.items():
        if value.get(key, words[0]) not in words:
            raise ValueError(f"{key} {str(value[key])[:40]!r} must be {' or '.join(map(repr, words))}")
    settings = {key: value[key] for key in (*_CHOICES, "repeat") if key in value}
    sources = [key for key in _SOURCES if key in value]
    if len(sources) > 1:
        raise ValueError(f"has {' and '.join(sources)}; one of them is enough")
    if "packed" in value:
        return unpack_knots(value["packed"]), settings
    if "knots" in value:
        return value["knots"], settings
    times, values = _columns(value, sources[0] if sources else "", ("s", unit))
    if len(times) != len(values):
        raise ValueError(f"time has {len(times)} rows and value {len(values)}: they must be as many")
    return np.column_stack([times, values]).tolist(), settings


def in_folder(table: object, folder: Path) -> object:
    """Let a file that a schedule's table names lie beside the case file that names it."""
    if isinstance(table, Mapping) and isinstance(table.get("file"), str):
        return {**table, "file": str(folder / table["file"])}
    return table


def pack_knots(knots: Sequence[Sequence[float]]) -> str:
    """Write knots as text, exactly."""
    bits = np.array(knots, "<f8").T.copy().view("<u8")
    differences = np.diff(bits, axis=1, prepend=np.zeros((2, 1), "<u8")).ravel()
    return base64.b64encode(zlib.compress(differences.view("u1").reshape(-1, 8).T.tobytes(), 9)).decode()


def unpack_knots(text: object) -> list[list[float]]:
    """Read what `pack_knots` has written.

    Raises
    ------
    ValueError
        If it is nothing of the kind, or more than a schedule may have.
    """
    try:
        if not isinstance(text, str):
            raise TypeError
        room = 16 * MOST_KNOTS
        content = zlib.decompressobj().decompress(base64.b64decode(text, validate=True), room + 1)
    except (TypeError, ValueError, binascii.Error, zlib.error):
        raise ValueError("packed knots are damaged") from None
    if not content or len(content) % 16 or len(content) > room:
        raise ValueError("packed knots are damaged")
    differences = np.frombuffer(content, "u1").reshape(8, -1).T.copy().view("<u8").reshape(2, -1)
    knots: list[list[float]] = np.cumsum(differences, axis=1, dtype="<u8").view("<f8").T.tolist()
    return knots


def _columns(table: Mapping[str, Any], source: str, units: tuple[str, str]) -> list[Floats]:
    """Read the columns of time and value in SI units."""
    if source == "file":
        return _of_file(table, units)
    if source == "data":
        frame = table["data"]
        if not (hasattr(frame, "columns") and hasattr(frame, "iloc")):
            raise ValueError("data must be a DataFrame")
        names = [str(name).strip() for name in frame.columns]
        columns = [(name, frame.iloc[:, index]) for name, index in _wanted(table, names)]
    elif "time" in table and "value" in table:
        columns = [(key, table[key]) for key in ("time", "value")]
    else:
        raise ValueError("needs file, data or knots, or arrays as time and value")
    return [_numbers(*column, unit) for column, unit in zip(columns, units, strict=True)]


def _of_file(table: Mapping[str, Any], units: tuple[str, str]) -> list[Floats]:
    if not isinstance(table["file"], str | Path):
        raise ValueError("file must be the name of a CSV file")
    path = Path(table["file"])
    asked = [table[key] for key in ("time", "value") if isinstance(table.get(key), str)]

    def names(headings: Sequence[str]) -> bool:
        return all(column_of(headings, name) is not None for name in asked)

    try:
        opened = open_table(path, largest=_LARGEST, names=names, unit_row=True)
        wanted = _wanted(table, opened.headings)
        columns = opened.numbers([index for _, index in wanted], most=MOST_KNOTS).T
        return [
            _numbers(name, cells, unit) for (name, _), cells, unit in zip(wanted, columns, units, strict=True)
        ]
    except ValueError as error:
        raise ValueError(f"the file {path.name}: {error}") from None


def _wanted(table: Mapping[str, Any], names: Sequence[str]) -> list[tuple[str, int]]:
    """Find the columns of time and value: their names, with units, and their indices."""
    if "time" not in table and "value" not in table and len(names) == 2:
        return [(names[0], 0), (names[1], 1)]
    columns = []
    for key in ("time", "value"):
        if not isinstance(table.get(key), str):
            raise ValueError(f"{key} must be the name of a column, one of {listed(names)}")
        name = table[key].strip()
        index = column_of(names, name)
        if index is None:
            problem = "stands more than once among" if list(names).count(name) > 1 else "is not among"
            raise ValueError(f"column {name[:60]!r} {problem} the columns, {listed(names)}")
        columns.append((name if split_unit(name)[1] else names[index], index))
    return columns


def _numbers(name: str, column: Any, unit: str) -> Floats:
    """Read a column in SI units; whatever is no finite number is named with its row, counted from 1."""
    where = f"column {name[:60]!r}"
    try:
        numbers = numbers_of(column, unit, split_unit(name)[1])
    except ValueError as error:
        raise ValueError(f"{where}{', ' if str(error).startswith('row') else ': '}{error}") from None
    if numbers.ndim != 1:
        raise ValueError(f"{where} must be one-dimensional")
    if numbers.size > MOST_KNOTS:
        raise ValueError(f"has {numbers.size} rows or more; there may be {MOST_KNOTS} knots at most")
    if not np.isfinite(numbers).all():
        row = int(np.isfinite(numbers).argmin())
        raise ValueError(f"{where}, row {row + 1} is {numbers[row]}, not a finite number")
    return numbers
