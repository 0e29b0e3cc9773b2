"""Numbers as other libraries hand them over: with a unit of their own, as durations, masked or missing.

The only reader of numbers and arrays from Python: quantities of pint, arrays of xarray with the attribute ``units``,
durations of numpy, pandas and the standard library, masked arrays, missing values of pandas. What carries a unit is
converted. Truth values, dates and complex numbers are no numbers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from datetime import timedelta
from numbers import Real
from typing import Any, Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.scene.units import cf_unit, from_text, refuse_bare

_SECOND: Final = np.timedelta64(1, "s")
_MISSING: Final = ("NAType", "NaTType")
_KINDS: Final = {"b": "truth values", "M": "dates and times of day", "c": "complex numbers"}


def carried_unit(value: Any) -> tuple[str, Any]:
    """Split a value into the unit that it carries, empty if it carries none, and what is left."""
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        return f"{value.units:~}" or "dimensionless", value.magnitude
    if not isinstance(attributes := getattr(value, "attrs", None), Mapping):
        return "", value
    inside = value.variable.data if hasattr(value, "variable") else value
    if hasattr(inside, "magnitude"):
        return carried_unit(inside)
    return cf_unit(str(attributes.get("units", ""))), inside


def number_of(value: object, unit: str, stated: str = "") -> float | None:
    """Read one number.

    Parameters
    ----------
    value : object
        What the user gave; without a unit it is in SI units.
    unit : str
        The SI unit wanted, ``"1"`` for a pure number.
    stated : str, optional
        Unit of a number that carries none, in place of SI.

    Returns
    -------
    float or None
        [SI]; None for what is no number, NaN for what is missing, infinite for what no float can hold.

    Raises
    ------
    ValueError
        If it carries a unit that does not fit.
    """
    carried, plain = carried_unit(value)
    plain = plain[()] if isinstance(plain, np.ndarray) and plain.ndim == 0 else plain
    if plain is np.ma.masked or type(plain).__name__ in _MISSING:
        return math.nan
    if isinstance(plain, timedelta | np.timedelta64):
        carried, plain = "s", plain.total_seconds() if isinstance(plain, timedelta) else _seconds(plain)
    if isinstance(plain, bool) or not isinstance(plain, Real):
        return None
    try:
        number = float(plain)
    except OverflowError:
        return math.inf
    carried = carried or stated
    return (
        from_text(f"{number!r} {carried}", unit)
        if carried not in ("", unit) and math.isfinite(number)
        else number
    )


def numbers_of(values: object, unit: str, stated: str = "") -> Floats:
    """Read an array of numbers [SI], NaN where one is missing; a list may also hold texts, and numbers with units.

    Parameters
    ----------
    values : array_like
    unit, stated
        As for `number_of`.

    Raises
    ------
    ValueError
        If something is no number, has a unit beside others without one, or one that does not fit; an entry of a list
        is named by its row from 1.
    """
    carried, plain = carried_unit(values)
    if isinstance(plain, list | tuple) and not set(map(type, plain)) <= {int, float}:
        if any(isinstance(cell, str) for cell in plain):
            refuse_bare(plain)
        return np.array([_entry(cell, unit, carried or stated, row) for row, cell in enumerate(plain, 1)])
    cells = np.asarray(plain)
    if cells.dtype.kind in "OUST" and cells.ndim:
        return numbers_of([*np.ma.asarray(plain)] if np.ma.isMA(plain) else [*cells], unit, carried or stated)
    if cells.dtype.kind == "M" and unit == "s" and cells.size:  # dates count from the first
        cells = cells - cells.ravel()[0]
    if cells.dtype.kind == "m":
        cells, carried = _seconds(cells), "s"
    elif (kind := cells.dtype.kind) not in "fiu":
        raise ValueError(f"holds {_KINDS.get(kind, f'entries of type {type(plain).__name__}')}, no numbers")
    numbers: Floats = cells.astype(np.float64)
    if np.ma.isMA(plain):
        numbers[np.ma.getmaskarray(plain)] = np.nan
    if (carried := carried or stated) in ("", unit):
        return numbers
    zero = from_text(f"0 {carried}", unit)
    numbers *= from_text(f"1 {carried}", unit, difference=True)
    return numbers + zero if zero else numbers


def _entry(cell: Any, unit: str, stated: str, row: int) -> Any:
    """Read an entry of a list: a number, a text of one, or a row of a map."""
    if cell is None or (isinstance(cell, str) and not cell.strip()):
        raise ValueError(f"row {row} is empty")
    if np.ndim(getattr(cell, "magnitude", cell)) > 0:
        return numbers_of(cell, unit, stated)
    if isinstance(cell, str):
        with suppress(ValueError):
            cell = float(cell)
    why = ""
    try:
        number = from_text(cell, unit) if isinstance(cell, str) else number_of(cell, unit, stated)
    except ValueError as error:
        number, why = None, f" ({error})"
    if number is None:
        raise ValueError(f"row {row} is {str(cell)[:40]!r}, no number{why}")
    return number


def _seconds(duration: Any) -> Any:
    try:
        return duration / _SECOND
    except TypeError:
        raise ValueError("are durations in months or years, whose length varies: give seconds") from None
