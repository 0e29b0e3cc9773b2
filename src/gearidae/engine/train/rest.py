"""Shafts that slip and shafts that are held: each by itself, as the loads of hubs follow from the state alone.

The direction in which a shaft slips is stored, and changes at events only: a sign of the speed would change within a
step. A shaft that comes to rest is held if hub, pin and dry resistance can hold what acts on it; else it goes on, or
back, in the direction of that.
"""

from __future__ import annotations

import math

from gearidae.arrays import Floats
from gearidae.compiled import compiled
from gearidae.engine.train.layout import TrainModel, TrainOutput
from gearidae.engine.train.motion import motion
from gearidae.engine.train.record import record_at_shaft
from gearidae.records import EventKind

_STICK, _SLIP = float(EventKind.STICK), float(EventKind.SLIP)
_REVERSAL = float(EventKind.SLIDING_REVERSAL)


@compiled
def any_held(tm: TrainModel) -> bool:
    """Whether a shaft is held, or a tooth pair rolls."""
    held = tm.train[0].elements
    for i in range(len(tm.shafts)):
        held += tm.shafts[i].rubs != 0 and tm.shafts[i].slip == 0.0
    return held > 0


@compiled
def rest_guard(tm: TrainModel, y: Floats) -> float:
    """Least of the guards of all shafts: the speed in the direction of slip, or what a held one can hold besides.

    Of held shafts the torques are those of the last evaluation of the motion. Where pairs roll beside them, what can be
    held besides is `gearidae.engine.train.sticking.sticking_guard`.
    """
    least, n = math.inf, len(tm.shafts)
    for i in range(n):
        shaft = tm.shafts[i]
        if shaft.rubs != 0 and (shaft.slip != 0.0 or tm.train[0].elements == 0):
            room = shaft.slip * y[n + i] if shaft.slip != 0.0 else shaft.limit - abs(shaft.torque)
            least = min(least, room)
    return least


@compiled
def direction_at_rest(torque: float, limit: float) -> float:
    """Direction in which a shaft at rest begins to slip; 0 if it is held."""
    return 0.0 if abs(torque) <= limit else math.copysign(1.0, torque)


@compiled
def begin_rest(tm: TrainModel, t: float, y: Floats) -> None:
    """Decide at a start which shafts are held."""
    n = len(tm.shafts)
    for i in range(n):
        tm.shafts[i].slip = math.copysign(1.0, y[n + i]) if y[n + i] != 0.0 else 0.0
    motion(tm, t, y, tm.rates[0])
    for i in range(n):
        shaft = tm.shafts[i]
        if shaft.rubs != 0 and y[n + i] == 0.0:
            shaft.slip, shaft.rest_begin = direction_at_rest(shaft.torque, shaft.limit), t


@compiled
def switch_rest(tm: TrainModel, t: float, y: Floats, out: TrainOutput) -> bool:
    """Stop shafts whose speed has passed zero, and let go those that cannot be held any longer.

    Parameters
    ----------
    t : float
        [s].
    y : ndarray
        State; speeds of shafts that come to rest are set to zero.
    out : TrainOutput
        Of the block.

    Returns
    -------
    bool
        Whether any direction has changed.
    """
    n, changed, stopped = len(tm.shafts), False, False
    for i in range(n):
        shaft = tm.shafts[i]
        if shaft.rubs != 0 and shaft.slip != 0.0 and shaft.slip * y[n + i] <= 0.0:
            y[n + i], stopped = 0.0, True
    if not (stopped or any_held(tm)):
        return False
    motion(tm, t, y, tm.rates[0])
    for i in range(n):
        shaft = tm.shafts[i]
        if shaft.rubs == 0 or y[n + i] != 0.0:
            continue
        before = shaft.slip
        if before == 0.0:
            # a held shaft has been let go at its limit exactly: the guard has fallen
            now = math.copysign(1.0, shaft.torque) if shaft.limit - abs(shaft.torque) <= 0.0 else 0.0
        else:
            now = direction_at_rest(shaft.torque, shaft.limit)
        if now == before:
            continue
        shaft.slip, changed = now, True
        if now == 0.0:
            shaft.rest_begin = t
            record_at_shaft(tm, t, _STICK, i, out)
        elif before == 0.0:
            shaft.rest_time += t - shaft.rest_begin
            record_at_shaft(tm, t, _SLIP, i, out)
        else:
            record_at_shaft(tm, t, _REVERSAL, i, out)
    return changed or stopped
