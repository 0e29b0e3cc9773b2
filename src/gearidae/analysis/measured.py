"""Signals from files: what a rig or a simulation has written, units stated."""

from __future__ import annotations

import csv
import os
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from gearidae.analysis.signal import signals, to_si
from gearidae.archive.library import loaded
from gearidae.errors import SceneError

__all__ = ["read_signal"]

Floats = NDArray[np.float64]

_HEADING = re.compile(r"\s*([^\[\](]+?)\s*[\[(]\s*(.*?)\s*[\])]\s*")
_SI = {"time": "s", "gear_speed": "rad s-1"}
_NAMES = {"t": "time", "time": "time", "speed": "gear_speed", "gear_speed": "gear_speed"}
_LARGEST = 2**30
"""Files larger than this [bytes] are refused: a record of a minute at 100 kHz has a tenth of it."""


def read_signal(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read a record of the gear's speed.

    Parameters
    ----------
    path : path-like
        A CSV file whose first line names two columns and their units, ``time [s], gear_speed [rad/s]`` (other columns
        are ignored, lines that begin with ``#`` too; separated by comma, semicolon or tab). The names may also stand in
        a comment before the numbers, as ``numpy.savetxt(..., header="time [s], gear_speed [rad/s]")`` writes them; the
        numbers below may then be separated by blanks. Or a netCDF file with the variables ``time`` and ``gear_speed``
        and their attributes ``units``.

    Returns
    -------
    Dataset
        ``gear_speed`` [rad/s] along ``time`` [s]; events and scene if the file is an archive.

    Raises
    ------
    SceneError
        If the file cannot be read, lacks a column or a unit, or holds what is no number or an uneven time.
    """
    source = Path(path)
    try:
        with source.open("rb") as file:
            head = file.read(8)
            size = file.seek(0, os.SEEK_END)
    except OSError as error:
        raise SceneError("signal", path, f"cannot be read ({error.strerror})") from error
    if size > _LARGEST:
        raise SceneError("signal", path, f"is larger than {_LARGEST >> 20} MB")
    binary = head.startswith((b"\x89HDF\r\n\x1a\n", b"CDF"))
    ds = _from_netcdf(source) if binary else _from_csv(source)
    signals(ds)  # refuses an uneven time and the like while the file can be named
    return ds


def _from_netcdf(source: Path) -> xr.Dataset:
    try:
        ds = loaded(source)
    except Exception as error:
        raise SceneError("signal", source, f"is damaged or not a netCDF file ({error})") from error
    for name in _SI:
        if name not in ds.variables:
            raise SceneError("signal", source, f"lacks the variable {name}")
        if "units" not in ds[name].attrs:
            raise SceneError("signal", source, f"does not state the units of {name} (attribute units)")
    return ds


def _from_csv(source: Path) -> xr.Dataset:
    try:
        head = _read_head(source)
        columns = _columns(source, head.headings)
        numbers = _numbers(source, head, [column for column, _ in columns.values()])
        if numbers is None:
            numbers = _numbers_by_line(source, head, columns)
    except (OSError, UnicodeDecodeError) as error:
        raise SceneError("signal", source, f"is neither text nor netCDF ({error})") from error
    values = {
        name: to_si(
            xr.DataArray(numbers[:, place], attrs={"units": unit}), _SI[name], f"{source.name}: {name}"
        )
        for place, (name, (_, unit)) in enumerate(columns.items())
    }
    return xr.Dataset(
        {"gear_speed": ("time", values["gear_speed"], {"units": _SI["gear_speed"]})},
        coords={"time": ("time", values["time"], {"units": "s"})},
    )


class _Head(NamedTuple):
    """What the beginning of a file tells.

    Attributes
    ----------
    headings : list of str
        Of the columns.
    separator : str
        Between the numbers; empty for blanks.
    line, place : int
        Number of lines before the first row of numbers, and its place in the file [bytes].
    """

    headings: list[str]
    separator: str
    line: int
    place: int


def _read_head(source: Path) -> _Head:
    """Find headings and first row of numbers; headings may stand in a comment, as `numpy.savetxt` writes them.

    Raises
    ------
    SceneError
        If there is nothing in the file.
    """
    heading, remark, separator = "", "", ","
    line = place = 0
    with source.open("rb") as file:
        for raw in file:
            text = raw.decode("utf-8-sig" if line == 0 else "utf-8").strip()
            if text.startswith("#"):
                remark = text.lstrip("# ") if not heading and _names(text.lstrip("# ")) else remark
            elif text and not heading and not (remark and _is_row(text)):
                heading, separator = text, _separator(text)
            elif text:
                heading, separator = heading or remark, _separator(text) if not heading else separator
                break
            line, place = line + 1, place + len(raw)
    if not heading:
        raise SceneError("signal", source, "is empty")
    return _Head(_headings(heading), separator, line, place)


def _separator(text: str) -> str:
    """Separator of the cells of a line; empty if they are separated by blanks."""
    best = max(",;\t", key=text.count)
    return best if best in text else ""


def _headings(text: str) -> list[str]:
    """Cells of the line of headings, which may contain blanks before their unit."""
    separator = _separator(text)
    if separator:
        return next(csv.reader([text], delimiter=separator))
    found = re.findall(r"[^\[\]()]+[\[(][^\])]*[\])]", text)
    return found if len(found) > 1 else [text]


def _names(text: str) -> bool:
    """Whether a comment names the columns that are read."""
    bare = (match[1] if (match := _HEADING.fullmatch(one)) else one for one in _headings(text))
    return set(_SI) <= {_NAMES.get(one.strip().lower().replace(" ", "_")) for one in bare}


def _is_row(text: str) -> bool:
    """Whether a line holds numbers."""
    try:
        return all(float(cell) is not None for cell in text.split(_separator(text) or None))
    except ValueError:
        return False


def _numbers(source: Path, head: _Head, wanted: list[int]) -> Floats | None:
    """Read all rows at once; None if a row is not as it should be, which `_numbers_by_line` then looks for."""
    with source.open("rb") as file:
        file.seek(head.place)
        try:
            table = pd.read_csv(
                file,
                sep=head.separator or r"\s+",
                header=None,
                usecols=wanted,
                dtype=np.float64,
                na_filter=False,
                engine="c",
            )
        except ValueError:  # pandas' own errors are of this kind
            return None
    numbers = np.column_stack([table[column].to_numpy() for column in wanted])
    return numbers if np.isfinite(numbers).all() else None


def _numbers_by_line(source: Path, head: _Head, columns: dict[str, tuple[int, str]]) -> Floats:
    """Read row by row, and name the first that is wrong.

    Raises
    ------
    SceneError
        If one is.
    """
    rows: list[list[float]] = []
    with source.open(encoding="utf-8-sig") as file:
        for number, line in enumerate(file, 1):
            if number <= head.line or not line.strip() or line.lstrip().startswith("#"):
                continue
            cells = line.split(head.separator or None)
            row = []
            for name, (column, _) in columns.items():
                found = cells[column].strip() if column < len(cells) else "nothing"
                try:
                    row.append(float(cells[column]))
                except (ValueError, IndexError):
                    raise SceneError(
                        "signal", source, f"line {number}: {name} is {found[:40]!r}, not a number"
                    ) from None
            if not np.isfinite(row).all():
                raise SceneError("signal", source, f"line {number}: every number must be finite")
            rows.append(row)
    return np.array(rows).reshape(-1, len(columns))


def _columns(source: Path, headings: list[str]) -> dict[str, tuple[int, str]]:
    """Place and unit of the time and the speed among the headings."""
    example = "the first line must name the columns and their units, such as: time [s], gear_speed [rad/s]"
    found: dict[str, tuple[int, str]] = {}
    for column, heading in enumerate(headings):
        match = _HEADING.fullmatch(heading)
        bare = match[1] if match else heading.strip()
        name = _NAMES.get(bare.strip().lower().replace(" ", "_"))
        if name is None:
            continue
        if match is None or not match[2]:
            raise SceneError("signal", source, f"{bare!r} states no unit; {example}")
        if name in found:
            raise SceneError("signal", source, f"has two columns for {name}")
        found[name] = (column, match[2])
    missing = [name for name in _SI if name not in found]
    if missing:
        raise SceneError("signal", source, f"has no column {' nor '.join(missing)}; {example}")
    return {name: found[name] for name in _SI}
