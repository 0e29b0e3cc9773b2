"""The posterior of a calibration: the density of each key, and of each two keys."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from gearidae.archive.dataset import dimension_names
from gearidae.arrays import Floats
from gearidae.calibration.declared.calibrate import calibrated_keys
from gearidae.drawing.parameter_axis import parameter_axis
from gearidae.drawing.picture import PictureAxes, new_picture
from gearidae.drawing.style import POSITIVE, tidy

_BINS: Final = 40
"""Bins of draws, along each key."""
_PANEL: Final = 2.4
"""Side of the panel of one key [inches]."""


@dataclass(frozen=True, slots=True)
class _Key:
    """A key as an axis: edges of its cells in the unit of the label, and the summary in that unit."""

    edges: Floats
    label: str
    mean: float
    quantiles: Floats


def posterior(ds: xr.Dataset, *, figure: Figure | SubFigure | None = None) -> Figure | SubFigure:
    """Draw the posterior density of each key and, below the diagonal, of each two keys.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.calibrate`.
    figure : matplotlib Figure or SubFigure, optional
        Where to draw; by default a new one.

    Returns
    -------
    Figure or SubFigure
        On the diagonal the band between the outermost quantiles is faint, that between the inner ones is full; a line
        is at the mean.

    Raises
    ------
    SceneError
        If the dataset is no posterior.
    """
    keys = calibrated_keys(ds)
    names = list(dimension_names(keys).values())
    axes = [_axis(ds, key, name) for key, name in zip(keys, names, strict=True)]
    weight = _cells(ds, names, axes)
    count = len(keys)
    size = (7.2, 3.8) if count == 1 else (_PANEL * count + 0.8, _PANEL * count + 0.4)
    figure = figure or new_picture(size, panels=count > 1, layout="constrained")
    for row in range(count):
        for column in range(row + 1):
            ax = figure.add_subplot(count, count, row * count + column + 1, axes_class=PictureAxes)
            if row == column:
                _draw_one(ax, axes[row], weight([row]))
            else:
                shares = weight([column, row])
                ax.pcolormesh(axes[column].edges, axes[row].edges, shares.T, cmap="Blues", rasterized=True)
            _label(ax, axes, row, column)
    return figure


def _axis(ds: xr.Dataset, key: str, name: str) -> _Key:
    """Cells of a grid, or bins of draws."""
    values = ds[name]
    along = parameter_axis(values)
    factor = along.factor
    if "weight" in ds:
        half = 0.5 * (along.positions[1] - along.positions[0])
        edges = np.append(along.positions - half, along.positions[-1] + half)
    else:
        edges = np.linspace(along.positions.min(), along.positions.max(), _BINS + 1)
    summary = ds.sel(parameter=key)
    return _Key(edges, along.label, factor * float(summary["mean"]), factor * summary["quantiles"].values)


def _cells(ds: xr.Dataset, names: list[str], axes: list[_Key]) -> Callable[[list[int]], Floats]:
    """Make a function that returns the share of the posterior in the cells of one or two keys."""

    def of_grid(chosen: list[int]) -> Floats:
        kept = [names[number] for number in chosen]
        others = [name for name in names if name not in kept]
        return np.asarray(ds["weight"].sum(others).transpose(*kept), dtype=np.float64)

    def of_draws(chosen: list[int]) -> Floats:
        points = np.stack([parameter_axis(ds[names[number]]).positions for number in chosen], axis=1)
        counts, _ = np.histogramdd(points, [axes[number].edges for number in chosen])
        return np.asarray(counts / len(points), dtype=np.float64)

    return of_grid if "weight" in ds else of_draws


def _draw_one(ax: Axes, key: _Key, shares: Floats) -> None:
    """Density of one key with its quantiles."""
    density = shares / np.diff(key.edges)
    ax.stairs(density, key.edges, color=POSITIVE, linewidth=1.4)
    levels = len(key.quantiles) // 2
    for index in range(levels):
        ax.axvspan(
            key.quantiles[index],
            key.quantiles[-1 - index],
            color=POSITIVE,
            alpha=0.12 * (index + 1),
            linewidth=0,
        )
    ax.axvline(key.mean, color="0.3", linewidth=0.9)
    ax.set_ylim(bottom=0.0)


def _label(ax: Axes, axes: list[_Key], row: int, column: int) -> None:
    """Label the outer axes only."""
    tidy(ax)
    last = row == len(axes) - 1
    ax.set_xlim(axes[column].edges[0], axes[column].edges[-1])
    if last:
        ax.set_xlabel(axes[column].label)
    else:
        ax.tick_params(labelbottom=False)
    if row == column:
        ax.set_yticks([])
        ax.set_ylabel("posterior density" if len(axes) == 1 else "")
    elif column == 0:
        ax.set_ylabel(axes[row].label)
    else:
        ax.tick_params(labelleft=False)
