"""Where a gear stands, followed over accepted times and events, and what is said of it at an end."""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.checkpoint_record import HIGH, MOST_STANDSTILLS, SPARE
from gearidae.engine.model.record_types import AT_REST, FREE, HELD_GEAR
from gearidae.engine.model.state import DRIVE, PHASE, STOPS, Floats, Model, Record, W
from gearidae.engine.observers.standing.free_gears import follow_free
from gearidae.engine.observers.standing.free_torques import (
    enter_segments,
    excess,
    free_torque,
    largest_excess,
    slowest_period,
)
from gearidae.engine.observers.standing.zeros import (
    add_zero,
    copy_zero,
    distance,
    drop_left,
    follow_zeros,
    free_advance,
    look_at_distances,
    make_zero,
    note_slow,
    settles,
    standing_since,
    stood_until,
)
from gearidae.formulas.interpolation import cubic
from gearidae.formulas.roots import HALVINGS, departure_of_cubic, extremum_of_cubic, zero_of_cubic
from gearidae.laws.shaft.schedule import straight_until
from gearidae.records.standing import HALF_PITCH

NEAR: Final = 3.0
"""Roughnesses along the line of action within which a gear is where it stood: the reach of asperities that cling."""
LOOKS_AHEAD: Final = 4096
"""Times at most, besides knots of schedules, at which a run that is to stop looks at what is still to come."""
_STICKS: Final = STOPS.index("sticks")


@compiled
def begin(m: Model, t: float, y: Floats) -> None:
    """Go on from a start of the integration."""
    s, position = m.state.standing, y[PHASE] + m.state.turns
    if m.state.extremes.begun == 0:
        s.low = position
        make_zero(m, HIGH, t * m.scene.time_unit, position, y, y[W] == 0.0)
        s.high_known = 1
        s.breakaway = s.start_torque = _drive_torque(m, HIGH, t)
        if y[W] == 0.0:
            add_zero(m, t, position, y, True)
        s.way, s.held = _sign(y[W]), m.state.hold
    elif y[W] == 0.0:
        follow_zeros(m, t)
    if s.direction >= 0 and position > s.zero[HIGH].position:
        s.high_known = 0
    if s.direction < 0:
        follow_free(m, HIGH, t, math.inf)
    if m.scene.stop == _STICKS:
        plan_stop(m, t)


@compiled(inline=True)
def step(m: Model, here: int, y: Floats) -> None:
    """Follow the gear from the last accepted time to this one, given as index of its ``POINT`` and as a state."""
    s, unit, track = m.state.standing, m.scene.time_unit, m.work.track
    last, now = track.point[track.last], track.point[here]
    if is_at_rest(m):
        s.rest_time += (now.time - last.time) * unit
    turned = now.speed_rate * last.speed_rate <= 0.0 and now.speed_rate != last.speed_rate
    if now.speed * last.speed <= 0.0 or (turned and _may_pass_zero(last, now)):
        _look_for_zeros(m, here, y, turned)
    s.way = _sign(now.speed)
    if s.zero_count > 0:
        note_slow(m, now.time * unit, abs(now.speed) * m.scene.phase_rate / unit, now.position)
        if s.near != 0 and abs(now.position - s.place) > NEAR * m.scene.phase_rate:
            _go_away(m, last, now)
        if now.time * unit >= s.look_time:
            look_at_distances(m, now.time * unit, now.position)
        if abs(now.position - s.zero[0].position) > HALF_PITCH:
            leave(m, now.time, now.position)
    if s.direction >= 0 and s.high_known != 0 and now.position < s.zero[HIGH].position - HALF_PITCH:
        s.turn_time = now.time * unit if s.direction != 0 else 0.0
        s.direction, s.low = -1, now.position
    if s.direction <= 0 and now.position > s.low + HALF_PITCH:
        s.direction, s.high_known = 1, 0
    if s.left == 0 and abs(now.position - m.state.first_place) > HALF_PITCH:
        s.left = 1


@compiled(inline=True)
def _may_pass_zero(last: Record, now: Record) -> bool:
    """Whether a speed of one sign at both ends may reach zero within a step: a cubic leaves its chord by less."""
    bend = 0.25 * (now.time - last.time) * (abs(last.speed_rate) + abs(now.speed_rate))
    return bool(min(abs(last.speed), abs(now.speed)) <= bend)


@compiled(inline=True)
def _sign(speed: float) -> int:
    return 1 if speed > 0.0 else -1 if speed < 0.0 else 0


