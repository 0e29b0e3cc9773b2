"""The picture of a coating map."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from gearidae.drawing.parameter_axis import parameter_axis
from gearidae.drawing.style import label_axis, line_colour, line_style, line_width, new_axes, scale_for, tidy
from gearidae.monitor.map_model import require_map

if TYPE_CHECKING:
    from gearidae.monitor.assessment import Assessment

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
    along = parameter_axis(chart["sam_fraction"])
    percent = along.positions
    further = [str(dim) for dim in chart["characteristic_frequency"].dims if dim != "sam_fraction"]
    lines = chart.stack(line=further) if further else chart.expand_dims("line")
    for number in range(lines.sizes["line"]):
        line = lines.isel(line=number)
        frequency, spread = line["characteristic_frequency"].values, line["uncertainty"].values
        colour = line_colour(number)
        if not further:
            for later in line["impact_frequency"].transpose("impact", ...).values[1:]:
                ax.plot(percent, later, color=_LATER, linewidth=line_width(0.8), zorder=1)
        ax.fill_between(
            percent, frequency - spread, frequency + spread, color=colour, alpha=0.25, linewidth=0
        )
        label = ", ".join(_named(lines[dim], line[dim].item()) for dim in further)
        ax.plot(
            percent,
            frequency,
            color=colour,
            linestyle=line_style(number),
            linewidth=line_width(1.4),
            marker=".",
            markersize=4,
            label=label or "first impact",
        )
    if not further and chart.sizes["impact"] > 1:
        ax.plot([], [], color=_LATER, linewidth=line_width(0.8), label="later impacts")
    if assessment is not None and np.isfinite(assessment.low):
        ax.axvspan(
            100.0 * assessment.low, 100.0 * assessment.high, color="#E69F00", alpha=0.3, label="assessed"
        )
    ax.set_yscale("log")
    label_axis(ax.yaxis, "frequency of the impact response", "Hz", minor=True)
    ax.tick_params(axis="y", which="minor", labelsize="x-small")
    ax.set_xlabel(along.label)
    tidy(ax)
    ax.legend(frameon=False, fontsize="small")
    return ax


def _named(coordinate: xr.DataArray, value: float) -> str:
    """Swept value with its name and unit."""
    scale = scale_for(abs(value), str(coordinate.attrs.get("units", "1")))
    unit = "" if scale.unit == "1" else f" {scale.unit}"
    return f"{coordinate.name} {value * scale.factor:.4g}{unit}"
