"""Extremes of the gear's speed over a run and its parts, and where the gear has come to stand.

Between two accepted times a speed is the cubic that meets speeds and accelerations at both. As long as the
acceleration keeps its sign nothing has to be noted.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.contact.history import extreme_gap
from gearidae.engine.compiling import SOLVER
from gearidae.engine.friction.forces import NO_FORCE, own_limit
from gearidae.engine.laws.pairs import mesh_force
from gearidae.engine.model.checkpoint_record import WINDOWS
from gearidae.engine.model.state import LOAD, Floats, Model, Record, U, V, W
from gearidae.engine.motion.pair_forces import forces_at
from gearidae.engine.observers.standing.torques import slowest_period
from gearidae.formulas.interpolation import cubic
from gearidae.formulas.roots import HALVINGS, extremum_of_cubic, zero_of_cubic
from gearidae.laws.frictions import resists
from gearidae.records import RUN_PARTS

HELD_WITHIN: Final = 0.5
"""Pitches that a gear must turn on by before it counts as free again."""


@compiled
def note_speed(m: Model, w: float) -> None:
    """Note a speed; extremes have to come in the order of time."""
    e = m.state.extremes
    e.lowest_speed, e.highest_speed = min(e.lowest_speed, w), max(e.highest_speed, w)
    for i in range(len(RUN_PARTS)):
        if e.part[i].begun != 0:
            e.part[i].lowest, e.part[i].highest = min(e.part[i].lowest, w), max(e.part[i].highest, w)
    if e.part[0].begun != 0:
        e.top, e.bottom = max(e.top, w), min(e.bottom, w)
        e.fall, e.rise = max(e.fall, e.top - w), max(e.rise, w - e.bottom)
    if e.windows > 0:
        window = e.window[e.windows - 1]
        window.fall, window.rise = max(window.fall, window.highest - w), max(window.rise, w - window.lowest)
        window.lowest, window.highest = min(window.lowest, w), max(window.highest, w)


@compiled
def next_part(m: Model) -> float:
    """Time at which the coming window or part begins, or a whole period of the slowest harmonic has passed in one."""
    e, time, period = m.state.extremes, math.inf, slowest_period(m)
    if e.windows < WINDOWS:
        time = e.windows * e.window_length
    for i in range(len(RUN_PARTS)):
        if e.part[i].begun == 0:
            return min(time, _begin_of(m, i))
        if period > 0.0:
            time = min(time, e.part[i].whole_time + period)
    return time


@compiled(inline=True)
def _begin_of(m: Model, i: int) -> float:
    """Time at which a part of the chain begins, if it has not in a run before."""
    return max(RUN_PARTS[i] * m.scene.end, m.scene.start)


@compiled(inline=True)
def follow_speed(m: Model, last: Record, now: Record, y: Floats) -> None:
    """Follow the gear's speed from the last accepted time to this one, given as ``POINT`` and as a state."""
    if now.time >= m.work.track.next_part:
        _begin_parts(m, last, now)
    turned = now.speed_rate * last.speed_rate <= 0.0 and now.speed_rate != last.speed_rate
    if turned or (now.speed <= 0.0 < last.speed):
        _search_inside(m, last, now, y, turned)
    if m.state.extremes.is_stuck != 0 and now.position - m.state.extremes.stuck_position > HELD_WITHIN:
        m.state.extremes.is_stuck = 0  # it has turned on


@compiled
def _search_inside(m: Model, last: Record, now: Record, y: Floats, turned: bool) -> None:
    """Locate an extremum of the speed within a step, and where it falls to zero."""
    h, extreme = now.time - last.time, now.speed
    if turned:
        extreme = extreme_gap(h, last.speed, last.speed_rate, now.speed, now.speed_rate)
    if last.speed > 0.0 and min(now.speed, extreme) <= 0.0:
        share = _falls_to_zero(h, last.speed, last.speed_rate, now.speed, now.speed_rate)
        time = last.time + share * h
        position = last.position + share * h * 0.5 * last.speed * m.scene.phase_rate
        come_to_stand(m, time, position, is_pulled_back(m, now.time, y))
    if turned:
        note_speed(m, extreme)