@compiled
def resume(m: Model, t: float, y: Floats) -> None:
    """Note that something has brought the gear to rest or turned it round at once, or that dry friction has let go.

    A change of what is held that is not the rest of all of it lets something go.
    """
    s, sign, position = m.state.standing, _sign(y[W]), y[PHASE] + m.state.turns
    if s.way != 0 and sign != s.way:
        add_zero(m, t, position, y, False)
        if m.scene.stop == _STICKS:
            plan_stop(m, t)
    s.way = sign
    if s.held != FREE and m.state.hold != s.held and m.state.hold != AT_REST:
        s.slip_time, s.slip_position = t * m.scene.time_unit, position
        s.slip_from_rest = 1 if s.held == AT_REST or s.held == HELD_GEAR else 0
    s.held = m.state.hold


@compiled
def _go_away(m: Model, last: Record, now: Record) -> None:
    """Note when the gear has gone away from its last zero, within a step that may contain both."""
    s, unit, rate = m.state.standing, m.scene.time_unit, m.scene.phase_rate
    h = now.time - last.time
    begin = min(max((s.place_time / unit - last.time) / h, 0.0), 1.0)
    way = last.position, rate * last.speed, now.position, rate * now.speed
    share = departure_of_cubic(begin, 1.0, HALVINGS, 0.0, s.place, NEAR * rate, h, *way)[1]
    s.near, s.near_time = 0, (last.time + share * h) * unit
    s.near_position = cubic(share, h, *way)


@compiled(inline=True)
def _slipped(m: Model) -> bool:
    """Whether dry friction has let go of the gear since its last zero, near where it stood."""
    s = m.state.standing
    near = abs(s.slip_position - s.place) <= NEAR * m.scene.phase_rate
    return bool(near and s.slip_time >= s.place_time and s.slip_time > 0.0)


@compiled(inline=True)
def _break_away(m: Model, t: float, position: float) -> tuple[float, float]:
    """When [s] and where the gear broke away that leaves half a pitch now.

    With the last slip near where it stood; where none has been since the last zero of its speed, as it went away from
    there. Neither depends on how fast the torque rises, as the speed does.
    """
    s = m.state.standing
    if _slipped(m):
        return s.slip_time, s.slip_position
    if s.near != 0:
        return t * m.scene.time_unit, position
    return s.near_time, s.near_position


@compiled
def is_at_rest(m: Model) -> bool:
    """Whether dry friction holds the gear."""
    return bool(m.state.hold == AT_REST or m.state.hold == HELD_GEAR)


@compiled_once(SOLVER)
def _look_for_zeros(m: Model, here: int, y: Floats, turned: bool) -> None:
    """Find zeros of the speed within a step: one where its sign changes, or two about an extremum beyond zero."""
    track = m.work.track
    last, now = track.point[track.last], track.point[here]
    w0, w1 = last.speed, now.speed
    if w0 == 0.0 and w1 == 0.0:
        return
    if w0 == 0.0:  # it has been noted when the gear came to rest; from there on it moves
        add_zero(m, last.time, last.position, y, False)
    elif w1 == 0.0:
        add_zero(m, now.time, now.position, y, False)
    elif w0 * w1 < 0.0:
        _add_between(m, last, now, y, 0.0, 1.0)
    elif turned:
        h, speeds = now.time - last.time, (w0, last.speed_rate, w1, now.speed_rate)
        low = extremum_of_cubic(0.0, 1.0, HALVINGS, 0.0, -w0, h, *speeds)[0]
        if cubic(low, h, *speeds) * w0 < 0.0:
            _add_between(m, last, now, y, 0.0, low)
            _add_between(m, last, now, y, low, 1.0)
    if m.scene.stop == _STICKS:
        plan_stop(m, now.time)


@compiled
def _add_between(m: Model, last: Record, now: Record, y: Floats, low: float, high: float) -> None:
    """Add the zero of the speed between two shares of a step, at which its signs differ."""
    h, rate = now.time - last.time, m.scene.phase_rate
    speeds = last.speed, last.speed_rate, now.speed, now.speed_rate
    share = zero_of_cubic(low, high, HALVINGS, 0.0, cubic(low, h, *speeds), h, *speeds)[1]
    position = cubic(share, h, last.position, rate * last.speed, now.position, rate * now.speed)
    add_zero(m, last.time + share * h, position, y, False)


@compiled_once(SOLVER)
def leave(m: Model, t: float, position: float) -> None:
    """Leave half a pitch from the first zero: note the standstill that lies behind, if there is one."""
    note_stood(m, t, position)
    drop_left(m, position)
    if m.scene.stop == _STICKS:
        plan_stop(m, t)


