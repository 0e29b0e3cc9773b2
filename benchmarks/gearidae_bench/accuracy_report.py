"""Results of the accuracy measurement, as a page in Markdown and a picture."""

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
After this page you can choose `run.rtol` for the error that you need. The tables give the error of every shipped case
in three states of the coating (full coverage, 60 % coverage, bare silicon) at seven tolerances.

The tolerance bounds the local error of a single step: relative to the roughness for lengths, and to the roughness per
time unit for speeds. The tables show the global error of the run, the difference from a reference solution. It is the
larger of two numbers: the largest error of the speed of the gear (or roller) over its peak-to-peak fluctuation, and the
largest error of the transmission error (or height) over the roughness. Local errors add up, and every impact amplifies
the accumulated error.

**References.** The reference is Gauss-Legendre collocation of order twelve at a tolerance of 1e-12, with a step
boundary at every event, every kink of the force, every schedule knot and every sample. Method, error control and event
detection are independent of the engine. Its own error, given in the table, is its difference from a run at a tenth of
the tolerance. With elastic bodies the equations are partly algebraic, and the reference is a run of the engine itself
at 1e-12, compared with one at 1e-11. This comparison shows how the error falls with the tolerance. It does not show
that the limit is correct; the tests of the elastic contact do.

**Cases.** The low-speed case is run for 20 ms and the high-speed case for 0.5 ms. Run-up, braking and alternating
torque are run for a hundredth of their duration. Their torque schedules are faster by the same factor, so that the
gears still break away, stop and change their speed. Rollers are run with rigid and elastic bodies. In the names of the
cases, "whole" means full coverage, "worn" 60 % coverage and "bare" no coverage.
"""
_ADVICE = """\
## Which tolerance to choose

The median error of a run is some tens of tolerances, and some hundreds with elastic bodies. It falls in proportion to
the tolerance. With the default of 1e-6, the error of most of these runs is below 1e-4 of the fluctuation.

Two kinds of run need a tolerance below 1e-3. Gears braked to a stop continue to bounce
between their teeth with hardly any damping, and every bounce amplifies the error of the one before. Bare silicon at
low speed falls into its adhesive potential well and vibrates there, with about a hundred thousand turning points in
these 20 ms. In such a run the amplitude of the vibration is reliable, but its phase at a given time is not. If the
phase matters, use 1e-9 and compare two tolerances.
"""


def quantiles(results: Sequence[Achieved]) -> dict[str, tuple[float, ...]]:
    """Quantiles of error over tolerance at `SHARES`, by tolerance and for all of them together."""
    by_rtol = list(zip(*(result.ratios for result in results), strict=True))
    groups = {f"{rtol:.0e}": ratios for rtol, ratios in zip(RTOLS, by_rtol, strict=True)}
    groups["all"] = tuple(ratio for ratios in by_rtol for ratio in ratios)
    return {name: tuple(_quantile(ratios, share) for share in SHARES) for name, ratios in groups.items()}


def _quantile(ratios: Sequence[float], share: float) -> float:
    """Smallest number that this share of the numbers does not exceed; some may be infinite."""
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
        "# Requested and achieved accuracy",
        "",
        _INTRODUCTION,
        f"Measured by `python -m gearidae_bench --accuracy` on {day.isoformat()}, gearidae {gearidae.__version__}.",
        "",
        f"![Error of the run against the tolerance, and distribution of their ratio](images/{PICTURE})",
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
        f"| case | turning points | reference | error of the reference | {tolerances} |",
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
    """Draw errors against tolerances, and the distribution of their ratio.

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
    axes.set_xlabel("requested tolerance, run.rtol")
    axes.set_ylabel("largest error of the run, relative")
    axes.legend(frameon=False, fontsize="small")


def _draw_ratios(axes: Axes, results: Sequence[Achieved]) -> None:
    ratios = np.array([ratio for result in results for ratio in result.ratios])
    ratios = np.sort(ratios[np.isfinite(ratios)])
    axes.step(ratios, (np.arange(ratios.size) + 1.0) / ratios.size, where="post", color="#0072B2")
    axes.set_xscale("log")
    axes.set_ylim(0.0, 1.0)
    axes.set_xlabel("error over tolerance")
    axes.set_ylabel("share of runs below")
