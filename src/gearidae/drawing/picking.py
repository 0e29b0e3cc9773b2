"""Which runs of a large sweep a picture shows: those at which the outcome changes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

from gearidae.analysis.verdict.codes import STUCK


def pick(verdicts: Sequence[str], most: int) -> list[int]:
    """Pick the runs that tell most about a sweep.

    Parameters
    ----------
    verdicts : sequence of str
        Verdict of each run, in the order of the sweep.
    most : int
        Runs to pick at most, at least 2.

    Returns
    -------
    list of int
        Numbers of runs in increasing order: the first and the last; then both neighbours of each run where the gear
        begins to stick or to turn again; the first irregular run of each row of them; both neighbours of other changes;
        and if there is room, runs in the middle of the widest gaps.
    """
    if len(verdicts) <= most:
        return list(range(len(verdicts)))
    picked: set[int] = set()
    for number in _in_order_of_interest(verdicts):
        if len(picked) == most:
            break
        picked.add(number)
    while len(picked) < most:
        first, second = max(pairwise(sorted(picked)), key=lambda pair: pair[1] - pair[0])
        picked.add((first + second) // 2)
    return sorted(picked)


def _in_order_of_interest(verdicts: Sequence[str]) -> Iterator[int]:
    """Go through runs that should be seen, the most important first; some come twice."""
    yield from (0, len(verdicts) - 1)
    changes = [
        number for number, (verdict, following) in enumerate(pairwise(verdicts)) if verdict != following
    ]
    for number in changes:
        if (verdicts[number] in STUCK) != (verdicts[number + 1] in STUCK):
            yield from (number, number + 1)
    for number in changes:
        if verdicts[number + 1] == "irregular":
            yield number + 1
    for number in changes:
        yield from (number, number + 1)
