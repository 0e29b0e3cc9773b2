"""Picture of what the runs of a sweep did, against the parameters that were swept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Patch
from numpy.typing import NDArray

from gearidae.analysis.verdict import GearOutcome, RollerOutcome, outcomes
from gearidae.archive.select import swept_dims
from gearidae.drawing.parameter_axis import ParameterAxis, cell_edges, parameter_axis, scale_axis
from gearidae.drawing.style import legend_columns, line_width, new_axes, scale_for, scaled, tidy, zero_line
from gearidae.errors import SceneError


@dataclass(frozen=True, slots=True)
class Look:
    """How a verdict looks: colour, marker of a run, hatch of a field; each identifies it without the others."""

    colour: str
    marker: str
    hatch: str


_LOOKS = {
    "turns smoothly": Look("#0072B2", "o", ""),
    "rebounds": Look("#0072B2", "o", ""),
    "runs": Look("#0072B2", "o", ""),
    "irregular": Look("#E69F00", "D", "//"),
    "running up": Look("#56B4E9", "^", ".."),
    "running down": Look("#009E73", "v", "--"),
    "runs back": Look("#CC79A7", "<", "++"),
    "sticks": Look("#D55E00", "X", "xx"),
    "stops": Look("#F0E442", "s", "**"),
    "turns back": Look("#56B4E9", "<", "++"),
    "flies": Look("#56B4E9", "^", ".."),
}
_UNKNOWN = Look("#999999", "P", "oo")


def outcome(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the outcome of each run against what was swept.

    Over one parameter, a bar for each run reaches from the lowest to the highest speed of the gear (of a roller: from
    the largest pull to the largest push), with the verdict as a mark at its lower end; dotted lines stand where the
    verdict changes. Over two parameters, the verdict fills a field for each run, to scale on both axes.

    Parameters
    ----------
    ds : xarray.Dataset
        A sweep over one or two keys, or a selection from a larger one. Samples are not needed.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes

    Raises
    ------
    SceneError
        If the dataset holds no runs, is no sweep, or is one along more than two dimensions.
    """
    judged, dims = outcomes(ds), swept_dims(ds)
    if not 1 <= len(dims) <= 2:
        raise SceneError(
            "plot",
            f"({len(dims)} swept keys)",
            "outcomes are drawn against one or two swept keys; pick some of the others with .sel",
        )
    ax = new_axes(ax, height=3.4 if len(dims) == 1 else 4.2)
    axes = [parameter_axis(ds[dim]) for dim in dims]
    if len(dims) == 1:
        _bars(ax, axes[0], judged, ds.attrs.get("judged_shaft"))
    else:
        _fields(ax, axes[0], axes[1], np.array([result.verdict for result in judged], dtype=object))
    return ax


def style_of(verdict: str) -> Look:
    """How a verdict looks."""
    return _LOOKS.get(verdict, _UNKNOWN)


def _bars(
    ax: Axes, along: ParameterAxis, judged: Sequence[GearOutcome | RollerOutcome], shaft: str | None
) -> None:
    """One bar a run, over one parameter; of a train its judged shaft is named."""
    lows, highs, unit, words = _extents(judged)
    if shaft:
        words = words.replace("gear speed", f"speed of {shaft}")
    largest = float(np.nanmax(np.abs([*lows, *highs, 0.0])))
    scale = scale_for(largest, unit) if unit == "N" else scaled(largest, unit)
    lows, highs = lows * scale.factor, highs * scale.factor
    ax.vlines(along.positions, lows, highs, color="0.6", linewidth=line_width(1.6), zorder=2)
    for verdict in dict.fromkeys(result.verdict for result in judged):
        chosen = np.array([result.verdict == verdict for result in judged])
        style = style_of(verdict)
        ax.plot(
            along.positions[chosen],
            lows[chosen],
            style.marker,
            color=style.colour,
            markersize=6,
            label=verdict,
            zorder=3,
        )
    order = np.argsort(along.positions, kind="stable")
    for left, right in pairwise(order):
        if judged[left].verdict != judged[right].verdict:
            middle = 0.5 * (along.positions[left] + along.positions[right])
            ax.axvline(middle, color="0.3", linestyle=":", linewidth=line_width(1.0), zorder=1)
    zero_line(ax)
    tidy(ax)
    ax.margins(x=0.03)
    ax.set_xlabel(along.label)
    if along.words:
        ax.set_xticks(along.positions, along.words)
    ax.set_ylabel(f"{words} ({scale.unit})")
    _legend(ax, *ax.get_legend_handles_labels())


def _extents(
    judged: Sequence[GearOutcome | RollerOutcome],
) -> tuple[NDArray[np.float64], NDArray[np.float64], str, str]:
    """Lower and upper ends of the bars [SI], their unit, and what they are."""
    if isinstance(judged[0], RollerOutcome):
        rollers = [result for result in judged if isinstance(result, RollerOutcome)]
        lows = np.array([-roller.pull_off_force for roller in rollers])
        return lows, np.array([roller.peak_force for roller in rollers]), "N", "largest pull and push"
    gears = [result for result in judged if isinstance(result, GearOutcome)]
    lows, highs = (np.array([getattr(gear, name) for gear in gears]) for name in ("min_speed", "max_speed"))
    return lows, highs, "rad/s", "lowest to highest gear speed"


def _fields(ax: Axes, down: ParameterAxis, across: ParameterAxis, verdicts: NDArray[np.object_]) -> None:
    """One field a run, from the middle between its values and their neighbours to the next: limits keep their shape."""
    grid = verdicts.reshape(len(down.positions), len(across.positions))
    rows, columns = np.argsort(down.positions, kind="stable"), np.argsort(across.positions, kind="stable")
    grid = grid[np.ix_(rows, columns)]
    up, right = cell_edges(down), cell_edges(across)
    shown = list(dict.fromkeys(verdicts.tolist()))
    for verdict in shown:
        style = style_of(verdict)
        corners = [
            _corners(up[row : row + 2], right[column : column + 2])
            for row, column in np.argwhere(grid == verdict)
        ]
        fields = PolyCollection(corners, facecolors=style.colour, edgecolors="white", linewidths=0.6)
        fields.set_hatch(style.hatch)
        ax.add_collection(fields, autolim=False)
    handles = [
        Patch(facecolor=style_of(word).colour, hatch=style_of(word).hatch, edgecolor="white", linewidth=0.0)
        for word in shown
    ]
    scale_axis(ax, "x", across)
    scale_axis(ax, "y", down)
    ax.spines[["top", "right"]].set_visible(False)
    _legend(ax, handles, shown)


def _corners(up: NDArray[np.float64], right: NDArray[np.float64]) -> list[tuple[float, float]]:
    """Corners of a field from its edges."""
    (bottom, top), (left, end) = up.tolist(), right.tolist()
    return [(left, bottom), (left, top), (end, top), (end, bottom)]


def _legend(ax: Axes, handles: Sequence[Artist], labels: Sequence[str]) -> None:
    ax.legend(
        handles,
        labels,
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=legend_columns(ax, labels),
        frameon=False,
        fontsize="small",
    )
