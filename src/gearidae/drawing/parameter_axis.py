"""A swept or drawn key as an axis: where its values lie, and how the axis is labelled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.drawing.style import scaled


@dataclass(frozen=True, slots=True)
class ParameterAxis:
    """A key as an axis.

    Attributes
    ----------
    places : ndarray, shape (n,)
        Where the values lie, in the unit of the label, in the dataset's order.
    label : str
        Name and unit.
    words : tuple of str
        Names of the places where the values are no numbers; else empty.
    limit : float, optional
        Largest value that the quantity can have, in the unit of the label.
    """

    places: NDArray[np.float64]
    label: str
    words: tuple[str, ...] = ()
    limit: float | None = None


def parameter_axis(coordinate: xr.DataArray) -> ParameterAxis:
    """Make the axis of a coordinate: coverage in per cent, lengths, forces and so on with a prefix.

    Parameters
    ----------
    coordinate : DataArray, shape (n,)
        With its SI unit among its attributes.
    """
    values = coordinate.values
    name = str(coordinate.name)
    if not np.issubdtype(values.dtype, np.number):
        return ParameterAxis(np.arange(len(values), dtype=np.float64), name, tuple(map(str, values.tolist())))
    if name == "sam_fraction":
        return ParameterAxis(100.0 * values, "SAM (%)", limit=100.0)
    scale = scaled(float(np.abs(values).max()), str(coordinate.attrs.get("units", "1")))
    unit = "" if scale.unit == "1" else f" ({scale.unit})"
    return ParameterAxis(values * scale.factor, f"{name.replace('_', ' ')}{unit}")
