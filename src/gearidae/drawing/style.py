"""What all pictures share: colours, units, axes, one way to draw a trace.

Figures are made directly and never through pyplot, so that drawing changes no global state and needs no
display.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter
from numpy.typing import NDArray

from gearidae.analysis.verdict import START_UP, outcomes
from gearidae.analysis.verdict.judge import is_scheduled
from gearidae.archive.pieces import PIECE, Spread, pieces, reached, spread
from gearidae.archive.select import refuse_train, run_value, runs, scene_of
from gearidae.archive.value_text import coverage_text
from gearidae.archive.variables import SAM_FRACTION
from gearidae.arrays import Floats
from gearidae.drawing.picking import pick
from gearidae.drawing.picture import PictureAxes, is_set, new_picture
from gearidae.errors import SceneError
from gearidae.records import GEAR_COLUMNS
from gearidae.scene.prefixes import PREFIXES, with_prefix

# Okabe and Ito's palette, dark colours first: distinguishable for colour-blind readers and, with the line styles,
# in grey.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
LINE_STYLES = (
    "-",
    (0, (6, 1.5)),
    (0, (1.5, 1)),
    (0, (6, 1.5, 1.5, 1.5)),
    (0, (3, 1)),
    (0, (8, 2, 1, 1, 1, 2)),
    "-",
)
POSITIVE, NEGATIVE = COLOURS[:2]
"""Colours of what pushes and of what pulls."""
MOST_RUNS = 7
"""Runs that one picture shows at most."""

_PREFIXED = ("m", "s", "Pa", "Hz", "N", "N m", "J", "W")
_SPELT = {"rad s-1": "rad/s", "m s-1": "m/s", "kg m2": "kg m²", "J m-2": "J/m²", "m-2": "1/m²"}
_AT_END = ("finished", "stopped")
"""Status of runs that have come to their end."""
_MOST_POINTS = 6000
_LONGEST_LABEL = 32
_WIDTH = 7.2
"""Of a picture [inches]."""
_IN_A_LINE = 84
"""Characters of a legend that a line of such a picture takes, at the usual size of letters."""
_HANDLE = 8
"""Those that the line in front of a name takes, with the space beside it."""


@dataclass(frozen=True, slots=True)
class Run:
    """One run on its way into a picture.

    Attributes
    ----------
    label : str
        Name in legends; empty for a single run.
    data : xarray.Dataset
        The run.
    colour, line : str or tuple
        How matplotlib shall draw it.
    of : int
        Number of runs that could be drawn; more than those that are, if they are too many.
    number : int
        Its number among all runs of the dataset, of which the last dimension changes fastest.
    """

    label: str
    data: xr.Dataset
    colour: str
    line: Any
    of: int
    number: int

    def trace(self, name: str) -> tuple[Floats, Floats]:
        """Time [s] and samples [SI] up to where the run ended, thinned for drawing."""
        return thin(self.data["time"], self.data[name], reached(self.data[name]))

    def settled(self, name: str) -> Spread:
        """Return how the samples [SI] are spread, without the first touch of gears that move at the start.

        The whole run counts where a law drives or loads the gears, or a schedule from rest: these shape the beginning.
        """
        values = self.data[name]
        end = reached(values)
        scene = scene_of(self.data)
        by_law = any((scene.get(shaft) or {}).get("law") for shaft in ("drive", "load"))
        at_rest = not (scene.get("initial") or {}).get("gear_speed")
        left_out = 0.0 if by_law or (at_rest and is_scheduled(scene)) else START_UP
        return spread(values, int(left_out * end), end)


@dataclass(frozen=True, slots=True)
class Scale:
    """Unit of an axis: SI values times `factor` are in `unit`."""

    factor: float
    unit: str


def runs_of(ds: xr.Dataset, name: str) -> list[Run]:
    """Return the runs of a dataset with their labels, colours and line styles.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep.
    name : str
        Variable that is to be drawn.

    Returns
    -------
    list of Run
        At most seven, because more cannot be distinguished in one picture: the first, the last, and those at which the
        outcome changes, see `gearidae.drawing.picking`.

    Raises
    ------
    SceneError
        If the dataset lacks the variable or has no samples.
    """
    if name in GEAR_COLUMNS and name not in ds:
        refuse_train(ds)
    everything = list(runs(ds)) if name in ds else []
    kept = [number for number, (_, run) in enumerate(everything) if _has_samples(run[name])]
    drawable = len(kept)
    if drawable > MOST_RUNS:
        judged = outcomes(ds)
        kept = [kept[number] for number in pick([judged[index].verdict for index in kept], MOST_RUNS)]
    chosen = [everything[number] for number in kept]
    if not chosen:
        raise SceneError("plot", name, "the dataset has no samples of it")
    return [
        Run(label, run, line_colour(index), line_style(index), drawable, number)
        for index, (label, number, (_, run)) in enumerate(zip(run_labels(chosen), kept, chosen, strict=True))
    ]


def run_labels(chosen: Sequence[tuple[Mapping[str, Any], xr.Dataset]]) -> list[str]:
    """Name runs from `gearidae.archive.select.runs` by their swept values, shortened where they stay apart."""
    labels = [_label(label, run) for label, run in chosen]
    short = [_shortened(label) for label in labels]
    return short if len(set(short)) == len(set(labels)) else labels


def line_colour(number: int) -> str:
    """Colour of a line, by its number: of the user's cycle (``axes.prop_cycle``) where that is not the usual one."""
    colours = _cycle().get("color", COLOURS)
    return str(colours[number % len(colours)])


