"""Pictures of what depends on the coating: the coating map and the starting torque."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import EngFormatter, LogLocator, NullFormatter, StrMethodFormatter

from gearidae.analysis.map_model import require_map
from gearidae.drawing.style import COLOURS, LINE_STYLES, new_axes, scale_for, tidy
from gearidae.errors import SceneError
from gearidae.studies.products import require

if TYPE_CHECKING:
    from gearidae.analysis.assessment import Assessment

_LATER = "0.6"


def coating_map(chart: xr.Dataset, ax: Axes | None = None, *, assessment: Assessment | None = None) -> Axes:
    """Draw the characteristic frequency against the SAM fraction (Teodorescu et al. 2009, Fig. 10).

    Parameters
    ----------
    chart : xarray.Dataset
        From `gearidae.analysis.coating_map`; of one line, the responses to later impacts are drawn too, in grey.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.
    assessment : Assessment, optional
        From `gearidae.analysis.assess`: its interval is shaded.

    Returns
    -------
    Axes

    Raises
    ------
    SceneError
        If the dataset is no coating map.
    """
    chart = require_map(chart)
    ax = new_axes(ax, height=3.8)
    percent = 100.0 * chart["sam_fraction"].values
    further = [str(dim) for dim in chart["characteristic_frequency"].dims if dim != "sam_fraction"]
    lines = chart.stack(line=further) if further else chart.expand_dims("line")
    for number in range(lines.sizes["line"]):
        line = lines.isel(line=number)
        frequency, spread = line["characteristic_frequency"].values, line["uncertainty"].values
        colour = COLOURS[number % len(COLOURS)]
        if not further:
            for later in line["impact_frequency"].transpose("impact", ...).values[1:]:
                ax.plot(percent, later, color=_LATER, linewidth=0.8, zorder=1)
        ax.fill_between(
            percent, frequency - spread, frequency + spread, color=colour, alpha=0.25, linewidth=0
        )
        label = ", ".join(_named(lines[dim], line[dim].item()) for dim in further)
        ax.plot(
            percent,
            frequency,
            color=colour,
            linestyle=LINE_STYLES[number % len(LINE_STYLES)],
            linewidth=1.4,
            marker=".",
            markersize=4,
            label=label or "first impact",
        )
    if not further and chart.sizes["impact"] > 1:
        ax.plot([], [], color=_LATER, linewidth=0.8, label="later impacts")
    if assessment is not None and np.isfinite(assessment.low):
        ax.axvspan(
            100.0 * assessment.low, 100.0 * assessment.high, color="#E69F00", alpha=0.3, label="assessed"
        )
    ax.set_yscale("log")
    ax.yaxis.set_major_formatter(EngFormatter(sep=" "))
    ax.yaxis.set_minor_formatter(EngFormatter(sep=" "))
    ax.tick_params(axis="y", which="minor", labelsize="x-small")
    ax.set_xlabel("SAM (%)")
    ax.set_ylabel("frequency of the impact response (Hz)")
    tidy(ax)
    ax.legend(frameon=False, fontsize="small")
    return ax


def starting_torque(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the starting torque against the SAM fraction.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.analysis.starting_torque`.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        On a logarithmic scale; fractions at which adhesion does not hold the gear have no point.

    Raises
    ------
    SceneError
        If the dataset is none of starting torques, or adhesion holds the gear nowhere.
    """
    require(ds, "starting_torque")
    ax = new_axes(ax, height=3.8)
    percent = 100.0 * ds["sam_fraction"].values
    drawn = False
    for number, (name, label) in enumerate(
        (("static_torque", "static: without inertia"), ("simulated_torque", "simulated: from rest"))
    ):
        torque = ds[name].values
        held = np.isfinite(torque) & (torque > 0.0)
        if held.any():
            drawn = True
            ax.plot(
                percent[held],
                torque[held],
                color=COLOURS[number],
                linestyle=LINE_STYLES[number],
                marker=".",
                linewidth=1.2,
                label=label,
            )
    if not drawn:
        raise SceneError(
            "plot", "starting_torque", "adhesion does not hold the gear at any of these fractions"
        )
    ax.set_yscale("log")
    ax.set_xlabel("SAM (%)")
    ax.set_ylabel("starting torque on the pinion (N m)")
    ax.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    tidy(ax)
    if len(percent) > 1:
        ax.set_xlim(percent.min(), percent.max())
    else:
        ax.set_xticks(percent)
    if ds.attrs.get("drive_torque", 0.0) > 0.0:
        ax.axhline(
            ds.attrs["drive_torque"], color="0.3", linewidth=0.8, linestyle=":", label="the drive's own"
        )
    ax.legend(frameon=False, fontsize="small")
    return ax


def starting_torques(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the distribution function of a population's starting torques, a line for each coverage.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.starting_torque` of a scene with a population.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        With the drive's own torque; gears that did not start are missing from the top of their line.

    Raises
    ------
    SceneError
        If the dataset is something else, or no gear has started.
    """
    require(ds, "starting_torques")
    if not np.isfinite(ds["starting_torque"]).any():
        raise SceneError("plot", "starting_torques", "no gear has started")
    ax = new_axes(ax, height=3.8)
    count = ds.sizes["seed"]
    for number in range(ds.sizes["sam_fraction"]):
        one = ds["starting_torque"].isel(sam_fraction=number)
        torque = np.sort(one.values[np.isfinite(one.values)])
        ax.step(
            torque,
            np.arange(1, torque.size + 1) / count,
            where="post",
            color=COLOURS[number % len(COLOURS)],
            linestyle=LINE_STYLES[number % len(LINE_STYLES)],
            marker=".",
            linewidth=1.2,
            label=f"SAM {100.0 * float(one['sam_fraction']):.4g} %",
        )
    ax.set_xscale("log")
    ax.xaxis.set_major_formatter(EngFormatter(sep=" "))
    ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_ylim(0.0, 1.02)
    ax.set_xlabel("starting torque on the pinion (N m)")
    ax.set_ylabel(f"share of {count} gears")
    tidy(ax)
    if ds.attrs.get("drive_torque", 0.0) > 0.0:
        ax.axvline(
            ds.attrs["drive_torque"], color="0.3", linewidth=0.8, linestyle=":", label="the drive's own"
        )
    ax.legend(frameon=False, fontsize="small")
    return ax


def _named(coordinate: xr.DataArray, value: float) -> str:
    """Swept value with its name and unit."""
    scale = scale_for(abs(value), str(coordinate.attrs.get("units", "1")))
    unit = "" if scale.unit == "1" else f" {scale.unit}"
    return f"{coordinate.name} {value * scale.factor:.4g}{unit}"
