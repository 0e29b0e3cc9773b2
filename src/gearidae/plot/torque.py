"""The picture of the contact torque on the gear."""

from __future__ import annotations

import math
from textwrap import wrap

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from gearidae.drawing.style import (
    NEGATIVE,
    POSITIVE,
    Run,
    Scale,
    characters,
    label_time,
    line_width,
    new_axes,
    number_shown,
    runs_of,
    scale_for,
    tidy,
    zero_line,
)

_TORQUE = "gear_contact_torque"


def contact_torque(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the torque of the tooth contacts on the gear over time (Teodorescu et al. 2009, Fig. 8).

    The runs of a sweep are set one below the other, all to the same scale, with torque that drives the gear
    above the line and torque by which adhesion holds it back below. The scale is that of the runs without
    their start-up, unless a torque or the speed follows a schedule or a law; what exceeds it there is cut.

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
    runs = runs_of(ds, _TORQUE)
    ax = new_axes(ax, height=3.2 if len(runs) == 1 else 1.2 + 0.7 * len(runs))
    settled = [run.settled(_TORQUE) for run in runs]
    low, high = min(extent.low for extent in settled), max(extent.high for extent in settled)
    scale = scale_for(max(abs(low), abs(high)), "N m")
    if len(runs) == 1:
        _curve(ax, runs[0], low, high, scale)
    else:
        _strips(ax, runs, min(low, 0.0), max(high, 0.0), scale)
    return ax


def _curve(ax: Axes, run: Run, low: float, high: float, scale: Scale) -> None:
    """Draw one run as a curve."""
    time = label_time(ax, [run])
    at, torque = run.trace(_TORQUE)
    ax.plot(at * time.factor, torque * scale.factor, color=run.colour, linewidth=line_width(1.0))
    tidy(ax)
    if 0.0 < low < 0.5 * (high - low):
        low = 0.0  # a run-up begins there
    margin = 0.06 * (high - low) or 0.06 * abs(high) or 1.0 / scale.factor
    ax.set_ylim((low - margin) * scale.factor, (high + margin) * scale.factor)
    if low < 0.0 < high:
        zero_line(ax)
    ax.set_ylabel(f"contact torque\non the gear ({scale.unit})")


def _strips(ax: Axes, runs: list[Run], low: float, high: float, scale: Scale) -> None:
    """Draw runs below each other, each about its own zero line."""
    time = label_time(ax, runs)
    step = 1.12 * (high - low) or 1.0
    cut = False
    for row, run in enumerate(runs):
        at, torque = run.trace(_TORQUE)
        clipped = np.clip(torque, low, high)
        cut = cut or not np.array_equal(clipped, torque, equal_nan=True)
        zero = -row * step
        ax.axhline(zero * scale.factor, color="0.6", linewidth=line_width(0.6), zorder=1)
        for part, colour in ((np.maximum(clipped, 0.0), POSITIVE), (np.minimum(clipped, 0.0), NEGATIVE)):
            if part.any():
                ax.fill_between(
                    at * time.factor,
                    zero * scale.factor,
                    (zero + part) * scale.factor,
                    where=part != 0.0,
                    color=colour,
                    linewidth=line_width(0.6),
                )
    tidy(ax)
    bottom = low - (len(runs) - 1) * step
    ax.set_ylim((bottom - 0.1 * step) * scale.factor, (high + 0.1 * step) * scale.factor)
    ax.set_yticks([-row * step * scale.factor for row in range(len(runs))], [run.label for run in runs])
    ax.tick_params(axis="y", length=0)
    ax.grid(visible=False, axis="y")
    ax.spines["left"].set_visible(False)
    details = [number_shown(runs), "start-up cut off" * cut]
    lines = [
        ", ".join(filter(None, ["contact torque on the gear", *details])),
        "drives it (blue), holds it back by adhesion (orange)",
    ]
    ax.set_title(
        "\n".join(part for line in lines for part in wrap(line, characters(ax))),
        loc="left",
        fontsize="medium",
    )
    _scale_bar(ax, max(high, -low) * scale.factor, scale.unit)


def _scale_bar(ax: Axes, largest: float, unit: str) -> None:
    """Put a bar of a round length beside the first strip."""
    if largest <= 0.0:
        return
    power = 10.0 ** math.floor(math.log10(largest))
    length = power * math.floor(largest / power)
    beside = ax.get_yaxis_transform()  # x in parts of the axes, y in units of the data
    ends = {"arrowstyle": "|-|,widthA=0.2,widthB=0.2", "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0}
    ax.annotate(
        "", xy=(1.012, 0.0), xytext=(1.012, length), xycoords=beside, annotation_clip=False, arrowprops=ends
    )
    ax.text(1.022, length / 2, f"{length:g} {unit}", transform=beside, va="center", fontsize="small")
