"""The picture of an operating map."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

from gearidae.analysis.verdict.codes import Outcome
from gearidae.arrays import Floats
from gearidae.drawing.parameter_axis import parameter_axis
from gearidae.drawing.style import new_axes
from gearidae.errors import SceneError

_LOOKS = {
    Outcome.UNFINISHED: ("0.8", "not finished"),
    Outcome.TURNS: ("#0072B2", "turns"),
    Outcome.CROSSES_BACKLASH: ("#E69F00", "crosses the backlash"),
    Outcome.STICKS: ("#D55E00", "sticks"),
}


def outcome_map(chart: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw what the gears do over two keys, one coloured cell for each run.

    Parameters
    ----------
    chart : xarray.Dataset
        From `gearidae.studies.operating_map`; the first key upwards, the second to the right.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        With a cross on the runs that stick after their teeth have crossed the backlash.

    Raises
    ------
    SceneError
        If the dataset is no operating map.
    """
    if "outcome" not in chart or chart["outcome"].ndim != 2:
        raise SceneError("plot", "outcome_map", "needs an operating map, from studies.operating_map")
    for dim in chart["outcome"].dims:
        chart = chart.sortby(str(dim)) if chart[dim].dtype.kind in "fiu" else chart
    ax = new_axes(ax, height=4.2)
    vertical, horizontal = (chart[dim] for dim in chart["outcome"].dims)
    codes = list(_LOOKS)
    norm = BoundaryNorm(np.arange(codes[0] - 0.5, codes[-1] + 1.0), len(codes))
    colours = ListedColormap([colour for colour, _ in _LOOKS.values()])
    across, along = parameter_axis(horizontal), parameter_axis(vertical)
    ax.pcolormesh(
        _edges(across.places),
        _edges(along.places),
        chart["outcome"].values,
        cmap=colours,
        norm=norm,
        edgecolor="w",
        linewidth=0.4,
    )
    _mark_crossings(ax, chart, across.places, along.places)
    if across.words:
        ax.set_xticks(across.places, across.words)
    if along.words:
        ax.set_yticks(along.places, along.words)
    ax.set_xlabel(across.label)
    ax.set_ylabel(along.label)
    present = set(chart["outcome"].values.ravel().tolist())
    handles = [
        Patch(color=colour, label=words) for code, (colour, words) in _LOOKS.items() if code in present
    ]
    ax.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, frameon=False, fontsize="small"
    )
    return ax


def _mark_crossings(ax: Axes, chart: xr.Dataset, across: Floats, along: Floats) -> None:
    """Put a cross on the gears that stick after their teeth have crossed the backlash."""
    both = (chart["outcome"].values == Outcome.STICKS) & (chart["flank_changes"].values > 0)
    rows, columns = np.nonzero(both)
    if rows.size:
        ax.plot(
            across[columns],
            along[rows],
            linestyle="none",
            marker="x",
            markersize=4,
            color=_LOOKS[Outcome.CROSSES_BACKLASH][0],
        )


def _edges(values: Floats) -> Floats:
    """Edges of the cells around values in rising order: the middles, and as far beyond the ends."""
    if values.size == 1:
        half = 0.5 * abs(values[0]) or 0.5
        return np.array([values[0] - half, values[0] + half])
    middles = 0.5 * (values[1:] + values[:-1])
    return np.concatenate([[2.0 * values[0] - middles[0]], middles, [2.0 * values[-1] - middles[-1]]])
