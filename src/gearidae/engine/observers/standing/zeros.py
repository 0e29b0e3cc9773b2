"""Zeros of the gear's speed from which on it has stayed within half a pitch.

Ringing makes millions of them. A zero is dropped if an earlier one in the same place has been left no farther and its
free gears have been at rest no longer: what is judged from it is judged from the earlier one. Of what is left
`MOST_ZEROS` are kept; where that is not enough, the two that are most alike become one.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.model.checkpoint_record import HIGH, MOST_SLOW, MOST_ZEROS, SPARE
from gearidae.engine.model.state import DRIVE, PHASE, Floats, Model, Record, U
from gearidae.engine.observers.standing.free_gears import follow_free
from gearidae.engine.pairs.mesh_error import error_at
from gearidae.records.standing import GROWS, HALF_PITCH, SETTLED_WITHIN, SHARE, stands

DECIDED: Final = 2.0 * HALF_PITCH
"""Pitches of free gears from which on a gear stands that has stayed within half a pitch."""
SELDOM: Final = 1e-3
"""Share of the run after which free gears are then followed."""
_PLACE: Final = 1.0 / 32.0
_ALIKE: Final = 1e-3
"""Pitches between zeros in the same place, and between distances that are the same."""
_LOOKS: Final = 1.0 / 64.0
"""Share of the time since the first zero after which the distances of a gear that creeps are looked at again."""
_FASTER: Final = 1.1
"""Ratio of the speeds of two entries among the slow times: 32 of them go over more than a factor of ten."""

_stands = compiled(stands)


@compiled
def make_zero(m: Model, i: int, t: float, position: float, y: Floats, at_start: bool) -> None:
    """Write a zero at a time [s] and a position [pb]; the state is one near it."""
    z = m.state.standing.zero[i]
    z.time = z.free_time = t
    z.position = z.lowest = z.highest = position
    z.lead = 0.0
    if m.scene.torque[DRIVE].takes_angle != 0:
        z.lead = y[U] - m.state.initial_lead + error_at(m, y[U], y[PHASE]).value
    z.exits = m.state.extremes.mesh_exits
    z.start = 1 if at_start else 0
    z.spent = 0
    z.rest_time = m.state.standing.rest_time
    z.free_travel = z.free_speed = z.free_farthest = z.free_before = z.free_mark = z.mark = 0.0
    z.free_grown = z.grown = t
    z.onset = z.excess = z.driven_time = 0.0


@compiled
def copy_zero(m: Model, to: int, i: int) -> None:
    """Copy a zero to another place."""
    m.state.standing.zero[to] = m.state.standing.zero[i]


@compiled_once(SOLVER)
def add_zero(m: Model, t: float, position: float, y: Floats, at_start: bool) -> None:
    """Note that the gear's speed is zero at a time over tau; `y` is a state near it."""
    s, time = m.state.standing, t * m.scene.time_unit
    note_slow(m, time, 0.0, position)
    _note_turn(m, time, position, y)
    s.place = s.near_position = position
    s.place_time = s.near_time = time
    s.near = 1
    for i in range(s.zero_count):
        z = s.zero[i]
        z.lowest, z.highest = min(z.lowest, position), max(z.highest, position)
    look_at_distances(m, time, position)
    if s.zero_count > 0 and s.zero[0].free_farthest > DECIDED:
        # whatever comes, from the first on the gear stands until it leaves; from then on others count
        if time - s.zero[0].free_time > SELDOM * (m.scene.end - m.scene.start) * m.scene.time_unit:
            _follow_zero(m, 0, t)
        if _has_one_near(m, position):
            return
    else:
        follow_zeros(m, t)
    if s.zero_count == MOST_ZEROS:
        _drop(m, _most_alike(m))
    make_zero(m, s.zero_count, time, position, y, at_start)
    s.zero_count += 1
    i = s.zero_count - 1
    while i > 0:
        if _is_needless(m, i):
            _drop(m, i)
        i -= 1


@compiled
def look_at_distances(m: Model, time: float, position: float) -> None:
    """Note how far the gear has been from each zero until a time [s], and when it looks again."""
    s = m.state.standing
    for i in range(s.zero_count):
        z = s.zero[i]
        way = distance(z, position)
        if way > (1.0 + GROWS) * z.mark:
            z.mark, z.grown = way, time
    if s.zero_count > 0:
        s.look_time = time + _LOOKS * (time - s.zero[0].time)


@compiled
def settles(z: Record, time: float, position: float) -> int:
    """Whether free gears have settled since a zero, followed to a time [s]: 1, or 2 if the gear has as well.

    They go no farther than a pitch, and no farther in the second half of the time than in the first.
    """
    half = 0.5 * (time - z.time)
    if free_advance(z, time) > SETTLED_WITHIN or z.free_grown - z.time > half:
        return 0
    rests = z.grown - z.time <= half and distance(z, position) <= (1.0 + GROWS) * z.mark
    return 2 if rests else 1


