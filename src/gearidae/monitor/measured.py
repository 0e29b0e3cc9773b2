"""Signals from files: what a rig or a simulation has written, units stated."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np
import xarray as xr

from gearidae.analysis.signal import signals, to_si
from gearidae.archive.netcdf_access import loaded
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.monitor.record_columns import Column, Wanted, find_columns, has_columns, numbered_positions
from gearidae.monitor.record_formats import frame_from, unpacked
from gearidae.scene.carried import numbers_of
from gearidae.scene.group import shorten
from gearidae.scene.prefixes import with_prefix
from gearidae.scene.quantity import Quantity, whole
from gearidae.scene.table_head import open_table
from gearidae.scene.text_table import TextTable, check_regular, split_unit

if TYPE_CHECKING:
    import pandas as pd

_SI = {"time": "s", "gear_speed": "rad s-1"}
_SETTINGS = ("columns", "skip", "delimiter", "decimal", "bridge", "interval")
_DELIMITERS = {
    "tab": "\t",
    "tabs": "\t",
    "\\t": "\t",
    "semicolon": ";",
    "comma": ",",
    "blank": "",
    "blanks": "",
    " ": "",
}
_TWO = "must be two headings, that of the time and that of the speed"
_INTERVAL = Quantity(unit="s", above=0.0)
_LARGEST = 2**30
"""Files larger than this [bytes] are refused: a record of a minute at 100 kHz has a tenth of it."""


class Reading(TypedDict, total=False):
    """How to read a record; see `read_signal`."""

    columns: Sequence[str] | None
    skip: int | None
    delimiter: str | None
    decimal: str | None
    bridge: int
    interval: float | str | None


def read_signal(
    signal: str | os.PathLike[str] | pd.DataFrame,
    *,
    columns: Sequence[str] | None = None,
    skip: int | None = None,
    delimiter: str | None = None,
    decimal: str | None = None,
    bridge: int = 0,
    interval: float | str | None = None,
) -> xr.Dataset:
    """Read a record of the gear's speed.

    Parameters
    ----------
    signal : path-like or DataFrame
        A text file with a line of headings that name the columns and their units, ``time [s], gear_speed [rad/s]``; a
        table with such columns; or a netCDF file with the variables ``time`` and ``gear_speed`` and their attributes
        ``units``. ``.csv.gz``, ``.mat``, ``.npy``, ``.xlsx`` and ``.tdms`` are read, too.
        In text, the headings may stand below other lines, their units in the line below them, or both in a
        remark (after ``#``) as ``numpy.savetxt`` writes them. Other columns are ignored.
    columns : pair of str, optional
        Headings of time and speed, with the units where the headings have none, or their numbers from 1 with the units
        (``"1 [s]"``, ``"2 [rad/s]"``), for which no headings are needed; variables of a netCDF file. With `interval`,
        or where the file states it, that of the speed is enough. By default the columns called ``time`` (or ``t``) and
        ``gear_speed`` (or ``speed``), or else the only ones with a unit of time and of angular speed.
    skip : int, optional
        Lines above that of the headings, which is recognised by the columns otherwise.
    delimiter : str, optional
        What separates the cells: ``;``, ``,``, ``tab``, ``blanks`` or another character; recognised by default.
    decimal : {'.', ','}, optional
        Decimal sign; recognised by default.
    bridge : int, optional
        Missing samples in a row that are interpolated. A longer gap is an error; what is missing at the end is not part
        of the record.
    interval : float or str, optional
        Time between samples [s], or with a unit (``"10 us"``), of a table: no column of time is needed, and none is
        read. By default that which LabVIEW (``Delta_X``, ``X0``) and Rigol (``Increment``, ``Start``) write above the
        numbers, if there is no column of time or that of the speed alone is given.

    Returns
    -------
    Dataset
        ``gear_speed`` [rad/s] along ``time`` [s]; events and scene if the file is an archive. The attribute ``reading``
        says in words what was recognised: separator, decimal sign, skipped lines, columns, interpolated samples.

    Raises
    ------
    SceneError
        If the record cannot be read, lacks a column or a unit, or holds what is no number or an uneven time.
    """
    table = {"skip": skip, "delimiter": delimiter, "decimal": decimal}
    name = signal if isinstance(signal, str | os.PathLike) else type(signal).__name__
    try:
        step = None if interval is None else _INTERVAL.take("interval", interval)
        wanted, most = _checked(columns, bridge, timed=step is None), int(bridge)
        is_text = isinstance(signal, str | os.PathLike) and not _is_netcdf(Path(signal))
        if step is None and "time" not in wanted and not is_text:
            raise SceneError("columns", shorten(columns), _TWO)
        if not isinstance(signal, str | os.PathLike):
            _refuse(table, "a DataFrame")
            ds = _from_frame(signal, wanted, step)
        elif not is_text:
            _refuse({**table, "interval": interval}, "a netCDF file")
            ds = _from_netcdf(Path(signal), wanted)
        elif (frame := frame_from(Path(signal))) is not None:
            _refuse(table, f"a {Path(signal).suffix} file")
            ds = _from_frame(frame, wanted, step)
        else:
            with unpacked(Path(signal)) as path:
                ds = _from_text(path, wanted, table, step)
        ds = _bridged(ds, most)
        signals(ds)  # refuses an uneven time and the like while the file can be named
    except SceneError as error:
        if error.key in _SETTINGS:
            raise
        raise SceneError("signal", name, f"{error.key} = {error.value}: {error.allowed}") from None
    except (OSError, ValueError) as error:
        raise SceneError("signal", name, str(error)) from None
    return ds


def _checked(columns: Sequence[str] | None, bridge: int, *, timed: bool) -> dict[str, str | None]:
    """Refuse settings that are none; return what columns are wanted."""
    whole("bridge", bridge, 0)
    wanted: dict[str, str | None] = dict.fromkeys(_SI if timed else ("gear_speed",))
    names = [columns] if isinstance(columns, str) else columns
    if names is None:
        return wanted
    if not 1 <= len(names) <= 2 or set(map(type, names)) != {str}:
        raise SceneError("columns", shorten(columns), f"{_TWO}, or that of the speed alone")
    meanings = [*wanted][-len(names) :]
    return dict(zip(meanings, [name.strip() for name in names[-len(meanings) :]], strict=True))


def _refuse(table: Mapping[str, object], what: str) -> None:
    for name, value in table.items():
        if value is not None:
            raise SceneError(name, shorten(value), f"is for text files; this is {what}")


def _is_netcdf(source: Path) -> bool:
    check_regular(source, _LARGEST)
    with source.open("rb") as file:
        return file.read(8).startswith((b"\x89HDF\r\n\x1a\n", b"CDF"))


def _from_netcdf(source: Path, wanted: Wanted) -> xr.Dataset:
    try:
        ds = loaded(source)
    except Exception as error:
        raise ValueError(f"is damaged or not a netCDF file ({error})") from error
    for name, variable in wanted.items():
        asked = variable or name
        if asked not in ds.variables:
            raise ValueError(f"lacks the variable {asked}")
        ds = ds if asked == name else ds.rename({asked: name})
        unit, since, _ = str(ds[name].attrs.get("units", "")).partition(" since ")
        if since:  # dates count from the first
            first = ds[name].values.ravel()[0] if ds[name].size else 0
            ds = ds.assign_coords({name: (ds[name].dims, ds[name].values - first, {"units": unit})})
        if "units" not in ds[name].attrs and ds[name].dtype.kind not in "mM":
            raise ValueError(f"does not state the units of {name} (attribute units)")
    in_si = {
        name: (
            ds[name].dims,
            to_si(ds[name], units, f"{source.name}: {name}"),
            {**ds[name].attrs, "units": units},
        )
        for name, units in _SI.items()
        if str(ds[name].attrs.get("units", "")) != units
    }
    return ds.assign_coords({"time": in_si.pop("time")} if "time" in in_si else {}).assign(in_si)


def _from_frame(frame: Any, wanted: Wanted, step: float | None) -> xr.Dataset:
    if not (hasattr(frame, "columns") and hasattr(frame, "reset_index")):
        raise ValueError("must be a file or a DataFrame: what is in xarray needs no reading")
    if frame.index.name is not None or frame.index.dtype.kind in "mM":
        frame = frame.rename_axis(frame.index.name or "time").reset_index()
    kinds = [dtype.kind for dtype in frame.dtypes]
    names = [
        f"{name} [s]" if kind in "mM" and not split_unit(str(name))[1] else str(name)
        for name, kind in zip(frame.columns, kinds, strict=True)
    ]
    columns = find_columns(names, wanted)
    return _dataset([frame.iloc[:, column.position] for column in columns], columns, (), step)


def _from_text(source: Path, wanted: Wanted, reading: Mapping[str, Any], step: float | None) -> xr.Dataset:
    try:
        table = _opened(source, wanted, reading)
        columns = find_columns(table.headings, wanted)
    except ValueError:
        if wanted.get("time", "given") is not None:
            raise
        wanted = {"gear_speed": None}
        table = _opened(source, wanted, reading)
        if table.clock is None:
            raise
        columns = find_columns(table.headings, wanted)
    numbers, said, start = (
        table.numbers([column.position for column in columns], holes=True, undefined=True),
        table.recognised,
        0.0,
    )
    if step is None and "time" not in wanted:
        if table.clock is None:
            raise ValueError(
                "states no distance of its samples: name the column of time, too, or give it (interval=..., --interval)"
            )
        start, step = table.clock
        said = (*said, f"samples {with_prefix(step, 's')} apart as it states")
    return _dataset(list(numbers.T), columns, said, step, start)


def _opened(source: Path, wanted: Wanted, reading: Mapping[str, Any]) -> TextTable:
    return open_table(
        source,
        largest=_LARGEST,
        names=lambda headings: has_columns(headings, wanted),
        delimiter=_character(reading["delimiter"]),
        decimal=_decimal(reading["decimal"]),
        skip=None if reading["skip"] is None else whole("skip", reading["skip"], 0),
        unit_row=True,
        columns=numbered_positions(wanted),
    )


def _dataset(
    arrays: Sequence[Any],
    columns: Sequence[Column],
    said: Sequence[str],
    step: float | None,
    start: float = 0.0,
) -> xr.Dataset:
    """Put columns into SI units; say which they are where their names do not."""
    read = {}
    for array, column in zip(arrays, columns, strict=True):
        try:
            read[column.meaning] = numbers_of(
                array, "rad/s" if column.meaning == "gear_speed" else "s", column.unit
            )
        except ValueError as error:
            raise ValueError(f"column {column.heading!r}: {error}") from None
    if step is not None:
        read["time"] = start + step * np.arange(len(read["gear_speed"]), dtype=np.float64)
    said = [
        *said,
        *(f"{column.heading!r} taken for the {column.meaning}" for column in columns if column.recognised),
    ]
    return xr.Dataset(
        {"gear_speed": ("time", read["gear_speed"], {"units": _SI["gear_speed"]})},
        coords={"time": ("time", read["time"], {"units": "s"})},
        attrs={"reading": ", ".join(said)},
    )


def _bridged(ds: xr.Dataset, most: int) -> xr.Dataset:
    """Interpolate gaps of at most so many samples; say how many samples that are."""
    if most == 0 or ds["gear_speed"].dims != ("time",):
        return ds
    times, first = _filled(ds["time"].values, most)
    speeds, second = _filled(ds["gear_speed"].values, most)
    if not first + second:
        return ds
    count = "1 sample" if first + second == 1 else f"{first + second} samples"
    said = ", ".join(filter(None, [ds.attrs.get("reading", ""), f"{count} bridged"]))
    ds = ds.assign_coords(time=("time", times, ds["time"].attrs))
    return ds.assign(gear_speed=("time", speeds, ds["gear_speed"].attrs)).assign_attrs(reading=said)


def _filled(values: Floats, most: int) -> tuple[Floats, int]:
    """Values with short gaps interpolated, and how many they are."""
    edges = np.flatnonzero(np.diff(np.isnan(values), prepend=False, append=False))
    gaps = zip(edges[::2], edges[1::2], strict=True)
    inside = [np.arange(a, b) for a, b in gaps if a > 0 and b < len(values) and b - a <= most]
    if not inside:
        return values, 0
    missing, known = np.concatenate(inside), np.flatnonzero(~np.isnan(values))
    filled = values.copy()
    filled[missing] = np.interp(missing, known, values[known])
    return filled, len(missing)


def _character(delimiter: str | None) -> str | None:
    if delimiter is None:
        return None
    character = _DELIMITERS.get(delimiter.lower(), delimiter) if isinstance(delimiter, str) else "?"
    if len(character) > 1 or character.isalnum() or character in ('"', ".", "?", "#", "\n", "\r"):
        raise SceneError(
            "delimiter", shorten(delimiter), "must be one character, such as ';', or tab or blanks"
        )
    return character


def _decimal(decimal: str | None) -> str | None:
    if decimal not in (None, ".", ","):
        raise SceneError("decimal", shorten(decimal), "must be '.' or ','")
    return decimal