def line_style(number: int) -> Any:
    """Dashes of a line, by its number, as `line_colour`."""
    styles = _cycle().get("linestyle", LINE_STYLES)
    return styles[number % len(styles)]


def line_width(width: float) -> float:
    """Width of a line [points] that has `width` at matplotlib's usual ``lines.linewidth``."""
    return width * float(mpl.rcParams["lines.linewidth"]) / float(mpl.rcParamsDefault["lines.linewidth"])


def _cycle() -> dict[str, list[Any]]:
    return mpl.rcParams["axes.prop_cycle"].by_key() if is_set("axes.prop_cycle") else {}


def scale_for(largest: float, unit: str) -> Scale:
    """Choose the prefix that brings a value between 1 and 1000.

    Parameters
    ----------
    largest : float
        Largest magnitude to be shown [SI].
    unit : str
        Unit without prefix.
    """
    if not (math.isfinite(largest) and largest > 0.0):
        return Scale(1.0, unit)
    power = min(max(3 * math.floor(math.log10(largest * (1 + 1e-9)) / 3), min(PREFIXES)), max(PREFIXES))
    prefix = PREFIXES[power].replace("u", "µ")
    return Scale(10.0**-power, f"{prefix}{unit}")


def quantity_text(value: float, unit: str, digits: int = 4) -> str:
    """Write a value [SI] with the prefix that `scale_for` chooses."""
    scale = scale_for(abs(value), unit)
    return f"{value * scale.factor:.{digits}g} {scale.unit}"


def scaled(largest: float, unit: str) -> Scale:
    """Choose a prefix as `scale_for` does, for units that take one; others stay as they are.

    Parameters
    ----------
    largest : float
        Largest magnitude to be shown [SI].
    unit : str
        Unit without prefix, as datasets have it.
    """
    if unit in _PREFIXED:
        return scale_for(largest, unit)
    return Scale(1.0, _SPELT.get(unit, unit))


def largest(runs: Sequence[Run], name: str) -> float:
    """Largest magnitude of a variable in some runs [SI]."""
    extents = [spread(run.data[name]) for run in runs]
    return max(max(abs(extent.low), abs(extent.high)) for extent in extents)


