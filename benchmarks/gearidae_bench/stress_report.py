"""What came out of a stress run, as a page in Markdown."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from datetime import date

import numpy as np

import gearidae
from gearidae.records import Ending
from gearidae_bench.stress import ELASTIC_SHARE, LEDGER_TOLERANCES, STEP_BUDGET, Outcome

__all__ = ["counts", "ledger_quantiles", "page", "quantiles", "worst"]

_MEANINGS = {ending.status: ending.message for ending in Ending} | {
    "finished": "reached the end",
    "budget": f"stopped after {STEP_BUDGET:,} steps"
    f" ({STEP_BUDGET // ELASTIC_SHARE:,} with elastic bodies), all in order until then",
    "refused": "a SceneError before the run",
    "raised": "**a defect**: an error that is not for users",
    "hung": "**a defect**: never came back",
}
_RANGES = (
    "Roughness 1 to 30 nm, tip radius 20 nm to 5 um, 1e12 to 1e15 asperities per square metre, surface energy 0 to"
    " 3 J/m2, modulus 50 to 400 GPa, SAM fraction 0 to 1, all three asperity laws, torques over twelve decades or none,"
    " 12 to 120 teeth, backlash 0 to 1 um, speeds up to 1e4 rad/s either way, tolerances 1e-3 to 1e-10, dry resistance,"
    " drag, mesh damping, harmonics, schedules and static error in some, rollers in one of seven. Bodies give way in"
    " each fifth scene, with moduli from 2 GPa on; the others are by the asperity model."
)
_CHECKS = (
    "Of each, 24 samples are checked: gaps as the geometry has them; forces, where bodies do not give way, between"
    " those of a contact just made and of one stretched to its limit, both by quadrature. All numbers must be finite"
    " and all events in order, and the energy ledger of a finished run must close to"
    f" {LEDGER_TOLERANCES:,.0f} tolerances."
)
_ERRORS = (
    "The motion up to its third turning point (or stick or slip) at the scene's tolerance against that at a tenth of"
    " it, over what the motion covers; an error in time counts by its share of the time."
)
_REASON = (
    "Large ratios belong to scenes whose adhesion is 1e8 and more times the load: the contact falls into a well that"
    " deep and comes out by a small difference of large energies, which multiplies every error."
)
_LEDGER = (
    "The energy ledger of a run books every work, loss and store. What it leaves unexplained at the end of finished"
    " runs, over the energy that has moved and the largest energy of motion there was, in tolerances:"
)
_FURTHER = (
    "What errors the shipped cases have is on [a page of its own](accuracy.md), and so is which faults put into the"
    " code [the tests catch](mutants.md)."
)
_SHARES = (0.1, 0.5, 0.9, 0.97, 0.99, 1.0)
_LISTED = 10
_NAMED = 7
"""Scenes of one ending that are given by their numbers."""


def counts(outcomes: Sequence[Outcome]) -> dict[str, int]:
    """How many ended in which way, the most frequent first."""
    return dict(Counter(outcome.status for outcome in outcomes).most_common())


def _scenes(outcomes: Sequence[Outcome], status: str, count: int) -> str:
    """How many scenes ended so; which, if they are few."""
    if count > _NAMED:
        return str(count)
    return f"{count}: " + ", ".join(str(o.number) for o in outcomes if o.status == status)


def quantiles(outcomes: Sequence[Outcome]) -> dict[float, float]:
    """Quantiles of error over tolerance; empty if nothing could be compared."""
    return _quantiles([outcome.ratio for outcome in outcomes])


def ledger_quantiles(outcomes: Sequence[Outcome]) -> dict[float, float]:
    """Quantiles of the ledger's imbalance over tolerance, of finished runs; empty if there are none."""
    return _quantiles([o.imbalance / o.rtol for o in outcomes if o.status == "finished"])


def _quantiles(values: Sequence[float]) -> dict[float, float]:
    finite = [value for value in values if math.isfinite(value)]
    return {share: float(np.quantile(finite, share)) for share in _SHARES} if finite else {}


def worst(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """Unsound outcomes first, then those of the largest error over tolerance."""
    known = [o for o in outcomes if not o.sound or math.isfinite(o.ratio)]
    return sorted(known, key=lambda o: (o.sound, -o.ratio if math.isfinite(o.ratio) else 0.0))[:_LISTED]


def page(outcomes: Sequence[Outcome], seed: int, day: date, runs: int | None = None) -> str:
    """Write the report.

    Parameters
    ----------
    outcomes : sequence of Outcome
    seed : int
    day : date
        When they were run.
    runs : int, optional
        How many were asked for, where not all of them were done.

    Returns
    -------
    str
        Markdown.
    """
    unsound = [outcome for outcome in outcomes if not outcome.sound]
    times = [outcome.wall_time for outcome in outcomes]
    command = f"python -m gearidae_bench --stress --runs {runs or len(outcomes)} --seed {seed}"
    done = f"; interrupted after {len(outcomes)} scenes" if runs and runs > len(outcomes) else ""
    lines = [
        "# Stress run",
        "",
        f"`{command}` on {day.isoformat()}, gearidae {gearidae.__version__}{done}.",
        "",
        _RANGES,
        "",
        _CHECKS,
        "",
        f"**Unsound: {len(unsound)}.** Longest wall time {max(times, default=0.0):.1f} s, three runs each.",
        "",
        "| ending | scenes | meaning |",
        "|---|---|---|",
        *(
            f"| {status} | {_scenes(outcomes, status, n)} | {_MEANINGS.get(status, '')} |"
            for status, n in counts(outcomes).items()
        ),
        "",
        "## Error against tolerance",
        "",
        _ERRORS,
        "",
        "| share of scenes | error below so many tolerances |",
        "|---|---|",
        *(f"| {100 * share:g} % | {ratio:.2g} |" for share, ratio in quantiles(outcomes).items()),
        "",
        "## Energy against tolerance",
        "",
        _LEDGER,
        "",
        "| share of finished scenes | imbalance below so many tolerances |",
        "|---|---|",
        *(f"| {100 * share:g} % | {ratio:.2g} |" for share, ratio in ledger_quantiles(outcomes).items()),
        "",
        "## The worst",
        "",
        _REASON,
        "",
        "| scene | ending | tolerance | error | imbalance | complaint |",
        "|---|---|---|---|---|---|",
        *map(_row, worst(outcomes)),
        "",
        f"`gearidae_bench.random_scenes.random_scene({seed}, scene)` makes any of them again.",
        "",
        _FURTHER,
        "",
    ]
    return "\n".join(lines)


def _row(o: Outcome) -> str:
    numbers = f"{o.rtol:.1e} | {o.error:.1e} | {o.imbalance:.1e}"
    return f"| {o.number} | {o.status} | {numbers} | {o.complaint or o.message} |"
