"""What came out of an attack, as a page in Markdown."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from datetime import date

import numpy as np

import gearidae
from gearidae.engine.integrate.driver import Ending
from gearidae_bench.attack import Outcome

__all__ = ["balance_rows", "ending_rows", "page", "warned_rows"]

_MEANINGS = {ending.status: ending.message for ending in Ending} | {
    "finished": "reached the end",
    "budget": "stopped after the budget of steps or blocks, with progress reported until then",
    "refused": "a SceneError before the run, which names the key",
    "killed": "**a fault**: the process was killed by a signal",
    "silent": "**a fault**: no report of progress for as long as is waited",
    "raised": "**a fault**: an exception that is not for users",
}
_SCENES = (
    "Each key of a scene is free with a probability that is drawn for the scene, from 1 in 20 to always. A free key is"
    " drawn log-uniformly over its allowed range, and is a corner value (a limit, the number next to it, zero) with a"
    " probability of 0.2; the others stay within half a decade of a preset's. There are schedules with jumps and with"
    " 20,000 knots, up to eight harmonics, static errors, rollers, all asperity laws and contact models, both drivers,"
    " and tolerances from 1e-12 to 0.1. Each scene has a process of its own and 8 GiB of memory."
)
_BALANCE = (
    "Scenes that ended without a fault are run again up to their third turning point (or stick or slip), at their"
    " tolerance and at a hundredth of it. Where both motions agree to ten tolerances, the residual of the energy"
    " balance at that instant, over its bound, is:"
)
_SHARES = (0.5, 0.9, 0.97, 0.99, 1.0)
_LISTED = 40


def ending_rows(outcomes: Sequence[Outcome]) -> list[tuple[str, int, str]]:
    """How many scenes ended in which way, the most frequent first, with its meaning."""
    counts = Counter(outcome.status for outcome in outcomes)
    return [(status, count, _MEANINGS.get(status, "")) for status, count in counts.most_common()]


def balance_rows(outcomes: Sequence[Outcome]) -> list[tuple[str, str]]:
    """Quantiles of residual over bound where the motion agrees with the finer one, and the share warned of."""
    agreeing = [o for o in outcomes if o.agrees and not math.isnan(o.balance)]
    if not agreeing:
        return []
    ratios = [o.balance for o in agreeing]
    rows = [
        (f"{100 * share:g} % of {len(ratios)}", f"{np.quantile(ratios, share, method='higher'):.2g}")
        for share in _SHARES
    ]
    return [*rows, ("warned of", f"{100 * sum(o.warned for o in agreeing) / len(agreeing):.2g} %")]


def warned_rows(outcomes: Sequence[Outcome]) -> list[str]:
    """Name the scenes whose energy balance is warned of although the motion agrees, the worst first."""
    warned = sorted((o for o in outcomes if o.agrees and o.warned), key=lambda o: -o.balance)
    if not warned:
        return []
    rows = [f"| {o.number} | {o.backend} | {o.rtol:.1g} | {o.balance:.2g} |" for o in warned[:_LISTED]]
    return ["| warned of | driver | rtol | residual over bound |", "|---|---|---|---|", *rows, ""]


def page(
    outcomes: Sequence[Outcome],
    seed: int,
    day: date,
    runs: int | None = None,
    *,
    kind: str = "",
) -> str:
    """Write the report.

    Parameters
    ----------
    outcomes : sequence of Outcome
    seed : int
    day : date
        When they were run.
    runs : int, optional
        Number of scenes requested, if fewer were done.
    kind : {"", "population", "friction"}, optional
        Whether the scenes have real asperities, or friction.

    Returns
    -------
    str
        Markdown.
    """
    faults = [outcome for outcome in outcomes if not outcome.sound]
    drawn = f"extreme_{kind or 'scene'}"
    command = f"python -m gearidae_bench --attack{f' --{kind}' * bool(kind)}"
    command += f" --runs {runs or len(outcomes)} --seed {seed}"
    done = f"; interrupted after {len(outcomes)} scenes" if runs and runs > len(outcomes) else ""
    silence = max((o.longest for o in outcomes), default=0.0)
    lines = [
        "# Attack",
        "",
        f"`{command}` on {day.isoformat()}, gearidae {gearidae.__version__}{done}.",
        "",
        _SCENES,
        "",
        f"**Faults: {len(faults)}.** Longest time without a report {silence:.1f} s.",
        "",
        "| ending | scenes | meaning |",
        "|---|---|---|",
        *(f"| {status} | {count} | {meaning} |" for status, count, meaning in ending_rows(outcomes)),
        "",
        "## Energy balance",
        "",
        _BALANCE,
        "",
        "| share of scenes | residual over bound at most |",
        "|---|---|",
        *(f"| {share} | {ratio} |" for share, ratio in balance_rows(outcomes)),
        "",
        *warned_rows(outcomes),
        "## Faults",
        "",
        "| scene | driver | ending | where |",
        "|---|---|---|---|",
        *(f"| {o.number} | {o.backend} | {o.status} | {_cell(o.message)} |" for o in faults[:_LISTED]),
        "",
        f"`gearidae_bench.extreme_scenes.{drawn}({seed}, scene)` makes any of them again.",
        "",
    ]
    return "\n".join(lines)


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")[:300]
