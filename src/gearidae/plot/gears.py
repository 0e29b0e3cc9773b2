"""Pictures of a gear pair over time."""

from __future__ import annotations

import math

import xarray as xr
from matplotlib.axes import Axes

from gearidae.analysis.verdict.table import standstill_rows
from gearidae.archive.variables import STANDSTILL_LIST
from gearidae.drawing.style import (
    Run,
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
from gearidae.plot.outcome import style_of


def gear_speed(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the speed of the gear over time, all runs in one frame (Teodorescu et al. 2009, Figs. 4 and 7).

    Of a train it is the speed of the judged shaft.

    Of a single run, the times at which the gear stood are shaded, by the verdict of each standstill.

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
    drawn = runs_of(ds, "gear_speed")
    _overlay(ax, drawn, "gear_speed", 1.0)
    if len(drawn) == 1:
        _mark_standstills(ax, drawn[0])
    shaft = ds.attrs.get("judged_shaft")
    ax.set_ylabel(f"speed of {shaft} (rad/s)" if shaft else "gear speed (rad/s)")
    low, high = ax.get_ylim()
    if low < 0.0 < high:
        zero_line(ax)
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
            linewidth=line_width(1.0),
            label=run.label,
        )
    tidy(ax)
    legend(ax, runs)


def _mark_standstills(ax: Axes, run: Run) -> None:
    """Shade the times at which the gear stood, by the verdict of each."""
    if STANDSTILL_LIST.name not in run.data:
        return
    time = label_time(ax, [run])
    names, rows = standstill_rows(run.data)
    named: dict[str, None] = {}
    for row in rows:
        standstill = dict(zip(names, row, strict=True))
        end = float(run.data["time"][-1]) if math.isnan(standstill["end"]) else standstill["end"]
        label = "_" if standstill["verdict"] in named else standstill["verdict"]
        named[standstill["verdict"]] = None
        style = style_of(standstill["verdict"])
        ax.axvspan(
            standstill["begin"] * time.factor,
            end * time.factor,
            facecolor=style.colour,
            alpha=0.2,
            hatch=style.hatch,
            edgecolor="white",
            linewidth=0.0,
            label=label,
            zorder=0,
        )
    if named:
        ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, frameon=False, fontsize="small")


def _liveliness(run: Run, name: str) -> float:
    extent = run.settled(name)
    return extent.high - extent.low