@compiled
def _falls_to_zero(h: float, w0: float, rate0: float, w1: float, rate1: float) -> float:
    """Share of a step after which a speed that is positive at its beginning falls to zero."""
    high = 1.0
    if w1 > 0.0:  # it rises again within the step: look before its minimum
        high = extremum_of_cubic(0.0, 1.0, HALVINGS, 0.0, -1.0, h, w0, rate0, w1, rate1)[1]
    return float(zero_of_cubic(0.0, high, HALVINGS, 0.0, 1.0, h, w0, rate0, w1, rate1)[1])


@compiled_once(SOLVER)
def is_pulled_back(m: Model, t: float, y: Floats) -> bool:
    """Whether the drive flank pulls a gear back whose speed falls to zero, by more than laws of its shaft hold."""
    mesh = forces_at(m, t, y)
    pull = -(mesh.force + mesh.relief)
    held_up_to = mesh_force(m, y[V], own_limit(m, LOAD, t, y, y[W]) + NO_FORCE if resists(m, LOAD) else 0.0)
    return bool(y[U] > 0.0 and pull > max(held_up_to, 0.0))


@compiled
def come_to_stand(m: Model, t: float, position: float, pulled: bool) -> None:
    """Note that the speed has fallen to zero, and whether teeth that cling to each other turn the gear back there."""
    e = m.state.extremes
    e.reversals += 1
    note_speed(m, 0.0)
    if e.is_stuck == 0:
        e.is_stuck, e.stuck_time, e.stuck_position, e.stuck_exits = 1, t, position, e.mesh_exits
        e.turn_backs = 0
    if pulled:
        if e.turn_backs > 0:
            e.adhering += t - e.turn_back_time
        e.turn_backs, e.turn_back_time = e.turn_backs + 1, t


@compiled
def note_hold(m: Model, t: float) -> None:
    """Note that a law of its shaft holds the gear: adhesion does not, from there on."""
    e = m.state.extremes
    if e.turn_backs > 1:
        e.adhering += t - e.turn_back_time
    e.turn_backs = 0


@compiled
def _begin_parts(m: Model, last: Record, now: Record) -> None:
    """Begin those windows and parts whose time has come, and note the whole periods that have passed in others."""
    e, period = m.state.extremes, slowest_period(m)
    h = now.time - last.time
    while e.windows < WINDOWS and now.time >= e.windows * e.window_length:
        share = min(max((e.windows * e.window_length - last.time) / h, 0.0), 1.0) if h > 0.0 else 1.0
        w = cubic(share, h, last.speed, last.speed_rate, now.speed, now.speed_rate)
        note_speed(m, w)
        window = e.window[e.windows]
        e.windows += 1
        window.lowest = window.highest = w
        window.fall = window.rise = 0.0
        window.position = _position_within(m, last, now, share)
    for i in range(len(RUN_PARTS)):
        time = _begin_of(m, i)
        if e.part[i].begun != 0 and period > 0.0:
            passed = math.floor((now.time - e.part[i].whole_time) / period)
            if passed > 0.0:
                e.part[i].whole_time += passed * period
                share = min(max((e.part[i].whole_time - last.time) / h, 0.0), 1.0) if h > 0.0 else 1.0
                e.part[i].whole_position = _position_within(m, last, now, share)
        if e.part[i].begun != 0 or now.time < time:
            continue
        share = (time - last.time) / h if h > 0.0 else 1.0
        share = min(max(share, 0.0), 1.0)
        w = cubic(share, h, last.speed, last.speed_rate, now.speed, now.speed_rate)
        note_speed(m, w)
        e.part[i].begun, e.part[i].time = 1, time
        e.part[i].position = _position_within(m, last, now, share)
        e.part[i].whole_time, e.part[i].whole_position = time, e.part[i].position
        e.part[i].lowest = e.part[i].highest = w
        if i == 0:
            e.top = e.bottom = w
    m.work.track.next_part = next_part(m)


@compiled
def _position_within(m: Model, last: Record, now: Record, share: float) -> float:
    """How far the gear had turned after a share of a step."""
    scale = m.scene.phase_rate
    return cubic(
        share, now.time - last.time, last.position, scale * last.speed, now.position, scale * now.speed
    )
