"""Free gears: both shafts under their torques, joined without backlash, adhesion and friction.

    (m1 + m2) w' = F1 - F2 + what acts on either shaft,    with the dry part of F2 set-valued at w = 0,

scaled and over the base radii. They are at rest at a zero of the real gear's speed and have its angles. Steps are those
of Shampine and Reichelt's Rosenbrock pair of order two (SIAM J. Sci. Comput. 18, 1997), which a stiff drive does not
shorten; a step ends where the speed falls to zero or the drive overcomes the dry resistance.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.friction.forces import NO_FORCE
from gearidae.engine.model.state import DRIVE, LOAD, Model
from gearidae.engine.observers.standing.free_torques import (
    acting_on_free,
    enter_segments,
    excess,
    free_torque,
    largest_excess,
    push_on_free,
)
from gearidae.formulas.interpolation import cubic
from gearidae.formulas.roots import HALVINGS, bisected, departure_of_cubic, zero_of_cubic
from gearidae.laws.shaft.schedule import straight_until
from gearidae.records.standing import GROWS

TOLERANCE: Final = 1e-5
"""Relative error of speed and travel in a step; of the travel also this many tenths of a pitch."""
SHORTEST: Final = 1e-8
"""Share of the time of all runs of a chain that a step has at least: with `SCENE.free_step` the bound on the work."""
_TURN: Final = 0.25
"""Radians that the fastest torque of an angle may go through in a step."""
_D: Final = 1.0 / (2.0 + math.sqrt(2.0))
_E: Final = 6.0 + math.sqrt(2.0)


@compiled_once(SOLVER)
def follow_free(m: Model, i: int, end: float, enough: float) -> float:
    """Follow the free gears of a zero to a time over tau, or until they have been so far away [pb]; return the time."""
    z, tau = m.state.standing.zero[i], m.scene.time_unit
    first, second, third = m.state.segment[0], m.state.segment[1], m.state.segment[2]
    t = z.free_time / tau
    while t < end and z.free_farthest < enough:
        t = _follow_piece(m, i, t, enter_segments(m, t, end), enough)
        z.free_time = t * tau
    m.state.segment[0], m.state.segment[1], m.state.segment[2] = first, second, third
    return t


@compiled
def _follow_piece(m: Model, i: int, t: float, stop: float, enough: float) -> float:
    """Follow free gears where no schedule has a knot."""
    z, unit = m.state.standing.zero[i], m.scene.phase_rate / m.scene.time_unit
    x, w, sign = z.free_travel, z.free_speed / unit, 0.0
    if w != 0.0:
        sign = math.copysign(1.0, w)
    longest = m.scene.free_step if m.scene.free_step > 0.0 else stop - t
    least = max(SHORTEST * m.scene.end, 1e-14 * stop)
    h = 1e-3 * (stop - t)
    while t < stop and z.free_farthest < enough:
        ahead = straight_until(m, t, stop)
        if w == 0.0:
            push = push_on_free(m, i, t, x)
            if abs(push) <= free_torque(m, i, LOAD, t, x, 0.0) + NO_FORCE:
                after = _certain_rest(m, i, x, t, ahead)
                if after == t:
                    after = min(max(_rests_until(m, i, x, t, min(ahead, t + longest)), t + least), stop)
                _accumulate_drive(m, i, t, after)
                t = after
                continue
            sign = math.copysign(1.0, push)
            if z.free_farthest == 0.0:
                z.onset = t * m.scene.time_unit
        h = min(max(h, least), longest, ahead - t)
        if m.scene.angle_omega > 0.0 and w != 0.0:
            h = min(h, max(_TURN / (m.scene.angle_omega * m.scene.phase_rate * abs(w)), least))
        new_w, new_x, error = _step(m, i, t, h, x, w, sign)
        if error > 1.0 and h > least:
            h *= max(0.2, 0.8 * error ** (-1.0 / 3.0))
            continue
        after, rate = t + h if h < ahead - t else ahead, m.scene.phase_rate
        if new_w * sign <= 0.0:
            share = _comes_to_rest(m, i, t, h, (x, w), (new_x, new_w), sign)
            after = min(max(t + share * h, t + least), stop)
            new_x, new_w = cubic(share, h, x, rate * w, new_x, rate * new_w), 0.0
        elif abs(new_x) > enough:
            way = x, rate * w, new_x, rate * new_w
            share = departure_of_cubic(0.0, 1.0, HALVINGS, 0.0, 0.0, enough, h, *way)[1]
            after, new_x = t + share * h, math.copysign(enough, new_x)
        _accumulate_drive(m, i, t, after)
        t, x, w = after, new_x, new_w
        z.free_farthest = max(z.free_farthest, abs(x))
        if z.free_farthest > (1.0 + GROWS) * z.free_mark:
            z.free_mark, z.free_grown = z.free_farthest, t * m.scene.time_unit
        h *= min(5.0, 0.8 * max(error, 1e-6) ** (-1.0 / 3.0))
    z.free_travel, z.free_speed = x, w * unit
    return t


@compiled
def _acceleration(m: Model, i: int, t: float, x: float, w: float, sign: float) -> float:
    """Acceleration of the base circles of free gears that turn in a direction."""
    force = free_torque(m, i, DRIVE, t, x, w) - sign * free_torque(m, i, LOAD, t, x, w)
    force += acting_on_free(m, i, t, x, w)
    return force / (1.0 / m.scene.pinion_inverse_mass + 1.0 / m.scene.gear_inverse_mass)


@compiled
def _step(
    m: Model, i: int, t: float, h: float, x: float, w: float, sign: float
) -> tuple[float, float, float]:
    """Speed and travel after a step, and its error over the tolerance."""
    rate = m.scene.phase_rate
    f0 = _acceleration(m, i, t, x, w, sign)
    by_t = (_acceleration(m, i, t + 1e-4 * h, x, w, sign) - f0) / (1e-4 * h)
    small = 1e-5 * (abs(w) + abs(h * f0)) + 1e-200
    by_w = (_acceleration(m, i, t, x, w + small, sign) - f0) / small
    by_x = 0.0
    if m.scene.torque[DRIVE].takes_angle != 0 or m.scene.torque[LOAD].takes_angle != 0:
        by_x = (_acceleration(m, i, t, x + 1e-6, w, sign) - f0) / 1e-6
    d = _D * h
    k1, j1 = _solve(d, by_w, by_x, rate, f0 + d * by_t, rate * w)
    half_w = w + 0.5 * h * k1
    f1 = _acceleration(m, i, t + 0.5 * h, x + 0.5 * h * j1, half_w, sign)
    k2, j2 = _solve(d, by_w, by_x, rate, f1 - k1, rate * half_w - j1)
    k2, j2 = k2 + k1, j2 + j1
    new_w, new_x = w + h * k2, x + h * j2
    f2 = _acceleration(m, i, t + h, new_x, new_w, sign)
    k3, j3 = _solve(
        d,
        by_w,
        by_x,
        rate,
        f2 - _E * (k2 - f1) - 2.0 * (k1 - f0) + d * by_t,
        rate * new_w - _E * (j2 - rate * half_w) - 2.0 * (j1 - rate * w),
    )
    of_speed = h / 6.0 * abs(k1 - 2.0 * k2 + k3) / (TOLERANCE * max(abs(w), abs(new_w)) + 1e-200)
    of_travel = h / 6.0 * abs(j1 - 2.0 * j2 + j3) / (TOLERANCE * (0.1 + abs(x)))
    return new_w, new_x, max(of_speed, of_travel)


@compiled
def _solve(
    d: float, by_w: float, by_x: float, rate: float, right_w: float, right_x: float
) -> tuple[float, float]:
    """Solve (1 - d J) k = right for speed and travel."""
    k = (right_w + d * by_x * right_x) / (1.0 - d * by_w - d * d * by_x * rate)
    return k, right_x + d * rate * k


@compiled
def _comes_to_rest(
    m: Model,
    i: int,
    t: float,
    h: float,
    begin: tuple[float, float],
    end: tuple[float, float],
    sign: float,
) -> float:
    """Share of a step after which the speed falls to zero."""
    rate0 = _acceleration(m, i, t, begin[0], begin[1], sign)
    rate1 = _acceleration(m, i, t + h, end[0], end[1], sign)
    return float(zero_of_cubic(0.0, 1.0, HALVINGS, 0.0, sign, h, begin[1], rate0, end[1], rate1)[0])


@compiled
def _certain_rest(m: Model, i: int, x: float, t: float, to: float) -> float:
    """Time up to which bounds of both torques say that free gears stay at rest; `t` if they do not say so."""
    if m.work.torque_law[DRIVE] != 0 or m.work.torque_law[LOAD] != 0:
        return t
    return to if largest_excess(m, i, t, to, x) <= 0.0 else t


@compiled
def _rests_until(m: Model, i: int, x: float, t: float, end: float) -> float:
    """Time at which the drive overcomes the dry resistance of free gears at rest, at most `end`."""
    return end if _rests(end, m, i, x) else float(_end_of_rest(t, end, HALVINGS, 0.0, m, i, x)[1])


@compiled
def _rests(t: float, m: Model, i: int, x: float) -> bool:
    """Whether the dry resistance holds free gears at rest."""
    push, limit = push_on_free(m, i, t, x), free_torque(m, i, LOAD, t, x, 0.0)
    return bool(abs(push) - limit - NO_FORCE <= 0.0)


_end_of_rest = bisected(_rests)


@compiled
def _accumulate_drive(m: Model, i: int, t: float, after: float) -> None:
    """Note by how much and how long the drive exceeds the dry load of the gear that stands."""
    z = m.state.standing.zero[i]
    first, last = excess(m, i, t) - NO_FORCE, excess(m, i, after) - NO_FORCE
    share = 0.0
    if first > 0.0 and last > 0.0:
        share = 1.0
    elif first > 0.0 or last > 0.0:
        share = max(first, last) / abs(first - last)
    unit = m.scene.force_unit * m.scene.gear_radius
    z.excess = max(z.excess, first * unit, last * unit)
    z.driven_time += share * (after - t) * m.scene.time_unit