@compiled
def note_stood(m: Model, t: float, position: float) -> None:
    """Note a standstill that has ended: as the gear broke away, or as it began to move as free gears do."""
    s, i, length = m.state.standing, 0, m.scene.end * m.scene.time_unit
    limit, place = _break_away(m, t, position)
    held = NEAR * m.scene.phase_rate if _slipped(m) and s.slip_from_rest != 0 else 0.0
    stood = standing_since(m, limit, place, length, held)
    if stood >= 0:
        if s.zero[stood].spent == 0:
            z = s.zero[SPARE]
            ways = distance(z, place), free_advance(z, limit)
            _note_standstill(m, stood, limit, ways, settles(z, limit, place))
        return
    while i < s.zero_count:
        if s.zero[i].spent == 0 and s.zero[i].time < limit:
            time, way, free = stood_until(m, i, limit, length)
            if time > 0.0:
                _note_standstill(m, i, time, (way, free), 0)
                return
        i += 1


@compiled
def _note_standstill(m: Model, i: int, time: float, ways: tuple[float, float], settled: int) -> None:
    """Note a standstill from zero `i` to a time [s], with the advances; of the drive since then `SPARE` knows."""
    s = m.state.standing
    z, drive = s.zero[i], s.zero[SPARE]
    start, rest = standstill_begin(m, z), s.rest_time - z.rest_time
    for j in range(s.zero_count):
        if s.zero[j].time <= time:
            s.zero[j].spent = 1
    s.standstills += 1
    s.standing_time += time - start
    s.standing_rest += min(rest, time - start)
    s.last_end, s.breakaway = time, _drive_torque(m, i, time / m.scene.time_unit)
    at = s.stand_count
    if at == MOST_STANDSTILLS:  # the shortest makes room
        at = 0
        for j in range(1, MOST_STANDSTILLS):
            standstill, least = s.standstill[j], s.standstill[at]
            if standstill.end - standstill.begin < least.end - least.begin:
                at = j
        if time - start <= s.standstill[at].end - s.standstill[at].begin:
            return
        for j in range(at, MOST_STANDSTILLS - 1):
            s.standstill[j] = s.standstill[j + 1]
        at = MOST_STANDSTILLS - 1
    else:
        s.stand_count += 1
    kept = s.standstill[at]
    kept.begin, kept.end, kept.settled = start, time, settled
    kept.advance, kept.free_advance = ways
    kept.since, kept.breakaway = z.time, s.breakaway
    kept.excess, kept.driven_time, kept.rest_time = drive.excess, drive.driven_time, min(rest, time - start)


@compiled
def standstill_begin(m: Model, z: Record) -> float:
    """When a standstill begins [s]: no two of them overlap, and one that begins at a start at rest begins there."""
    s = m.state.standing
    if s.left == 0 and s.zero[0].start != 0 and s.standstills == 0:
        return s.zero[0].time
    return max(z.time, s.last_end)


@compiled
def _drive_torque(m: Model, i: int, t: float) -> float:
    """Torque of the drive on a pinion at rest [N m]."""
    first, second, third = m.state.segment[0], m.state.segment[1], m.state.segment[2]
    enter_segments(m, t, t)
    torque = free_torque(m, i, DRIVE, t, 0.0, 0.0) * m.scene.force_unit * m.scene.pinion_radius
    m.state.segment[0], m.state.segment[1], m.state.segment[2] = first, second, third
    return torque


@compiled
def plan_stop(m: Model, t: float) -> None:
    """Set when a run ends that is to end in a standstill that sticks, if the gear does not leave its first zero."""
    s, k, i = m.state.standing, m.work.track, 0
    while i < s.zero_count and s.zero[i].spent != 0:
        i += 1
    if i == s.zero_count:
        k.planned = k.stop_time = 0.0
    elif k.planned != s.zero[i].time + 1.0:
        k.planned, k.stop_time = s.zero[i].time + 1.0, _stop_time(m, i, t)


@compiled_once(SOLVER)
def _stop_time(m: Model, i: int, t: float) -> float:
    """Time over tau when free gears have turned by a pitch and nothing ahead drives harder than before; 0 if never."""
    s = m.state.standing
    copy_zero(m, SPARE, i)
    end, begin = follow_free(m, SPARE, m.scene.end, 1.0), s.zero[i].time / m.scene.time_unit
    if s.zero[SPARE].free_farthest < 1.0:
        return 0.0
    end = max(end, begin + slowest_period(m), _hardest(m, max(begin, m.scene.start)))
    # behind the present time, so that it is a root
    return max(end, t + 1e-9 * (m.scene.end - m.scene.start))


