"""Pairs that pass the cut-off, of meshes with a law that loses energy there: the force of a film, for one, jumps there.

Passing it is an event. Within a step such a law acts on a pair throughout or not at all, as at the beginning, whatever
gap the step comes to: for force, loss and guard alike.
"""

from __future__ import annotations

import math

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.laws.pairs import LOSING_PAIRS
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.pairs.tooth_pairs import (
    flank_of_history,
    gap_and_rate,
    history_of,
    pair_at,
    pair_within,
    pairs_felt,
    was_within,
)
from gearidae.laws.pair_law import in_reach


@compiled(inline=True)
def watches_cutoff(m: Model) -> bool:
    """Whether a mesh has such a law."""
    return bool(m.scene.pair_laws & LOSING_PAIRS != 0)


@compiled_once(SOLVER)
def cutoff_guard(m: Model, y: Floats) -> float:
    """Least distance of a pair to the cut-off, on the side on which it was."""
    least, reach = math.inf, pairs_felt(m, y)
    for k in range(m.scene.histories):
        if m.work.within[k] != 0.0:
            least = min(least, m.scene.cutoff - _gap(m, k, y))
    for i in range(reach.total):
        flank, number = pair_at(reach, i)
        if not was_within(m, history_of(m, flank, number), number):
            least = min(least, gap_and_rate(m, flank, number, y)[0] - m.scene.cutoff)
    return least


@compiled_once(SOLVER)
def note_within(m: Model, y: Floats) -> bool:
    """Note which pairs are within the cut-off at a state; whether others were before."""
    changed, reach = False, pairs_felt(m, y)
    for k in range(m.scene.histories):
        if m.work.within[k] != 0.0 and not in_reach(m, _gap(m, k, y)):
            m.work.within[k], changed = 0.0, True
    for i in range(reach.total):
        flank, number = pair_at(reach, i)
        k = history_of(m, flank, number)
        if not was_within(m, k, number) and in_reach(m, gap_and_rate(m, flank, number, y)[0]):
            m.work.within[k], changed = number + 0.5, True
    return changed


@compiled_once(SOLVER)
def begin_within(m: Model, y: Floats) -> None:
    """Note which pairs are within the cut-off at a start, where pairs may be counted anew."""
    for k in range(m.scene.histories):
        m.work.within[k] = 0.0
    note_within(m, y)


@compiled(inline=True)
def _gap(m: Model, k: int, y: Floats) -> float:
    """Gap of the pair within the cut-off that has the k-th history."""
    return gap_and_rate(m, flank_of_history(m, k), pair_within(m, k), y)[0]