@compiled
def _note_turn(m: Model, time: float, position: float, y: Floats) -> None:
    """Note a zero farther forward or back than all since the gear last went that way."""
    s = m.state.standing
    if s.direction >= 0 and (s.high_known == 0 or position >= s.zero[HIGH].position):
        make_zero(m, HIGH, time, position, y, False)
        s.high_known = 1
    if s.direction <= 0:
        s.low = min(s.low, position)


@compiled
def follow_zeros(m: Model, t: float) -> None:
    """Follow the free gears of all zeros to a time over tau, than which no standstill ends earlier."""
    for i in range(m.state.standing.zero_count):
        _follow_zero(m, i, t)


@compiled
def _follow_zero(m: Model, i: int, t: float) -> None:
    follow_free(m, i, t, math.inf)
    m.state.standing.zero[i].free_before = m.state.standing.zero[i].free_farthest


@compiled
def _has_one_near(m: Model, position: float) -> bool:
    """Whether there is a zero in the same place whose standstill has not ended."""
    s, near = m.state.standing, False
    for i in range(s.zero_count):
        near |= s.zero[i].spent == 0 and abs(s.zero[i].position - position) < _PLACE
    return near


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
        rests = z.free_farthest == 0.0 or last.free_farthest > 0.0
        if near and rests and distance(z, z.position) <= distance(last, last.position) + _ALIKE:
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
        if (z.free_farthest == 0.0) == (before.free_farthest == 0.0) and apart < least:
            least, nearest = apart, i
    return nearest


@compiled
def _drop(m: Model, i: int) -> None:
    s = m.state.standing
    for k in range(i, s.zero_count - 1):
        copy_zero(m, k, k + 1)
    s.zero_count -= 1


@compiled
def drop_left(m: Model, position: float) -> None:
    """Drop zeros that the gear has left by half a pitch."""
    s, kept = m.state.standing, 0
    for i in range(s.zero_count):
        if abs(position - s.zero[i].position) <= HALF_PITCH:
            if kept < i:
                copy_zero(m, kept, i)
            kept += 1
    s.zero_count = kept


@compiled
def standing_since(m: Model, time: float, position: float, length: float, held: float) -> int:
    """First zero from which the gear stands until a time at a position, in a run of a length [s]; -1 if none.

    A gear that dry friction has held until then, no farther than `held` from the zero [pb], has stood, whatever free
    gears have done: under nearly the same load they may have just begun to move.
    `SPARE` is then that zero with its free gears at that time. The zeros stay as they are, because the gear may leave
    another one later whose standstill has ended earlier.
    """
    s = m.state.standing
    for i in range(s.zero_count):
        if s.zero[i].time > time:
            break
        copy_zero(m, SPARE, i)
        z = s.zero[SPARE]
        follow_free(m, SPARE, time / m.scene.time_unit, math.inf)
        together = settles(z, time, position) == 2
        way = distance(z, position)
        if _stands(way, free_advance(z, time), time - z.time, length, together or way <= held):
            return i
    return -1


@compiled
def stood_until(m: Model, i: int, limit: float, length: float) -> tuple[float, float, float]:
    """When the conditions of standing from a zero held last before a time [s]; 0 if they did not.

    A gear that begins to move as free gears do ends a standstill without leaving half a pitch. Since the last zero its
    way is among the slow times; before, the standstill of a gear that is not driven ends where free gears begin.

    Returns
    -------
    time, advance, free_advance : float
        [s], [pb], [pb]. `SPARE` is the zero with its free gears at that time.
    """
    s, tau = m.state.standing, m.scene.time_unit
    copy_zero(m, SPARE, i)
    z = s.zero[SPARE]
    end, advance, before = 0.0, 0.0, -1.0
    for k in range(s.slow_count):
        point = s.slow[k]
        if point.time < z.free_time or point.time > limit:
            continue
        follow_free(m, SPARE, point.time / tau, math.inf)
        way, free = distance(z, point.position), z.free_farthest
        margin = 0.5 * free - way
        if _stands(way, free, point.time - z.time, length, False):
            end, advance, before = point.time, way, margin
        elif before >= 0.0:
            share = before / (before - margin)
            end, advance = end + share * (point.time - end), advance + share * (way - advance)
            before = -1.0
    if end > 0.0:
        copy_zero(m, SPARE, i)
        follow_free(m, SPARE, end / tau, math.inf)
        return end, advance, z.free_farthest
    z.excess = z.driven_time = 0.0
    if z.onset > 0.0 and z.onset <= limit and z.onset - z.time > SHARE * length:
        return z.onset, distance(z, z.position), 0.0
    return 0.0, 0.0, 0.0


@compiled
def free_advance(z: Record, time: float) -> float:
    """Farthest distance of free gears until a time [s]; a run has ended where they have been followed farther."""
    return z.free_farthest if z.free_time <= time * (1.0 + 1e-12) else z.free_before


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