@compiled
def _hardest(m: Model, t: float) -> float:
    """Time at which the drive exceeds the load most, of a gear that stands at the zero `SPARE`."""
    first, second, third = m.state.segment[0], m.state.segment[1], m.state.segment[2]
    longest, most, time = m.scene.end - t, -math.inf, t
    if m.scene.free_step > 0.0:
        longest = max(m.scene.free_step, longest / LOOKS_AHEAD)
    while True:
        knot = enter_segments(m, t, m.scene.end)
        size = largest_excess(m, SPARE, t, t, 0.0)
        if size > most + 1e-9 * abs(most) or most == -math.inf:
            most, time = size, t
        if t >= m.scene.end:
            break
        t = min(straight_until(m, t, knot), t + longest)
    m.state.segment[0], m.state.segment[1], m.state.segment[2] = first, second, third
    return time


@compiled
def _standing_zero(m: Model, t: float, position: float) -> int:
    """Zero from which the gear stands at an end at a position; -1 if none, and a standstill before is noted."""
    if m.state.standing.zero_count == 0:
        return -1
    time = t * m.scene.time_unit
    i = standing_since(m, time, position, time, 0.0)
    if i < 0:
        note_stood(m, t, position)
    return i


STANDING_NUMBERS: Final = 18
"""Numbers that `standing_at` leaves, in the order in which it writes them."""


@compiled
def standing_at(place: int, t: float, y: Floats, out: Floats) -> None:
    """Say where the gear stands if the run ends here, and how far it has gone back.

    A standstill that has ended then is noted, and is to be forgotten if the run does not end. The free gears of a zero
    are followed for good only where a standstill cannot have ended before.

    Parameters
    ----------
    place : int
        Of the model, from `gearidae.engine.model.addresses.Addresses`.
    t : float
        Time over tau.
    y : ndarray, shape (n,)
        State there.
    out : ndarray, shape (STANDING_NUMBERS,)
        Filled in; see `gearidae.engine.observers.extremes.units`.
    """
    m = model_at(place)
    s, time, position = m.state.standing, t * m.scene.time_unit, y[PHASE] + m.state.turns
    out[:] = 0.0
    i = _standing_zero(m, t, position)
    out[0] = 1.0 if i >= 0 else 0.0
    if s.zero_count > 0:
        if _break_away(m, t, position)[0] >= time:
            follow_free(m, max(i, 0), t, math.inf)
        copy_zero(m, SPARE, max(i, 0))
        follow_free(m, SPARE, t, math.inf)
        z = s.zero[SPARE]
        never = s.left == 0 and s.zero[0].start != 0
        out[1], out[2] = s.zero[0].time if never else z.time, float(s.zero[0].exits if never else z.exits)
        out[3], out[4] = distance(z, position), free_advance(z, time)
        out[5], out[6] = z.driven_time, z.excess
        out[7], out[8] = s.rest_time - z.rest_time, standstill_begin(m, z)
        out[17] = settles(z, time, position)
        out[9] = excess(m, SPARE, t) * m.scene.force_unit * m.scene.gear_radius
    if s.direction < 0:
        follow_free(m, HIGH, t, math.inf)
        high = s.zero[HIGH]
        out[10], out[11] = high.position - position, max(-high.free_travel, 0.0)
        out[12], out[13], out[14] = high.time, float(high.exits), s.turn_time
    out[15], out[16] = slowest_period(m) * m.scene.time_unit, 1.0 if is_at_rest(m) else 0.0


@compiled
def settle_standing_at(place: int, t: float, y: Floats) -> None:
    """Follow all free gears to the end of a run, after which torques are others.

    Free gears are not followed back in time. A standstill that has ended before is therefore noted now, and one that is
    noted after this ends here or later.
    """
    m = model_at(place)
    s, time, position = m.state.standing, t * m.scene.time_unit, y[PHASE] + m.state.turns
    _standing_zero(m, t, position)
    broken = min(_break_away(m, t, position)[0] / m.scene.time_unit, t)
    s.slow_count = 0
    note_slow(m, time, abs(y[W]) * m.scene.phase_rate / m.scene.time_unit, position)
    for i in range(s.zero_count):
        copy_zero(m, SPARE, i)
        follow_free(m, SPARE, broken, math.inf)
        s.zero[i].free_before = s.zero[SPARE].free_farthest
        follow_free(m, i, t, math.inf)
    if s.direction < 0:
        follow_free(m, HIGH, t, math.inf)