def thin(time: xr.DataArray, values: xr.DataArray, end: int | None = None) -> tuple[Floats, Floats]:
    """Keep the smallest and the largest sample of some thousand intervals: the same picture, fewer points.

    Parameters
    ----------
    time, values : DataArray, shape (n,)
        In memory, or in a file: they are read piece by piece.
    end : int, optional
        Number of samples to take; by default all.

    Returns
    -------
    time, values : ndarray
    """
    end = len(values) if end is None else end
    size = end * 2 // _MOST_POINTS
    if size < 2:
        return time.variable[:end].values, values.variable[:end].values
    kept = [np.zeros(1, dtype=np.int64)]
    heights = [values.variable[:1].values]
    for offset, part in pieces(values, 0, end, size=max(1, PIECE // size) * size):
        whole = len(part) // size * size
        blocks = part[:whole].reshape(-1, size)
        first = np.arange(0, whole, size)
        extremes = np.sort([first + blocks.argmin(axis=1), first + blocks.argmax(axis=1)], axis=0)
        chosen = np.concatenate([extremes.T.ravel(), np.arange(whole, len(part))])
        kept.append(offset + chosen)
        heights.append(part[chosen])
    indices, once = np.unique(np.concatenate(kept), return_index=True)
    return _picked(time, indices), np.concatenate(heights)[once]


def new_axes(ax: Axes | None, *, height: float = 3.2) -> Axes:
    """Return the axes to draw into: the given ones, or those of a new figure of its own."""
    if ax is not None:
        return ax
    return new_picture((_WIDTH, height), layout="constrained").add_subplot(axes_class=PictureAxes)


def tidy(ax: Axes) -> None:
    """Take away what carries no information, add a faint grid."""
    ax.spines[["top", "right"]].set_visible(False)
    ax.grid(visible=True, color="0.9", linewidth=0.6)
    ax.set_axisbelow(True)
    ax.margins(x=0)


def zero_line(ax: Axes) -> None:
    """Draw a line at zero, behind what is drawn."""
    ax.axhline(0.0, color="0.3", linewidth=line_width(0.8), zorder=1)


def mark_value(line: Callable[..., Any], value: float, words: str) -> None:
    """Mark a value with a dotted line and name it in the legend, by `Axes.axhline` or `Axes.axvline`."""
    line(value, color="0.3", linewidth=line_width(0.8), linestyle=":", label=words)


def label_axis(axis: Axis, words: str, unit: str, *, minor: bool = False) -> None:
    """Label an axis of values in SI with one prefix for all of it, which stands in its label once.

    Parameters
    ----------
    axis : matplotlib Axis
        With its limits.
    words : str
        What it shows.
    unit : str
        Without prefix.
    minor : bool, optional
        Whether to write numbers at minor ticks too.
    """
    scale = scaled(max(map(abs, axis.get_view_interval())), unit)
    numbers = FuncFormatter(lambda value, _: f"{value * scale.factor:.6g}")
    axis.set_major_formatter(numbers)
    if minor:
        axis.set_minor_formatter(numbers)
    axis.set_label_text(f"{words} ({scale.unit})")


def characters(ax: Axes) -> int:
    """Characters of small text that fit into a line of a figure."""
    figure = ax.get_figure(root=True)
    assert figure is not None
    return int(_IN_A_LINE * figure.get_figwidth() / _WIDTH * 10.0 / float(mpl.rcParams["font.size"]))


def legend_columns(ax: Axes, labels: Sequence[str]) -> int:
    """Columns of a legend above the axes: four at most, as many as there is room for."""
    width = max(map(len, labels)) + _HANDLE
    return min(len(labels), 4, max(characters(ax) // width, 1))


def label_time(ax: Axes, runs: Sequence[Run]) -> Scale:
    """Label the time axis for runs to be drawn.

    Returns
    -------
    Scale
        Of the axis.
    """
    longest = float(max(run.data["time"][-1] for run in runs))
    scale = scale_for(longest, "s")
    ax.set_xlabel(f"time ({scale.unit}){_early_end(runs)}")
    ax.set_xlim(0.0, (longest or 1.0) * scale.factor)
    return scale


def _early_end(runs: Sequence[Run]) -> str:
    """Say which runs have not come to their end; nothing if all have."""
    early = [run.data for run in runs if run_value(run.data, "status") not in _AT_END]
    if len(runs) > 1 or not early:
        return f"; {len(early)} of {len(runs)} runs are not at their end" if early else ""
    reached_time, end = (
        with_prefix(float(early[0]["reached"]), "s"),
        with_prefix(early[0].attrs["t_end"], "s"),
    )
    return f"; {run_value(early[0], 'status')} at {reached_time} of {end}"


def number_shown(runs: Sequence[Run]) -> str:
    """Say how many of the runs are shown; nothing if all are."""
    return f"{len(runs)} of {runs[0].of} runs" if len(runs) < runs[0].of else ""


def legend(ax: Axes, runs: Sequence[Run]) -> None:
    """Put the names of the runs above the axes, in the order of the dataset; a single run needs none."""
    if len(runs) < 2:
        return
    handles = dict(zip(*reversed(ax.get_legend_handles_labels()), strict=True))
    shown = ax.legend(
        [handles[run.label] for run in runs],
        [run.label for run in runs],
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=legend_columns(ax, [run.label for run in runs]),
        title=number_shown(runs) or None,
        title_fontsize="small",
        alignment="left",
        frameon=False,
        borderaxespad=0.2,
        handlelength=2.4,
        columnspacing=1.2,
        fontsize="small",
    )
    for handle in shown.get_lines():
        handle.set_linewidth(line_width(2.0))


def _has_samples(values: xr.DataArray) -> bool:
    return any(bool(np.isfinite(part).any()) for _, part in pieces(values))


def _picked(time: xr.DataArray, samples: NDArray[np.int64]) -> Floats:
    """Values of some samples in increasing order, read piece by piece."""
    parts = [
        part[samples[(samples >= offset) & (samples < offset + len(part))] - offset]
        for offset, part in pieces(time)
    ]
    return np.concatenate(parts)


def _shortened(label: str) -> str:
    """Leave out the middle of a label that would take the place of the picture."""
    return label if len(label) <= _LONGEST_LABEL else f"{label[:20]}...{label[-9:]}"


def _label(label: Mapping[str, Any], run: xr.Dataset) -> str:
    """Name a run by its swept values."""
    words = []
    for dim, value in label.items():
        unit = run[dim].attrs.get("units", "1")
        if dim == SAM_FRACTION.name:
            words.append(coverage_text(value))
        elif isinstance(value, float) and unit != "1":
            scale = scaled(abs(value), unit)
            words.append(f"{dim} {value * scale.factor:.4g} {scale.unit}")
        else:
            words.append(f"{dim} {value:g}" if isinstance(value, float) else f"{dim} {value}")
    return ", ".join(words)
