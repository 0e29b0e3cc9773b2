"""Zeros of the gear's speed from which on it has stayed within half a pitch.

Ringing makes millions of them. A zero is dropped if an earlier one at the same position has been left no farther and
has been driven no sooner than it: what is judged from it is judged from the earlier one. Of what is left `MOST_ZEROS`
are kept; where that is not enough, the two that are most alike become one.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.friction.forces import NO_FORCE
from gearidae.engine.model.checkpoint_record import HIGH, MOST_SLOW, MOST_ZEROS
from gearidae.engine.model.state import DRIVE, PHASE, Floats, Model, Record, U
from gearidae.engine.observers.standing.torques import excess
from gearidae.engine.pairs.mesh_error import error_at
from gearidae.records.standing import GROWS, HALF_PITCH

_PLACE: Final = 1.0 / 32.0
_ALIKE: Final = 1e-3
"""Pitches between zeros at the same position, and between distances that are the same."""
_LOOKS: Final = 1.0 / 64.0
"""Share of the time since the first zero after which the distances of a gear that creeps are looked at again."""
_FASTER: Final = 1.1
"""Ratio of the speeds of two entries among the slow times: 32 of them go over more than a factor of ten."""


@compiled
def make_zero(m: Model, i: int, t: float, position: float, y: Floats, at_start: bool) -> None:
    """Write a zero at a time [s] and a position [pb]; the state is one near it."""
    z = m.state.standing.zero[i]
    z.time = z.free_time = t
    z.position = z.lowest = z.highest = position
    z.pinion_lead = 0.0
    if m.scene.torque[DRIVE].takes_angle != 0:
        z.pinion_lead = y[U] - m.state.initial_pinion_lead + error_at(m, y[U], y[PHASE]).value
    z.exits = m.state.extremes.mesh_exits
    z.start = 1 if at_start else 0
    z.driven = 0
    z.rest_time = m.state.standing.rest_time
    z.free_travel = z.free_speed = z.free_farthest = z.free_before = z.free_mark = z.mark = 0.0
    z.free_grown = z.grown = t
    z.onset = z.excess = z.driven_time = 0.0


@compiled_once(SOLVER)
def add_zero(m: Model, t: float, position: float, y: Floats, at_start: bool) -> None:
    """Note that the gear's speed is zero at a time over tau; `y` is a state near it."""
    s, time = m.state.standing, t * m.scene.time_unit
    note_slow(m, time, 0.0, position)
    _note_turning_point(m, time, position, y)
    s.zero_position = s.near_position = position
    s.zero_time = s.near_time = time
    s.near = 1
    for i in range(s.zero_count):
        z = s.zero[i]
        z.lowest, z.highest = min(z.lowest, position), max(z.highest, position)
    note_distances(m, time, position)
    if s.zero_count == MOST_ZEROS:
        _drop(m, _most_alike(m))
    make_zero(m, s.zero_count, time, position, y, at_start)
    s.zero_count += 1
    note_drive(m, t)
    i = s.zero_count - 1
    while i > 0:
        if _is_needless(m, i):
            _drop(m, i)
        i -= 1


@compiled
def note_distances(m: Model, time: float, position: float) -> None:
    """Note how far the gear has been from each zero until a time [s], and when it looks again."""
    s = m.state.standing
    for i in range(s.zero_count):
        z = s.zero[i]
        way = distance(z, position)
        if way > (1.0 + GROWS) * z.mark:
            z.mark, z.grown = way, time
    if s.zero_count > 0:
        s.distances_time = time + _LOOKS * (time - s.zero[0].time)


@compiled_once(SOLVER)
def note_drive(m: Model, t: float) -> None:
    """Note of all zeros whether the drive exceeds the dry load of a gear at rest there, at a time over tau."""
    s = m.state.standing
    s.undriven = 0
    for i in range(s.zero_count):
        z = s.zero[i]
        if z.driven == 0 and excess(m, t, z.position, z.pinion_lead) > NO_FORCE:
            z.driven = 1
        if z.driven == 0:
            s.undriven = 1


@compiled
def _note_turning_point(m: Model, time: float, position: float, y: Floats) -> None:
    """Note a zero farther forward or back than all since the gear last went that way."""
    s = m.state.standing
    if s.direction >= 0 and (s.high_known == 0 or position >= s.zero[HIGH].position):
        make_zero(m, HIGH, time, position, y, False)
        s.high_known = 1
    if s.direction <= 0:
        s.low = min(s.low, position)


@compiled
def distance(z: Record, position: float) -> float:
    """How far the gear has been from a zero [pb], with its present position."""
    return max(z.highest - z.position, z.position - z.lowest, abs(position - z.position))


@compiled
def _is_needless(m: Model, i: int) -> bool:
    """Whether an earlier zero says all that this one does."""
    zero = m.state.standing.zero
    last = zero[i]
    for k in range(i):
        z = zero[k]
        near = abs(z.position - last.position) < _PLACE
        if (
            near
            and z.driven <= last.driven
            and distance(z, z.position) <= distance(last, last.position) + _ALIKE
        ):
            return True
    return False


@compiled
def _most_alike(m: Model) -> int:
    """Zero, but for the first, that differs least from the one before."""
    zero, least, nearest = m.state.standing.zero, math.inf, 1
    for i in range(1, MOST_ZEROS):
        before, z = zero[i - 1], zero[i]
        apart = abs(z.position - before.position)
        apart += abs(distance(z, z.position) - distance(before, before.position))
        if z.driven == before.driven and apart < least:
            least, nearest = apart, i
    return nearest


@compiled
def _drop(m: Model, i: int) -> None:
    s = m.state.standing
    for k in range(i, s.zero_count - 1):
        s.zero[k] = s.zero[k + 1]
    s.zero_count -= 1


@compiled
def drop_left(m: Model, position: float) -> None:
    """Drop zeros that the gear has left by half a pitch."""
    s, kept = m.state.standing, 0
    for i in range(s.zero_count):
        if abs(position - s.zero[i].position) <= HALF_PITCH:
            if kept < i:
                s.zero[kept] = s.zero[i]
            kept += 1
    s.zero_count = kept


@compiled
def note_slow(m: Model, time: float, speed: float, position: float) -> None:
    """Note the speed at an accepted time: the way of the gear since it was last as slow is known later."""
    s = m.state.standing
    n = s.slow_count
    while n > 0 and s.slow[n - 1].speed >= speed:
        n -= 1
    if n > 0 and speed < _FASTER * s.slow[n - 1].speed:
        s.slow_count = n
        return
    if n == MOST_SLOW:
        for k in range(1, n):
            s.slow[k - 1] = s.slow[k]
        n -= 1
    s.slow[n].time, s.slow[n].speed, s.slow[n].position = time, speed, position
    s.slow_count = n + 1
