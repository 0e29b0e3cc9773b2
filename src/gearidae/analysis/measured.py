"""Signals from files: what a rig or a simulation has written, units stated."""

from __future__ import annotations

import csv
import os
import re
from pathlib import Path

import numpy as np
import xarray as xr

from gearidae.analysis.signal import signals, to_si
from gearidae.errors import SceneError

__all__ = ["read_signal"]

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
        are ignored, lines that begin with ``#`` too; separated by comma, semicolon or tab), or a netCDF file with the
        variables ``time`` and ``gear_speed`` and their attributes ``units``.

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
        with xr.open_dataset(source, decode_times=False) as opened:
            ds = opened.load()
    except Exception as error:  # a damaged file can make the netCDF stack raise almost anything
        raise SceneError("signal", source, f"is damaged or not a netCDF file ({error})") from error
    for name in _SI:
        if name not in ds.variables:
            raise SceneError("signal", source, f"lacks the variable {name}")
        if "units" not in ds[name].attrs:
            raise SceneError("signal", source, f"does not state the units of {name} (attribute units)")
    return ds


def _from_csv(source: Path) -> xr.Dataset:
    try:
        text = source.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise SceneError("signal", source, f"is neither text nor netCDF ({error})") from error
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    lines = [(number, line) for number, line in lines if not line.lstrip().startswith("#")]
    if not lines:
        raise SceneError("signal", source, "is empty")
    separator = max(",;\t", key=lines[0][1].count)
    columns = _columns(source, next(csv.reader([lines[0][1]], delimiter=separator)))
    numbers = np.empty((len(lines) - 1, len(columns)))
    for row, (number, line) in zip(numbers, lines[1:], strict=True):
        cells = line.split(separator)
        for place, (name, (column, _)) in enumerate(columns.items()):
            try:
                row[place] = float(cells[column])
            except (ValueError, IndexError):
                found = cells[column].strip() if column < len(cells) else "nothing"
                raise SceneError(
                    "signal", source, f"line {number}: {name} is {found[:40]!r}, not a number"
                ) from None
    if not np.isfinite(numbers).all():
        number = lines[1 + int(np.argmin(np.isfinite(numbers).all(axis=1)))][0]
        raise SceneError("signal", source, f"line {number}: every number must be finite")
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
