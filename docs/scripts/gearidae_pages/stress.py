"""The page of random scenes, run and checked by what the tests have for that.

PYTHONPATH=tests:docs/scripts python -m gearidae_pages.stress [--runs 2000] [--seed 1]
"""

from __future__ import annotations

import argparse
import math
import os
import sys
from collections import Counter
from collections.abc import Sequence
from datetime import UTC, date, datetime
from functools import partial
from pathlib import Path

import numpy as np

import gearidae
from gearidae.records import Ending
from gearidae.runs.executors import own_executor
from reference.random_runs import BALANCE_TOLERANCES, ELASTIC_SHARE, STEP_BUDGET, Outcome, draw_and_run
from reference.random_scenes import SCENES_PER_SURFACE

__all__ = ["page"]

_PAGE = Path(__file__).parents[2] / "stress.md"

_MEANINGS = {ending.status: ending.message for ending in Ending} | {
    "finished": "reached the end of the run",
    "budget": f"stopped after at least {STEP_BUDGET:,} steps"
    f" ({STEP_BUDGET // ELASTIC_SHARE:,} with elastic bodies), correct until then",
    "refused": "rejected by a SceneError before the run",
    "raised": "**a defect**: an exception other than those for users",
}
_PURPOSE = (
    "After this page you know over which range of scenes the engine was tested, how the runs ended, and how large their"
    " errors were. The scenes are random; each is run three times, and its samples are compared with the physics."
)
_RANGES = (
    "**Ranges.** Roughness 1 to 30 nm, tip radius 20 nm to 5 um, 1e12 to 1e15 asperities per square metre, surface"
    " energy 0 to 3 J/m2, modulus 50 to 400 GPa, SAM fraction 0 to 1, JKR, DMT or Hertz asperities; torques over twelve"
    " decades or none, 12 to 120 teeth, backlash 0 to 1 um, speeds up to 1e4 rad/s in either direction; tolerances 1e-3"
    " to 1e-10. Some scenes have dry resistance, drag, mesh damping, harmonics, schedules and static transmission"
    " error. One scene in seven is a roller. One scene in five has elastic bodies, with moduli from 2 GPa; the others"
    " use the asperity model. Half of the scenes also have some of these: Maugis asperities with an interaction range"
    " from 17 pm to 5 nm, a monolayer as thick as 0 to 3 roughnesses, sides that are paired independently, coverage by"
    " tooth and up to 64 places, exposures, a drive that holds a constant or scheduled speed with a gain over six"
    " decades, viscous drag, cubic schedules of up to 60 knots, and conditions to stop."
)
_CHECKS = (
    "**Checks.** 24 samples of each run are checked. Gaps must agree with the geometry. Without elastic bodies, forces"
    " must lie between those of a contact that has just formed and of one stretched to its limit, both from quadrature."
    " All numbers must be finite and all events in order of time. The energy balance of a finished run must close to"
    f" {BALANCE_TOLERANCES:,.0f} tolerances. Where exposures are kept, the adhesion work of all places must be the"
    " adhesion loss of the energy balance, to 1e-6 or the run's tolerance, and to 1 % with elastic bodies."
)
_ERRORS = (
    "The motion up to its third turning point (or stick or slip) is compared with that at a tenth of the tolerance. The"
    " difference is divided by the range of the motion; an error of an event time is divided by the elapsed time."
)
_REASON = (
    "Nearly all large ratios belong to scenes whose adhesion is 1e4 to 1e11 times the load. The contact falls into a"
    " deep potential well and leaves it by a small difference of large energies, which amplifies every error. The"
    " others have elastic bodies, whose errors may be some hundreds of tolerances, or a fast harmonic that shakes free"
    " gears for ten thousand periods and more, whose errors add up."
)
_ENERGY_BALANCE = (
    "The energy balance of a run sums all works, losses and stored energies. The table gives its imbalance at the end"
    " of finished runs, divided by the sum of the energy exchanged and the largest kinetic energy, in tolerances:"
)
_FURTHER = (
    "The errors of the shipped cases are on [another page](accuracy.md), and so are the"
    " [faults that the tests catch](mutants.md)."
)
_SHARES = (0.1, 0.5, 0.9, 0.97, 0.99, 1.0)
_LISTED = 10
_NAMED = 7
"""Scenes of one ending that are given by their numbers."""


