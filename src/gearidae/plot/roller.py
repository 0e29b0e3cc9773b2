"""Pictures of a roller that falls onto a plane."""

from __future__ import annotations

import xarray as xr
from matplotlib.axes import Axes

from gearidae.drawing.style import (
    label_time,
    largest,
    legend,
    line_width,
    new_axes,
    runs_of,
    scale_for,
    tidy,
    zero_line,
)


def roller_force(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the contact force over time (Teodorescu et al. 2009, Fig. 2).

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep of a roller.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes

    Raises
    ------
    SceneError
        If the dataset has no samples of it.
    """
    return _draw(ds, ax, "force", "N", "contact force")


def roller_gap(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the separation of the roller and the plane over time (Teodorescu et al. 2009, Fig. 3).

    Of elastic bodies it is ``min_separation``, the smallest distance of the deflected surfaces, as in the paper; of the
    asperity model, whose bodies do not deflect, ``height``.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep of a roller.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes

    Raises
    ------
    SceneError
        If the dataset has no samples of it.
    """
    if "min_separation" in ds and "time" in ds["min_separation"].dims:
        return _draw(ds, ax, "min_separation", "m", "smallest separation")
    return _draw(ds, ax, "height", "m", "gap")


def _draw(ds: xr.Dataset, ax: Axes | None, name: str, unit: str, words: str) -> Axes:
    ax = new_axes(ax)
    runs = runs_of(ds, name)
    time = label_time(ax, runs)
    scale = scale_for(largest(runs, name), unit)
    for run in runs:
        at, values = run.trace(name)
        ax.plot(
            at * time.factor,
            values * scale.factor,
            color=run.colour,
            linestyle=run.line,
            linewidth=line_width(1.4),
            label=run.label,
        )
    tidy(ax)
    legend(ax, runs)
    zero_line(ax)
    ax.set_ylabel(f"{words} ({scale.unit})")
    return ax
