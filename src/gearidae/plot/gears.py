"""Pictures of a gear pair over time."""

from __future__ import annotations

import xarray as xr
from matplotlib.axes import Axes

from gearidae.plot.style import Run, label_time, largest, legend, new_axes, runs_of, scale_for, tidy


def gear_speed(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the speed of the gear over time, all runs in one frame (Teodorescu et al. 2009, Figs. 4 and 7).

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep of a gear pair.
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
    ax = new_axes(ax)
    _overlay(ax, runs_of(ds, "gear_speed"), "gear_speed", 1.0)
    ax.set_ylabel("gear speed (rad/s)")
    low, high = ax.get_ylim()
    if low < 0.0 < high:
        ax.axhline(0.0, color="0.3", linewidth=0.8, zorder=1)
    return ax


def transmission_error(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the dynamic transmission error over time (Teodorescu et al. 2009, Eq. 4).

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep of a gear pair.
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
    ax = new_axes(ax)
    runs = runs_of(ds, "transmission_error")
    scale = scale_for(largest(runs, "transmission_error"), "m")
    _overlay(ax, runs, "transmission_error", scale.factor)
    ax.set_ylabel(f"transmission error ({scale.unit})")
    return ax


def gap(ds: xr.Dataset, ax: Axes | None = None, *, flank: str = "drive") -> Axes:
    """Draw the smallest gap between the teeth over time.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep of a gear pair.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.
    flank : {'drive', 'coast'}, optional
        Which flank.

    Returns
    -------
    Axes

    Raises
    ------
    SceneError
        If the dataset has no samples of it.
    """
    ax = new_axes(ax)
    name = f"{flank}_gap"
    runs = runs_of(ds, name)
    scale = scale_for(largest(runs, name), "m")
    _overlay(ax, runs, name, scale.factor)
    ax.set_ylabel(f"{flank} flank gap ({scale.unit})")
    return ax


def _overlay(ax: Axes, runs: list[Run], name: str, factor: float) -> None:
    """Draw the runs over each other, the liveliest at the back, so that it does not hide the others."""
    time = label_time(ax, runs)
    for run in sorted(runs, key=lambda run: _liveliness(run, name), reverse=True):
        at, values = run.trace(name)
        ax.plot(
            at * time.factor,
            values * factor,
            color=run.colour,
            linestyle=run.line,
            linewidth=1.0,
            label=run.label,
        )
    tidy(ax)
    legend(ax, runs)


def _liveliness(run: Run, name: str) -> float:
    extent = run.settled(name)
    return extent.high - extent.low