def counts(outcomes: Sequence[Outcome]) -> dict[str, int]:
    """Number of scenes per ending, the most frequent first."""
    return dict(Counter(outcome.status for outcome in outcomes).most_common())


def _scenes(outcomes: Sequence[Outcome], status: str, count: int) -> str:
    """Number of scenes with this ending, and their numbers if they are few."""
    if count > _NAMED:
        return str(count)
    return f"{count}: " + ", ".join(str(o.number) for o in outcomes if o.status == status)


def quantiles(outcomes: Sequence[Outcome]) -> dict[float, float]:
    """Quantiles of error over tolerance; empty if nothing could be compared."""
    return _quantiles([outcome.ratio for outcome in outcomes])


def balance_quantiles(outcomes: Sequence[Outcome]) -> dict[float, float]:
    """Quantiles of the energy balance's imbalance over tolerance, of finished runs; empty if there are none."""
    return _quantiles([o.imbalance / o.rtol for o in outcomes if o.status == "finished"])


def _quantiles(values: Sequence[float]) -> dict[float, float]:
    finite = [value for value in values if math.isfinite(value)]
    return {share: float(np.quantile(finite, share)) for share in _SHARES} if finite else {}


def worst(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """Outcomes that failed a check first, then those of the largest error over tolerance."""
    known = [o for o in outcomes if not o.sound or math.isfinite(o.ratio)]
    return sorted(known, key=lambda o: (o.sound, -o.ratio if math.isfinite(o.ratio) else 0.0))[:_LISTED]


def page(outcomes: Sequence[Outcome], seed: int, day: date) -> str:
    """Write the report in Markdown, of scenes of a seed that were run on a day."""
    unsound = [outcome for outcome in outcomes if not outcome.sound]
    longest = max((outcome.wall_time for outcome in outcomes), default=0.0)
    command = (
        f"PYTHONPATH=tests:docs/scripts python -m gearidae_pages.stress --runs {len(outcomes)} --seed {seed}"
    )
    lines = [
        "# Stress run",
        "",
        f"`{command}` on {day.isoformat()}, gearidae {gearidae.__version__}.",
        "",
        _PURPOSE,
        "",
        _RANGES,
        "",
        _CHECKS,
        "",
        f"**Failed checks: {len(unsound)}.** Longest wall time of a scene (three runs): {longest:.1f} s.",
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
        "| share of scenes | error below, in tolerances |",
        "|---|---|",
        *(f"| {100 * share:g} % | {ratio:.2g} |" for share, ratio in quantiles(outcomes).items()),
        "",
        "## Energy against tolerance",
        "",
        _ENERGY_BALANCE,
        "",
        "| share of finished scenes | imbalance below, in tolerances |",
        "|---|---|",
        *(f"| {100 * share:g} % | {ratio:.2g} |" for share, ratio in balance_quantiles(outcomes).items()),
        "",
        "## Largest ratios",
        "",
        _REASON,
        "",
        "| scene | ending | tolerance | error | imbalance | message |",
        "|---|---|---|---|---|---|",
        *map(_row, worst(outcomes)),
        "",
        f"`wide_scene({seed}, scene)` in `tests/reference/random_scenes.py` generates any of these scenes again.",
        "",
        _FURTHER,
        "",
    ]
    return "\n".join(lines)


def _row(o: Outcome) -> str:
    numbers = f"{o.rtol:.1e} | {o.error:.1e} | {o.imbalance:.1e}"
    return f"| {o.number} | {o.status} | {numbers} | {o.complaint or o.message} |"


def _run(seed: int, group: range) -> list[Outcome]:
    return [draw_and_run(seed, number) for number in group]


def main() -> None:
    """Run scenes in a process per core, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--runs", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    asked, outcomes = parser.parse_args(), []
    # scenes that share a surface stay together: its force law takes longer than most of the runs
    groups = [
        range(k, min(k + SCENES_PER_SURFACE, asked.runs)) for k in range(0, asked.runs, SCENES_PER_SURFACE)
    ]
    with own_executor(os.cpu_count() or 1, len(groups), releases_gil=False) as executor:
        work = partial(_run, asked.seed)
        for some in map(work, groups) if executor is None else executor.map(work, groups):
            outcomes += some
            sys.stderr.write(f"\r{len(outcomes)} scenes")
    _PAGE.write_text(page(outcomes, asked.seed, datetime.now(UTC).date()))


if __name__ == "__main__":
    main()
