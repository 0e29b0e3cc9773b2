"""Tables of the result: run times at equal error, as rows for a terminal, Markdown or CSV."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Final

import numpy as np

from gearidae_bench.benchmark import Result
from gearidae_bench.error import time_at_error
from gearidae_bench.measure import Point

__all__ = [
    "ERRORS",
    "beyond_rows",
    "broken_off",
    "equal_error_rows",
    "markdown",
    "ratio_range",
    "write_points",
]

ERRORS: Final = tuple(10.0**-k for k in range(3, 9))
"""Relative errors at which contenders are compared."""
BASE: Final = "native"
RIVALS: Final = {
    "the same loop in C": ("c_loop",),
    "scikit-sundae IDA": ("ida",),
    "best of scipy": ("scipy_lsoda", "scipy_radau", "scipy_bdf", "scipy_dop853"),
    "compiled DOP853": ("dop853",),
    "compiled RK4": ("rk4",),
}
"""What the summary compares the native driver with."""


def _at_errors(points: Sequence[Point]) -> list[float]:
    errors, times = [p.error for p in points], [p.time for p in points]
    return [time_at_error(errors, times, wanted) for wanted in ERRORS]


def _series(result: Result, scene: str, contender: str) -> list[Point]:
    return [p for p in result.points if p.scene == scene and p.contender == contender]


def equal_error_rows(result: Result, scene: str) -> Iterator[tuple[str, list[float], list[float]]]:
    """Compare all contenders on a scene.

    Yields
    ------
    label : str
    times : list of float
        Run time [s] at each of `ERRORS`; NaN where that error was not reached.
    ratios : list of float
        The same over that of gearidae's native driver: above 1 is slower than it.
    """
    base = _at_errors(_series(result, scene, BASE))
    for key, label in result.labels.items():
        points = _series(result, scene, key)
        if points:
            times = _at_errors(points)
            yield label, times, [t / b for t, b in zip(times, base, strict=True)]


def ratio_range(result: Result, scene: str, rivals: Sequence[str]) -> tuple[float, float]:
    """How many times longer the best of some rivals takes than the native driver, over all of `ERRORS`.

    Parameters
    ----------
    result : Result
    scene : str
    rivals : sequence of str
        Keys of contenders; at each error the fastest of them counts.

    Returns
    -------
    least, greatest : float
        NaN where no rival reached an error that the native driver reached.
    """
    base = _at_errors(_series(result, scene, BASE))
    times = np.array([_at_errors(_series(result, scene, key)) for key in rivals])
    best = np.min(np.where(np.isnan(times), np.inf, times), axis=0, initial=np.inf)
    ratios = (best / base)[np.isfinite(best) & np.isfinite(base)]
    return (float(ratios.min()), float(ratios.max())) if ratios.size else (math.nan, math.nan)


def broken_off(result: Result, scene: str) -> list[str]:
    """Name the contenders whose runs of a scene broke off, each with the number of these runs and of all."""
    labels = []
    for key, label in result.labels.items():
        errors = [p.error for p in _series(result, scene, key)]
        if broken := sum(map(math.isinf, errors)):
            labels.append(f"{label} ({broken} of {len(errors)} runs)")
    return labels


def beyond_rows(result: Result) -> Iterator[tuple[str, str]]:
    """Measurements other than run time against error."""
    if result.growth:
        first = result.growth[0]
        for g in result.growth:
            times = g.simulated / first.simulated
            per_step, memory = 1e6 * g.time / g.steps, g.memory / 1e6
            yield (
                f"{g.simulated * 1e3:g} ms simulated ({times:g} times)",
                f"{g.time * 1e3:.1f} ms ({g.time / first.time:.2f} times), {per_step:.2f} us a step, {memory:.1f} MB",
            )
    for fraction, ratio in result.elastic.items():
        yield f"elastic contact, SAM fraction {fraction}", f"{ratio:.1f} times the asperity model's time"
    if not math.isnan(result.sweep_efficiency):
        yield "sweep of 8 runs on two cores", f"{100 * result.sweep_efficiency:.0f} % efficiency"
    if result.start is not None:
        s = result.start
        if not math.isnan(s.cold_run):
            yield (
                "first process (compiles)",
                f"{s.cold_import:.2f} s to import, {s.cold_run:.1f} s for a first short run",
            )
        yield (
            "every later process",
            f"{s.warm_import:.2f} s to import, {s.warm_run:.2f} s for a first short run",
        )


def write_points(result: Result, path: Path) -> None:
    """Write every measured point as CSV."""
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, [f.name for f in fields(Point)])
        writer.writeheader()
        writer.writerows(asdict(p) for p in result.points)


def markdown(result: Result) -> str:
    """Write the result as a Markdown fragment with a table for each scene."""
    lines = [
        f"Measured {result.date[:10]} on {result.machine};",
        ", ".join(f"{name} {number}" for name, number in result.versions.items()) + ".",
        f"Medians of up to {result.settings['rounds']:g} interleaved rounds, fewer for long runs;",
        f"a run longer than {result.settings['longest']:g} s ends the row of its contender.",
    ]
    lines += [""] if result.skipped else []
    lines += [f"- {result.labels[key]}: not measured ({reason})" for key, reason in result.skipped.items()]
    lines += [
        "",
        "Run time relative to the native driver at equal error, smallest to largest:",
        "",
    ]
    lines += [f"| | {' | '.join(RIVALS)} |", "|---|" + "---:|" * len(RIVALS)]
    for scene, title in result.scenes.items():
        ranges = [ratio_range(result, scene, keys) for keys in RIVALS.values()]
        lines.append(f"| {title} | {' | '.join(_range(*r) for r in ranges)} |")
    heading = " | ".join(f"1e{round(math.log10(e))}" for e in ERRORS)
    for scene, title in result.scenes.items():
        reference = result.references[scene]
        lines += [
            "",
            f"### {title[0].upper()}{title[1:]}",
            "",
            "Run time in ms at the error in the column heading; in brackets: relative to the native driver.",
            f"Error of the reference: {reference.own_error:.0e}.",
            "",
            f"| relative error | {heading} |",
            "|---|" + "---:|" * len(ERRORS),
        ]
        for label, times, ratios in equal_error_rows(result, scene):
            cells = [_cell(t, r) for t, r in zip(times, ratios, strict=True)]
            lines.append(f"| {label} | {' | '.join(cells)} |")
        if broken := broken_off(result, scene):
            lines += ["", f"Broke off, without a result: {', '.join(broken)}."]
        lines += ["", f"![Run time against error, {title}](images/work_precision_{scene}.png)"]
    rows = list(beyond_rows(result))
    if rows:
        lines += ["", "### Growth, sweep and start", "", "| | |", "|---|---|"]
        lines += [f"| {name} | {value} |" for name, value in rows]
    return "\n".join(lines) + "\n"


def _range(least: float, greatest: float) -> str:
    return "-" if math.isnan(least) else f"{least:.2g} to {greatest:.2g}"


def _cell(time: float, ratio: float) -> str:
    if math.isnan(time):
        return "-"
    return f"{time * 1e3:.3g}" + ("" if math.isnan(ratio) else f" ({ratio:.2g})")
