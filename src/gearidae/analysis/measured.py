"""Signals from files: what a rig or a simulation has written, units stated."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import xarray as xr

from gearidae.analysis.signal import signals, to_si
from gearidae.archive.heaps import check_heaps
from gearidae.archive.library import loaded
from gearidae.errors import SceneError
from gearidae.scene.table_head import open_table
from gearidae.scene.text_table import check_regular, listed, split_unit

__all__ = ["read_signal"]

_SI = {"time": "s", "gear_speed": "rad s-1"}
_NAMES = {"t": "time", "time": "time", "speed": "gear_speed", "gear_speed": "gear_speed"}
_EXAMPLE = "the first line must name the columns and their units, such as: time [s], gear_speed [rad/s]"
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
        check_regular(source, _LARGEST)
        with source.open("rb") as file:
            head = file.read(8)
        binary = head.startswith((b"\x89HDF\r\n\x1a\n", b"CDF"))
        ds = _from_netcdf(source) if binary else _from_csv(source)
    except SceneError:
        raise
    except (OSError, ValueError) as error:
        raise SceneError("signal", path, str(error)) from None
    try:
        signals(ds)  # refuses an uneven time and the like while the file can be named
    except SceneError as error:
        raise SceneError("signal", path, f"{error.key} = {error.value}: {error.allowed}") from None
    return ds


def _from_netcdf(source: Path) -> xr.Dataset:
    check_heaps("signal", source)
    try:
        ds = loaded(source)
    except Exception as error:
        raise ValueError(f"is damaged or not a netCDF file ({error})") from error
    for name in _SI:
        if name not in ds.variables:
            raise ValueError(f"lacks the variable {name}")
        if "units" not in ds[name].attrs:
            raise ValueError(f"does not state the units of {name} (attribute units)")
    in_si = {
        name: (
            ds[name].dims,
            to_si(ds[name], units, f"{source.name}: {name}"),
            {**ds[name].attrs, "units": units},
        )
        for name, units in _SI.items()
        if str(ds[name].attrs["units"]) != units
    }
    return ds.assign_coords({"time": in_si.pop("time")} if "time" in in_si else {}).assign(in_si)


def _from_csv(source: Path) -> xr.Dataset:
    table = open_table(source, largest=_LARGEST, names=_names, unit_row=True)
    columns = _columns(table.headings)
    numbers = table.numbers([place for place, _ in columns.values()], holes=True)
    values = {
        name: to_si(xr.DataArray(column, attrs={"units": unit}), _SI[name], f"{source.name}: {name}")
        for column, (name, (_, unit)) in zip(numbers.T, columns.items(), strict=True)
    }
    return xr.Dataset(
        {"gear_speed": ("time", values["gear_speed"], {"units": _SI["gear_speed"]})},
        coords={"time": ("time", values["time"], {"units": "s"})},
    )


def _names(headings: Sequence[str]) -> bool:
    """Whether texts are headings of the columns that are read."""
    return set(_SI) <= {_known(heading) for heading in headings}


def _known(heading: str) -> str | None:
    """Which column of a record a heading names."""
    return _NAMES.get(split_unit(heading)[0].lower().replace(" ", "_"))


def _columns(headings: Sequence[str]) -> dict[str, tuple[int, str]]:
    """Place and unit of the time and the speed among the headings."""
    found: dict[str, tuple[int, str]] = {}
    for place, heading in enumerate(headings):
        name = _known(heading)
        if name is None:
            continue
        bare, unit = split_unit(heading)
        if not unit:
            raise ValueError(f"{bare!r} states no unit; {_EXAMPLE}")
        if name in found:
            raise ValueError(f"has two columns for {name}")
        found[name] = (place, unit)
    missing = [name for name in _SI if name not in found]
    if missing:
        raise ValueError(f"has no column {' nor '.join(missing)} among {listed(headings)}; {_EXAMPLE}")
    return {name: found[name] for name in _SI}
