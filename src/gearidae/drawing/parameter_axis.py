"""A swept or drawn key as an axis: where its values lie, and how the axis is labelled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from numpy.typing import NDArray

from gearidae.archive.variables import SAM_FRACTION
from gearidae.drawing.style import scaled

_MOST_NAMES = 12
_UNEVEN = 20.0
"""Longest over shortest step of values above which their axis is logarithmic."""


@dataclass(frozen=True, slots=True)
class ParameterAxis:
    """A key as an axis.

    Attributes
    ----------
    positions : ndarray, shape (n,)
        Where the values lie, in the unit of the label, in the dataset's order.
    label : str
        Name and unit.
    words : tuple of str
        Names of the ticks where the values are no numbers; else empty.
    limit : float, optional
        Largest value that the quantity can have, in the unit of the label.
    factor : float
        What values in SI are multiplied by.
    """

    positions: NDArray[np.float64]
    label: str
    words: tuple[str, ...] = ()
    limit: float | None = None
    factor: float = 1.0


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
    if name == SAM_FRACTION.name:
        return ParameterAxis(100.0 * values, "SAM (%)", limit=100.0, factor=100.0)
    scale = scaled(float(np.abs(values).max()), str(coordinate.attrs.get("units", "1")))
    unit = "" if scale.unit == "1" else f" ({scale.unit})"
    return ParameterAxis(values * scale.factor, f"{name.replace('_', ' ')}{unit}", factor=scale.factor)


def cell_edges(along: ParameterAxis) -> NDArray[np.float64]:
    """Edges of the cells about the positions on an axis in rising order, shape (n + 1,).

    They are the middles between positions, and as far beyond the ends; of a logarithmic axis the geometric ones.
    """
    positions = np.sort(along.positions)
    if is_logarithmic(along):
        return np.asarray(np.exp(_middles(np.log(positions))))
    return _middles(positions)


def is_logarithmic(along: ParameterAxis) -> bool:
    """Whether the steps between the positions are too uneven for an even axis."""
    steps = np.diff(np.sort(along.positions))
    if steps.size < 2 or np.min(along.positions) <= 0.0 or steps.min() <= 0.0:
        return False
    return bool(steps.max() > _UNEVEN * steps.min())


def scale_axis(ax: Axes, which: Literal["x", "y"], along: ParameterAxis) -> None:
    """Give an axis of cells its scale, limits, label, and ticks at the values where there is room for all of them."""
    edges, positions = cell_edges(along), np.sort(along.positions)
    top = edges[-1] if along.limit is None else min(edges[-1], along.limit)
    if is_logarithmic(along):
        ax.set(**{f"{which}scale": "log"})
    ax.set(**{f"{which}lim": (edges[0], top), f"{which}label": along.label})
    if along.words:
        step = -(-len(along.words) // _MOST_NAMES)
        ax.set(**{f"{which}ticks": along.positions[::step], f"{which}ticklabels": along.words[::step]})
    elif not is_logarithmic(along) and np.diff(positions).min(initial=np.inf) * _MOST_NAMES >= top - edges[0]:
        ax.set(
            **{
                f"{which}ticks": positions,
                f"{which}ticklabels": [f"{position:.4g}" for position in positions],
            }
        )


def _middles(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    if positions.size == 1:
        half = 0.5 * abs(positions[0]) or 0.5
        return np.array([positions[0] - half, positions[0] + half])
    middles = 0.5 * (positions[1:] + positions[:-1])
    return np.concatenate([[2.0 * positions[0] - middles[0]], middles, [2.0 * positions[-1] - middles[-1]]])
