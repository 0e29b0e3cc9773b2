"""Tables of the start-ups and brakings, for the page."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from gearidae_bench.error import time_at_error
from gearidae_bench.start_stop import NUDGED_RTOL, NUDGES, QUANTITIES, Reached, StartStop, Timed

__all__ = ["TARGETS", "relative_error", "series_errors", "start_stop_page"]

TARGETS: Final = {
    "angle to 1e-6": ("angle", 1e-6),
    "angle to 1e-8": ("angle", 1e-8),
    "rest to 1e-3": ("rest", 1e-3),
    "adhesion loss to 1e-3": ("loss", 1e-3),
}
"""Columns of the first table: a quantity and its relative error."""
_RTOLS: Final = (1e-4, 1e-5, 1e-6, 1e-7)
_EQUAL: Final = 1e-6
_TIGHT: Final = 1e-8


def relative_error(reached: Reached, reference: Reached, quantity: str) -> float:
    """Error of a quantity over its reference; infinite for a run that broke off, or did not follow it."""
    value, exact = getattr(reached, quantity), getattr(reference, quantity)
    error = abs(value - exact) / abs(exact) if exact else math.inf
    return error if math.isfinite(error) else math.inf


def series_errors(entries: Sequence[Timed], reference: Reached, quantity: str) -> list[float]:
    """Errors of a contender's runs, from loose to tight: each is at least those of all tighter ones.

    A loose run that comes near the reference by chance does not count as accurate.
    """
    errors = [relative_error(entry.reached, reference, quantity) for entry in entries]
    return [float(error) for error in np.maximum.accumulate(errors[::-1])[::-1]]


def _time(result: StartStop, scene: str, contender: str, quantity: str, wanted: float) -> float:
    """Processor time [s] of a contender at an error; NaN if it does not get there."""
    entries = [e for e in result.timed if (e.scene, e.contender) == (scene, contender)]
    if not entries:
        return math.nan
    errors = series_errors(entries, result.references[scene]["auto"], quantity)
    return time_at_error(errors, [entry.time for entry in entries], wanted)


def _own_error(result: StartStop, scene: str, quantity: str) -> float:
    both = result.references[scene]
    return relative_error(both["bdf"], both["auto"], quantity)


def _ratio_cell(result: StartStop, scene: str, quantity: str, wanted: float) -> str:
    if not _own_error(result, scene, quantity) < 0.5 * wanted:
        return "no reference"
    suffix = " with loss" if quantity == "loss" else ""
    peers = {name: _time(result, scene, name + suffix, quantity, wanted) for name in ("DOP853", "RK4")}
    reaching = {name: seconds for name, seconds in peers.items() if not math.isnan(seconds)}
    ours = _time(result, scene, "auto", quantity, wanted)
    if math.isnan(ours):
        return "not reached" if reaching else "nobody gets there"
    if not reaching:
        return "no peer gets there"
    best = min(reaching, key=lambda name: reaching[name])
    ratios = [ours / reaching[best]]
    if quantity != "loss":
        ratios.append(_time(result, scene, "auto alone", quantity, wanted) / reaching[best])
    return " / ".join(f"{ratio:.2f}" for ratio in ratios) + f" ({best})"


def _table(heading: Sequence[str], rows: Iterator[Sequence[str]]) -> str:
    lines = [heading, ("---",) * len(heading), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _ratio_rows(result: StartStop) -> Iterator[Sequence[str]]:
    for scene in result.references:
        yield scene, *(_ratio_cell(result, scene, *target) for target in TARGETS.values())


def _entry(result: StartStop, scene: str, contender: str, tolerance: float) -> Timed | None:
    for entry in result.timed:
        same = (entry.scene, entry.contender) == (scene, contender)
        if same and math.isclose(entry.tolerance, tolerance, rel_tol=1e-9):
            return entry
    return None


def _method_rows(result: StartStop) -> Iterator[Sequence[str]]:
    """Both methods at one tolerance, and at one error."""
    for scene, both in result.references.items():
        entries = [_entry(result, scene, f"{method} alone", _EQUAL) for method in ("auto", "bdf")]
        if entries[0] is None or entries[1] is None:
            continue
        auto, bdf = entries[0], entries[1]
        tight = _entry(result, scene, "auto alone", _TIGHT)
        errors = [f"{relative_error(e.reached, both['auto'], 'angle'):.1e}" for e in (auto, bdf)]
        times = [_time(result, scene, f"{method} alone", "angle", _EQUAL) for method in ("bdf", "auto")]
        yield (
            scene,
            *errors,
            f"{bdf.time / auto.time:.2f}",
            "-" if math.isnan(times[0] / times[1]) else f"{times[0] / times[1]:.2f}",
            f"{both['auto'].steps / tight.reached.steps:.1f}" if tight else "-",
        )


def _rtol_rows(result: StartStop) -> Iterator[Sequence[str]]:
    for scene, both in result.references.items():
        for quantity in QUANTITIES:
            entries = [_entry(result, scene, "auto", rtol) for rtol in _RTOLS]
            errors = [relative_error(e.reached, both["auto"], quantity) if e else math.nan for e in entries]
            error_of_reference = _own_error(result, scene, quantity)
            yield scene, quantity, *(f"{error:.1e}" for error in errors), f"{error_of_reference:.0e}"


def _loss_rows(result: StartStop) -> Iterator[Sequence[str]]:
    for scene, losses in result.losses.items():
        spread = (max(losses) - min(losses)) / abs(sum(losses) / len(losses))
        yield scene, f"{spread:.1e}"


_RATIOS: Final = """\
Processor time of the native driver over that of the best peer at equal error: as users run it / without balance,
extremes and passages. Below 1 gearidae is faster. The best peer is in brackets.
"""
_METHODS: Final = """
Both methods, without balance, extremes and passages: error of the angle at `rtol = 1e-6`, time of `bdf` over that of
`auto` at that rtol and at an error of 1e-6, and steps of `auto` at `rtol = 1e-12` over those at 1e-8.
"""
_ERRORS: Final = """
Relative errors of `auto`. The last column says how far both methods at `rtol = 1e-12` are apart.
"""
_PHASES: Final = f"""
Range of the adhesion loss over its mean, of {len(NUDGES)} runs at `rtol = {NUDGED_RTOL:.0e}` whose mesh phases differ
by 1e-14 pitches each:
"""


def start_stop_page(result: StartStop) -> str:
    """Write all tables in Markdown."""
    methods = (
        "error, `auto`",
        "error, `bdf`",
        "time at equal rtol",
        "at equal error",
        "steps, 1e-12 over 1e-8",
    )
    rtols = [f"rtol {rtol:.0e}".replace("e-0", "e-") for rtol in _RTOLS]
    parts = [
        (_RATIOS, _table(("", *TARGETS), _ratio_rows(result))),
        (_METHODS, _table(("", *methods), _method_rows(result))),
        (_ERRORS, _table(("", "of", *rtols, "reference"), _rtol_rows(result))),
        (_PHASES, _table(("", "range of the loss"), _loss_rows(result))),
    ]
    tables = "".join(f"{words}\n{table}" for words, table in parts)
    return f"Measured on {result.date[:10]}.\n\n{tables}"
