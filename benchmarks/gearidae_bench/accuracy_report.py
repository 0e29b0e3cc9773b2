"""What the accuracy measurement found, as a page in Markdown and a picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from datetime import date
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import gearidae
from gearidae_bench.accuracy import RTOLS, Achieved

__all__ = ["PICTURE", "draw_accuracy", "page", "quantiles"]

PICTURE: Final = "accuracy.png"
SHARES: Final = (0.1, 0.5, 0.9, 1.0)

_INTRODUCTION = """\
How accurate is a run whose tolerance is `run.rtol`? Every shipped case, in three states of the coating (whole
monolayer, 60 % of it, bare silicon), is run at seven tolerances and held against a reference.

The tolerance bounds the error of a single step: relative to the roughness for lengths, and to the roughness per time
unit for speeds. What is shown is the error of the whole run: the largest error of the gear's (or roller's) speed over
its peak-to-peak fluctuation, or of the transmission error (or height) over the roughness, whichever is larger. Steps
add up, and every impact multiplies what it meets.

**References.** Gauss-Legendre collocation of order twelve at a tolerance of 1e-12, with a step's end at every event,
every kink of the force, every schedule knot and every sample: another method, another error control, another way to
find events. Its own error, in the table, is its difference from a run at a tenth of the tolerance. Where bodies give
way, the equations are algebraic in part, and the reference is a run of the engine's own at 1e-12 held against one at
1e-11; that shows how errors fall with the tolerance, not that the limit is right, which the tests of the elastic
contact do.

**Cases.** The low speed is run for 20 ms, the high speed for 0.5 ms, and run-up, braking and alternation for a
hundredth of their time, with torque schedules as much faster: they break away, stop and change levels all the same.
Rollers are run with both contact models.
"""
_ADVICE = """\
## What to ask for

The error of a run is some tens of tolerances in the middle and some hundreds with elastic bodies, and falls with the
tolerance: the default of 1e-6 is good to 1e-4 of the fluctuation in most of these runs. Each decade of the tolerance
takes a decade off the error.

Two kinds of run need more, and do not bear a tolerance of 1e-3. Gears that have been braked to a stop go on bouncing
between each other's teeth with next to nothing to damp them, and every bounce multiplies the error of the one before.
Bare silicon at low speed falls into its adhesive well and rings there, a hundred thousand times in these 20 ms; the
phase of that ringing is lost first. Such a run says how large the ringing is, not where it stands at a given time: ask
for 1e-9 if that matters, and compare two tolerances.
"""


def quantiles(results: Sequence[Achieved]) -> dict[str, tuple[float, ...]]:
    """Quantiles of error over tolerance at `SHARES`, by tolerance and for all of them together."""
    by_rtol = list(zip(*(result.ratios for result in results), strict=True))
    groups = {f"{rtol:.0e}": ratios for rtol, ratios in zip(RTOLS, by_rtol, strict=True)}
    groups["all"] = tuple(ratio for ratios in by_rtol for ratio in ratios)
    return {name: tuple(_quantile(ratios, share) for share in SHARES) for name, ratios in groups.items()}


def _quantile(ratios: Sequence[float], share: float) -> float:
    """Least of the numbers that so large a share of them do not exceed; some may be infinite."""
    return sorted(ratios)[max(math.ceil(share * len(ratios)) - 1, 0)]


def page(results: Sequence[Achieved], day: date) -> str:
    """Write the report.

    Parameters
    ----------
    results : sequence of Achieved
    day : date
        When they were measured.

    Returns
    -------
    str
        Markdown; refers to the picture `PICTURE` in ``images``.
    """
    tolerances = " | ".join(f"{rtol:.0e}" for rtol in RTOLS)
    shares = " | ".join(f"{100 * share:g} %" for share in SHARES)
    lines = [
        "# Accuracy asked for and accuracy had",
        "",
        f"`python -m gearidae_bench --accuracy` on {day.isoformat()}, gearidae {gearidae.__version__}.",
        "",
        _INTRODUCTION,
        f"![Error of the run against the tolerance, and the distribution of their ratio](images/{PICTURE})",
        "",
        "## Error over tolerance",
        "",
        f"| `run.rtol` | {shares} of scenes below |",
        "|---|" + "---|" * len(SHARES),
        *(f"| {name} | {_numbers(ratios)} |" for name, ratios in quantiles(results).items()),
        "",
        _ADVICE,
        "## Error of each run",
        "",
        f"| case | turning points | reference | its error | {tolerances} |",
        "|---|---|---|---|" + "---|" * len(RTOLS),
        *(
            f"| {r.title} | {r.turning_points} | {r.reference} | {r.own_error:.0e} | {_numbers(r.errors)} |"
            for r in results
        ),
        "",
    ]
    return "\n".join(lines)


def _numbers(values: Sequence[float]) -> str:
    return " | ".join(f"{value:.2g}" for value in values)


def draw_accuracy(results: Sequence[Achieved], path: Path) -> None:
    """Draw errors against tolerances, and how their ratio is distributed.

    Parameters
    ----------
    results : sequence of Achieved
    path : Path
        PNG file to write.
    """
    figure = Figure(figsize=(9.0, 4.2), dpi=150, layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    _draw_errors(left, results)
    _draw_ratios(right, results)
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(visible=True, color="0.9", linewidth=0.6)
        axes.set_axisbelow(True)
    figure.savefig(path, metadata={"Software": None})


# Okabe and Ito's colours, by the beginning of the title
_KINDS: Final = {
    "low speed": ("#0072B2", "o"),
    "high speed": ("#D55E00", "s"),
    "run-up": ("#009E73", "^"),
    "braking": ("#CC79A7", "v"),
    "alternation": ("#E69F00", "D"),
}
_ROLLERS: Final = ("#56B4E9", "x")


def _draw_errors(axes: Axes, results: Sequence[Achieved]) -> None:
    seen: set[str] = set()
    for result in results:
        kind = result.title.partition(",")[0]
        colour, marker = _KINDS.get(kind, _ROLLERS)
        name = kind if kind in _KINDS else "rollers"
        label = "" if name in seen else name
        seen.add(name)
        axes.plot(
            RTOLS, result.errors, color=colour, marker=marker, markersize=3.5, linewidth=0.9, label=label
        )
    axes.plot(RTOLS, RTOLS, color="0.4", linestyle="--", linewidth=1.0, label="error = tolerance")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.invert_xaxis()
    axes.set_xlabel("tolerance asked for, run.rtol")
    axes.set_ylabel("largest error of the run, of scale")
    axes.legend(frameon=False, fontsize="small")


def _draw_ratios(axes: Axes, results: Sequence[Achieved]) -> None:
    ratios = np.array([ratio for result in results for ratio in result.ratios])
    ratios = np.sort(ratios[np.isfinite(ratios)])
    axes.step(ratios, (np.arange(ratios.size) + 1.0) / ratios.size, where="post", color="#0072B2")
    axes.set_xscale("log")
    axes.set_ylim(0.0, 1.0)
    axes.set_xlabel("error over tolerance")
    axes.set_ylabel("share of runs below")
