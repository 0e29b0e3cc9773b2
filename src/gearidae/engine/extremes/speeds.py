"""Extremes of the gear's speed over a run and its parts, and where the gear has come to stand.

Between two accepted times a speed is the cubic that meets speeds and accelerations at both. As long as the
acceleration keeps its sign nothing has to be noted.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled
from gearidae.contact.history import extreme_gap
from gearidae.engine.model.state import PARTS, PHASE, Floats, Model, W

__all__ = ["follow_speed", "next_part", "note_speed", "stand"]

HELD_WITHIN: Final = 0.5
"""Pitches that a gear must turn on by before it counts as free again."""

_BISECTIONS: Final = 40


@compiled
def note_speed(m: Model, w: float) -> None:
    """Note a speed; extremes have to come in the order of time."""
    e = m.state.extremes
    e.lowest_speed, e.highest_speed = min(e.lowest_speed, w), max(e.highest_speed, w)
    for i in range(len(PARTS)):
        if e.part[i].begun != 0:
            e.part[i].lowest, e.part[i].highest = min(e.part[i].lowest, w), max(e.part[i].highest, w)
    if e.part[0].begun != 0:
        e.top, e.bottom = max(e.top, w), min(e.bottom, w)
        e.fall, e.rise = max(e.fall, e.top - w), max(e.rise, w - e.bottom)


@compiled
def next_part(m: Model) -> float:
    """Time at which the coming part of the run begins."""
    for i in range(len(PARTS)):
        if m.state.extremes.part[i].begun == 0:
            return float(m.scene.start + PARTS[i] * (m.scene.end - m.scene.start))
    return math.inf


@compiled(inline=True)
def follow_speed(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Follow the gear's speed from the last accepted time to this one."""
    k = m.work.track
    w, rate = y[W], yp[W]
    if t >= k.next_part:
        _begin_parts(m, t, y, yp)
    turned = rate * k.speed_rate <= 0.0 and rate != k.speed_rate
    if turned or (w <= 0.0 < k.speed):
        _look_inside(m, t, w, rate, turned)
    if m.state.extremes.held != 0 and _free(m, y):
        m.state.extremes.held = 0


@compiled
def _free(m: Model, y: Floats) -> bool:
    """Whether a gear that had come to stand has turned on."""
    return bool(y[PHASE] + m.state.turns - m.state.extremes.held_place > HELD_WITHIN)


@compiled
def _look_inside(m: Model, t: float, w: float, rate: float, turned: bool) -> None:
    """Locate an extremum of the speed within a step, and where it falls to zero."""
    k = m.work.track
    h = t - k.time
    extreme = extreme_gap(h, k.speed, k.speed_rate, w, rate) if turned else w
    if k.speed > 0.0 and min(w, extreme) <= 0.0:
        share = _falls_to_zero(h, k.speed, k.speed_rate, w, rate)
        stand(m, k.time + share * h, k.place + share * h * 0.5 * k.speed * m.scene.phase_rate)
    if turned:
        note_speed(m, extreme)


@compiled
def _falls_to_zero(h: float, w0: float, rate0: float, w1: float, rate1: float) -> float:
    """Share of a step after which a speed that is positive at its beginning falls to zero."""
    low, high = 0.0, 1.0
    if w1 > 0.0:  # it rises again within the step: look before its minimum
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            if _slope(middle, h, w0, rate0, w1, rate1) < 0.0:
                low = middle
            else:
                high = middle
        low = 0.0
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        if cubic(middle, h, w0, rate0, w1, rate1) > 0.0:
            low = middle
        else:
            high = middle
    return high


@compiled
def cubic(s: float, h: float, f0: float, rate0: float, f1: float, rate1: float) -> float:
    """Cubic with given values and rates at both ends, at a share of the way between them."""
    return f0 + s * s * (3.0 - 2.0 * s) * (f1 - f0) + s * (1.0 - s) * h * ((1.0 - s) * rate0 - s * rate1)


@compiled
def _slope(s: float, h: float, f0: float, rate0: float, f1: float, rate1: float) -> float:
    """Its slope there."""
    ends = (1.0 - s) * (1.0 - 3.0 * s) * rate0 - s * (2.0 - 3.0 * s) * rate1
    return 6.0 * s * (1.0 - s) * (f1 - f0) + h * ends


@compiled
def stand(m: Model, t: float, place: float) -> None:
    """Note that the speed has fallen to zero."""
    e = m.state.extremes
    e.reversals += 1
    note_speed(m, 0.0)
    if e.held == 0:
        e.held, e.held_time, e.held_place, e.held_exits = 1, t, place, e.mesh_exits


@compiled
def _begin_parts(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Begin those parts of the run whose time has come."""
    k, e = m.work.track, m.state.extremes
    h, place = t - k.time, y[PHASE] + m.state.turns
    for i in range(len(PARTS)):
        time = m.scene.start + PARTS[i] * (m.scene.end - m.scene.start)
        if e.part[i].begun != 0 or t < time:
            continue
        share = (time - k.time) / h if h > 0.0 else 1.0
        share = min(max(share, 0.0), 1.0)
        w = cubic(share, h, k.speed, k.speed_rate, y[W], yp[W])
        note_speed(m, w)
        scale = m.scene.phase_rate
        e.part[i].begun, e.part[i].time = 1, time
        e.part[i].place = cubic(share, h, k.place, scale * k.speed, place, scale * y[W])
        e.part[i].lowest = e.part[i].highest = w
        if i == 0:
            e.top = e.bottom = w
    k.next_part = next_part(m)
