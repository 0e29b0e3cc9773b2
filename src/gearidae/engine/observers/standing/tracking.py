"""What says where a gear stands, followed over accepted times and events; the judge reads it at the end of a block."""

from __future__ import annotations

from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.model.checkpoint_record import HIGH
from gearidae.engine.model.record_types import AT_REST, FREE, HELD_GEAR
from gearidae.engine.model.state import DRIVE, PHASE, Floats, Model, Record, W
from gearidae.engine.model.work_record import MOST_LEAVINGS
from gearidae.engine.observers.standing.zeros import (
    add_zero,
    drop_left,
    make_zero,
    note_distances,
    note_drive,
    note_slow,
)
from gearidae.formulas.interpolation import cubic
from gearidae.formulas.roots import HALVINGS, departure_of_cubic, extremum_of_cubic, zero_of_cubic
from gearidae.laws.shafts import driving_force
from gearidae.records.standing import HALF_PITCH

NEAR: Final = 3.0
"""Roughnesses along the line of action within which a gear is where it stood: the reach of asperities that cling."""


@compiled
def begin(m: Model, t: float, y: Floats) -> None:
    """Go on from a start of the integration."""
    s, position = m.state.standing, y[PHASE] + m.state.whole_pitches
    if m.state.extremes.begun == 0:
        s.low = position
        make_zero(m, HIGH, t * m.scene.time_unit, position, y, y[W] == 0.0)
        s.high_known = 1
        torque = driving_force(m, DRIVE, t, 0.0, 0.0) * m.scene.force_unit * m.scene.pinion_radius
        m.state.stood.breakaway = m.state.stood.start_torque = torque
        if y[W] == 0.0:
            add_zero(m, t, position, y, True)
        s.way, s.held = _sign(y[W]), m.state.hold
    if s.direction >= 0 and position > s.zero[HIGH].position:
        s.high_known = 0


@compiled(inline=True)
def step(m: Model, here: int, y: Floats) -> None:
    """Follow the gear from the last accepted time to this one, given as index of its ``POINT`` and as a state."""
    s, unit, track = m.state.standing, m.scene.time_unit, m.work.track
    last, now = track.point[track.last], track.point[here]
    if is_at_rest(m):
        s.rest_time += (now.time - last.time) * unit
    turned = now.speed_rate * last.speed_rate <= 0.0 and now.speed_rate != last.speed_rate
    if now.speed * last.speed <= 0.0 or (turned and _may_pass_zero(last, now)):
        _find_zeros(m, here, y, turned)
    s.way = _sign(now.speed)
    if s.zero_count > 0:
        if s.undriven != 0:
            note_drive(m, now.time)
        note_slow(m, now.time * unit, abs(now.speed) * m.scene.phase_rate / unit, now.position)
        if s.near != 0 and abs(now.position - s.zero_position) > NEAR * m.scene.phase_rate:
            _go_away(m, last, now)
        if now.time * unit >= s.distances_time:
            note_distances(m, now.time * unit, now.position)
        if abs(now.position - s.zero[0].position) > HALF_PITCH:
            _leave(m, now.time, now.position)
    if s.direction >= 0 and s.high_known != 0 and now.position < s.zero[HIGH].position - HALF_PITCH:
        s.turn_time = now.time * unit if s.direction != 0 else 0.0
        s.direction, s.low = -1, now.position
    if s.direction <= 0 and now.position > s.low + HALF_PITCH:
        s.direction, s.high_known = 1, 0
    if s.left == 0 and abs(now.position - m.state.first_position) > HALF_PITCH:
        s.left = 1


@compiled(inline=True)
def _may_pass_zero(last: Record, now: Record) -> bool:
    """Whether a speed of one sign at both ends may reach zero within a step: a cubic leaves its chord by less."""
    from_chord = 0.25 * (now.time - last.time) * (abs(last.speed_rate) + abs(now.speed_rate))
    return bool(min(abs(last.speed), abs(now.speed)) <= from_chord)


@compiled(inline=True)
def _sign(speed: float) -> int:
    return 1 if speed > 0.0 else -1 if speed < 0.0 else 0


@compiled
def resume(m: Model, t: float, y: Floats) -> None:
    """Note that something has brought the gear to rest or turned it round at once, or that dry friction has let go.

    A change of what is held that is not the rest of all of it lets something go. A gear that comes away from rest may
    stick and slip for some vibrations yet: what lets it go near that place has held it since the rest.
    """
    s, sign, position = m.state.standing, _sign(y[W]), y[PHASE] + m.state.whole_pitches
    if s.way != 0 and sign != s.way:
        add_zero(m, t, position, y, False)
    s.way = sign
    if s.held != FREE and m.state.hold != s.held and m.state.hold != AT_REST:
        held = s.held == AT_REST or s.held == HELD_GEAR
        again = s.slip_from_rest != 0 and abs(position - s.slip_position) <= NEAR * m.scene.phase_rate
        s.slip_time, s.slip_position = t * m.scene.time_unit, position
        s.slip_from_rest = 1 if held or again else 0
    s.held = m.state.hold


@compiled
def _go_away(m: Model, last: Record, now: Record) -> None:
    """Note when the gear has gone away from its last zero, within a step that may contain both."""
    s, unit, rate = m.state.standing, m.scene.time_unit, m.scene.phase_rate
    h = now.time - last.time
    begin = min(max((s.zero_time / unit - last.time) / h, 0.0), 1.0)
    way = last.position, rate * last.speed, now.position, rate * now.speed
    share = departure_of_cubic(begin, 1.0, HALVINGS, 0.0, s.zero_position, NEAR * rate, h, *way)[1]
    s.near, s.near_time = 0, (last.time + share * h) * unit
    s.near_position = cubic(share, h, *way)


@compiled
def is_at_rest(m: Model) -> bool:
    """Whether dry friction holds the gear."""
    return bool(m.state.hold == AT_REST or m.state.hold == HELD_GEAR)


@compiled_once(SOLVER)
def _find_zeros(m: Model, here: int, y: Floats, turned: bool) -> None:
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


@compiled
def _add_between(m: Model, last: Record, now: Record, y: Floats, low: float, high: float) -> None:
    """Add the zero of the speed between two shares of a step, at which its signs differ."""
    h, rate = now.time - last.time, m.scene.phase_rate
    speeds = last.speed, last.speed_rate, now.speed, now.speed_rate
    share = zero_of_cubic(low, high, HALVINGS, 0.0, cubic(low, h, *speeds), h, *speeds)[1]
    position = cubic(share, h, last.position, rate * last.speed, now.position, rate * now.speed)
    add_zero(m, last.time + share * h, position, y, False)


@compiled_once(SOLVER)
def _leave(m: Model, t: float, position: float) -> None:
    """Leave half a pitch from the first zero, and keep for the judge what is known of where the gear stood."""
    s = m.state.standing
    s.leave_time, s.leave_position = t * m.scene.time_unit, position
    if m.work.leavings < MOST_LEAVINGS:
        m.work.leaving[m.work.leavings] = s
        m.work.leavings += 1
    drop_left(m, position)
    m.work.track.planned = m.work.track.stop_time = 0.0
