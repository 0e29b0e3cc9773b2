"""Where the force of a contact has a kink that the engine need not stop at, but a method of high order must.

A contact pressed together again after a partial stretch meets its virgin curve where the gap passes the joined height
of the last turning point: the asperities that were stretched are all compressed again, and the slope of the force
jumps (the return-point memory of the play operator). An implicit multistep method gains nothing from knowing the
place, since it goes on with the same history; a one-step method keeps its order by ending a step there.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearidae.engine.events.events import guard
from gearidae.engine.model import layout as at
from gearidae.engine.model.tooth_pairs import first_pair, history_slot, last_pair, material_stretch, pair_gap
from gearidae_bench.compiling import compiled

__all__ = ["arm", "watch"]

Floats = NDArray[np.float64]


@compiled()
def _gap(d: Floats, coast: int, pair: int, y: Floats) -> float:
    if d[at.KIND] == at.ROLLER:
        return float(y[at.U])
    gap, _, _, _ = pair_gap(d, coast, pair, y[at.U], y[at.V], y[at.PHASE], y[at.W])
    return gap


@compiled()
def _pairs(d: Floats, coast: int, y: Floats) -> tuple[int, int]:
    if d[at.KIND] == at.ROLLER:
        return 0, -coast
    return first_pair(d, coast, y[at.PHASE]), last_pair(d, coast, y[at.PHASE])


@compiled()
def arm(d: Floats, y: Floats, heights: Floats) -> bool:
    """Note which contacts are on their way back to the virgin curve.

    Parameters
    ----------
    d : ndarray
        The scene, see `gearidae.engine.model.layout`.
    y : ndarray, shape (n,)
        State at the start of a step.
    heights : ndarray, shape (2 * TOTAL_SLOTS,)
        Set to the joined height to be passed, per slot and material; minus infinity where there is none.

    Returns
    -------
    bool
        Whether there is any.
    """
    heights[:] = -np.inf
    found = False
    for coast in range(2):
        if d[at.NEAR + coast] == 0.0:
            continue
        first, last = _pairs(d, coast, y)
        for pair in range(first, last + 1):
            slot = history_slot(d, coast, pair)
            if d[slot + at.PAIR] != pair or d[slot + at.WAY] > 0.0:
                continue
            gap = _gap(d, coast, pair, y)
            for material in range(2):
                joined = d[slot + at.JOINED + material]
                if material_stretch(d, material) > 0.0 and joined < gap < d[at.CUTOFF]:
                    heights[2 * _number(d, slot) + material] = joined
                    found = True
    return found


@compiled()
def _number(d: Floats, slot: int) -> int:
    return (slot - int(d[at.HISTORIES])) // int(d[at.HISTORY])


@compiled()
def watch(d: Floats, t: float, y: Floats, heights: Floats, armed: bool) -> float:
    """Return the engine's guard, or the distance to an armed kink where that is smaller."""
    least = guard(d, t, y)
    if not armed:
        return least
    for coast in range(2):
        if d[at.NEAR + coast] == 0.0:
            continue
        first, last = _pairs(d, coast, y)
        for pair in range(first, last + 1):
            slot = history_slot(d, coast, pair)
            if d[slot + at.PAIR] != pair:
                continue
            gap = _gap(d, coast, pair, y)
            for material in range(2):
                least = min(least, gap - heights[2 * _number(d, slot) + material])
    return least
