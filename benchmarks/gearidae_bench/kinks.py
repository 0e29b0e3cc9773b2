"""Where the force of a contact has a kink that the engine need not stop at, but a method of high order must.

A contact pressed together again after a partial stretch meets its virgin curve where the gap passes the joined height
of the last turning point: the asperities that were stretched are all compressed again, and the slope of the force
jumps (the return-point memory of the play operator). An implicit multistep method gains nothing from knowing the
place, since it goes on with the same history; a one-step method keeps its order by ending a step there.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearidae.engine.events.asperity_events import first_grazing_minimum, note_step_start
from gearidae.engine.events.events import guard
from gearidae.engine.model.state import MATERIALS, Model
from gearidae.engine.pairs.tooth_pairs import gap_and_rate, history_of, pair_at, pairs_near
from gearidae_bench.compiling import compiled

__all__ = ["arm", "begin_step", "dip_in_step", "watch"]

Floats = NDArray[np.float64]


@compiled()
def arm(m: Model, y: Floats, heights: Floats) -> bool:
    """Note which contacts are on their way back to the virgin curve.

    Parameters
    ----------
    m : Model
        The scene, see `gearidae.engine.model.state`.
    y : ndarray, shape (n,)
        State at the start of a step.
    heights : ndarray, shape (MATERIALS * histories,)
        Set to the joined height to be passed, per history and material; minus infinity where there is none.

    Returns
    -------
    bool
        Whether there is any.
    """
    heights[:] = -np.inf
    armed = False
    reach = pairs_near(m, y)
    for i in range(reach.total):
        flank, pair = pair_at(reach, i)
        k = history_of(m, flank, pair)
        h = m.state.history[k]
        if h.pair != pair or h.direction > 0.0:
            continue
        gap, _ = gap_and_rate(m, flank, pair, y)
        for material in range(MATERIALS):
            joined = h.joined[material]
            if m.scene.material[material].stretch_limit > 0.0 and joined < gap < m.scene.cutoff:
                heights[MATERIALS * k + material] = joined
                armed = True
    return armed


@compiled()
def watch(m: Model, t: float, y: Floats, heights: Floats, armed: bool) -> float:
    """Return the engine's guard, or the distance to an armed kink where that is smaller."""
    least = guard(m, t, y)
    if not armed:
        return least
    reach = pairs_near(m, y)
    for i in range(reach.total):
        flank, pair = pair_at(reach, i)
        k = history_of(m, flank, pair)
        if m.state.history[k].pair != pair:
            continue
        gap, _ = gap_and_rate(m, flank, pair, y)
        for material in range(MATERIALS):
            least = min(least, gap - heights[MATERIALS * k + material])
    return least


@compiled()
def begin_step(m: Model, t: float, y: Floats, heights: Floats, armed: bool) -> float:
    """Do as `watch` at the start of a step, from where asperities may dip below their guards and come back."""
    least = watch(m, t, y, heights, armed)
    if m.scene.population.flanks != 0:
        note_step_start(m, y)
    return least


@compiled()
def dip_in_step(m: Model, new: Floats, h: float, before: float, after: float) -> float:
    """Share of a step at which an asperity dips below its guard, which is above zero at both ends; -1 if none does."""
    if m.scene.population.flanks == 0 or before <= 0.0 or after <= 0.0:
        return -1.0
    return first_grazing_minimum(m, new, h)
