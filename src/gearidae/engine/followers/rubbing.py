"""Losses by friction of flanks and hubs, integrated over every step from powers and their rates at both ends."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import FRICTION
from gearidae.engine.followers.exposures.rubbing import (
    add_rubbing,
    begin_powers,
    divide_rubbing,
    keeps_rubbing,
    note_power,
)
from gearidae.engine.formulas import adams
from gearidae.engine.formulas.quadrature import error_estimate, integral, integral_with_middle
from gearidae.engine.friction.forces import Shafts, has_hubs, solve_shafts
from gearidae.engine.friction.hubs import Mesh
from gearidae.engine.friction.pairs import direction, lever_rate, levers, set_limits
from gearidae.engine.model.record_types import HELD_PAIR
from gearidae.engine.model.state import COAST, PHASE, Floats, Model, U, V, W
from gearidae.engine.motion.pair_forces import follow_slopes, is_eliminated, set_deflections
from gearidae.engine.motion.shafts import forces_at_shafts
from gearidae.engine.pairs.tooth_pairs import flank_of_history, static_error

_POWERS: Final = 4
_AHEAD: Final = 1e-6
"""Over tau: how far ahead the rate of a load is found that has no closed form."""
_OUTER: Final = 0.5 * math.sqrt(0.6)
"""Distance of the outer points of the Gaussian rule from the middle of an interval of length 1."""


@compiled_once(FRICTION)
def note_rubbing(m: Model, t: float, y: Floats) -> None:
    """Note the powers of friction and their rates, with the present directions of slip."""
    ahead = _load_ahead(m, t, y) if has_hubs(m) and m.state.hold == HELD_PAIR else 0.0
    turn, pinion, gear = forces_at_shafts(m, t, y)
    if m.scene.nodes > 0:
        follow_slopes(m, t, y, 0.0, y)
        set_limits(m, t, y[W])
    found = solve_shafts(m, t, y, turn, pinion, gear)
    r = m.work.rubbing
    r.time = t
    for which in range(_POWERS):
        r.power[which] = r.power_rate[which] = 0.0
    drive = coast = drive_friction = coast_friction = 0.0  # rates
    begin_powers(m)
    for i in range(m.work.notes.count):
        noted = m.work.notes.pair[i]
        flank = flank_of_history(m, noted.history)
        first, second = levers(m, noted.position)
        slip = direction(m, noted) if m.scene.friction.flanks != 0 else 0.0
        friction, rate = slip * noted.limit, slip * noted.limit_rate
        speed = first * turn - second * y[W]
        speed_rate = first * found.pinion - second * found.gear + lever_rate(m, noted, turn, y[W])
        power, power_rate = friction * speed, rate * speed + friction * speed_rate
        r.power[flank] += power
        r.power_rate[flank] += power_rate
        note_power(m, noted.history, power, power_rate)
        if flank == COAST:
            coast += noted.force_rate
            coast_friction += rate
        else:
            drive += noted.force_rate
            drive_friction += rate
    if found.hubs != 0.0:
        if m.state.hold == HELD_PAIR:
            load_rate = (ahead - found.hubs) / _AHEAD
        else:
            load_rate = _load_rate(m, found, Mesh(drive, coast, drive_friction, coast_friction))
        own, slip = m.scene.friction, m.state.slip if m.scene.friction.gear_hub > 0.0 else 0.0
        r.power[2] = own.pinion_hub * found.hubs * m.state.pinion_slip * turn
        r.power_rate[2] = (
            own.pinion_hub * m.state.pinion_slip * (load_rate * turn + found.hubs * found.pinion)
        )
        r.power[3] = own.gear_hub * found.hubs * slip * y[W]
        r.power_rate[3] = own.gear_hub * slip * (load_rate * y[W] + found.hubs * found.gear)


@compiled(makes_arrays=True)
def _load_ahead(m: Model, t: float, y: Floats) -> float:
    """Load of the hubs a short time later: the friction that holds a pair changes with all forces at both shafts."""
    turn, pinion, gear = forces_at_shafts(m, t, y)
    found, later = solve_shafts(m, t, y, turn, pinion, gear), np.zeros(y.size)
    if m.scene.nodes > 0:
        follow_slopes(m, t, y, _AHEAD, later)
    later[U] = y[U] + _AHEAD * y[V]
    e1, e2 = static_error(m, y[U], y[PHASE])[2:] if m.scene.error_count != 0 else (0.0, 0.0)
    later[V] = y[V] + _AHEAD * ((1.0 - e1) * found.pinion - e2 * turn * turn - found.gear)
    later[PHASE] = y[PHASE] + _AHEAD * m.scene.phase_rate * y[W]
    later[W] = y[W] + _AHEAD * found.gear
    turn, pinion, gear = forces_at_shafts(m, t + _AHEAD, later)
    return solve_shafts(m, t + _AHEAD, later, turn, pinion, gear).hubs


@compiled(inline=True)
def _load_rate(m: Model, found: Shafts, rate: Mesh) -> float:
    """Rate of the hubs' load, for the rates of the forces that it is the vector sum of."""
    own, now = m.scene.friction, found.mesh
    half = now.drive * rate.drive + now.coast * rate.coast
    half += now.drive_friction * rate.drive_friction + now.coast_friction * rate.coast_friction
    half -= own.cosine * (rate.drive * now.coast + now.drive * rate.coast)
    half -= own.cosine * (rate.drive_friction * now.coast_friction + now.drive_friction * rate.coast_friction)
    half += own.sine * (rate.drive * now.coast_friction + now.drive * rate.coast_friction)
    half -= own.sine * (rate.drive_friction * now.coast + now.drive_friction * rate.coast)
    return half / found.hubs


@compiled_once(FRICTION)
def book_rubbing(m: Model, t: float, y: Floats, root: bool, between: Floats, rates: Floats) -> None:
    """Add the losses since the last call, and note the powers here.

    The corrected trapezoidal rule is extrapolated with the powers in the middle, where the formula of the step gives
    the state there. Rates are infinite before an asperity detaches, and those of a hub's load jump nearly where it
    passes zero: there powers at three points inside the interval are taken, or the rate before.

    Parameters
    ----------
    t : float
        Time over tau.
    y : ndarray, shape (n,)
        State there.
    root : bool
        Whether something happens there.
    between, rates : ndarray, shape (n,)
        Work space.
    """
    r, a = m.work.rubbing, m.work.adams
    h, start = t - r.time, r.time
    if h == 0.0:
        return
    first = _powers(m)
    bends = root and (m.scene.population.flanks != 0 or has_hubs(m))
    if bends and a.order_used > 0:
        _book_inside(m, start, h, between, rates)
        note_rubbing(m, t, y)
        return
    middle, halved = first, a.order_used > 0
    end, bend = (7.0 / 30.0 * h, h * h / 60.0) if halved else (0.5 * h, h * h / 12.0)  # weights of the rule
    add_rubbing(m, end, bend)
    if halved:
        _note_within(m, start + 0.5 * h, between, rates)
        add_rubbing(m, 16.0 / 30.0 * h, 0.0)
        middle = _powers(m)
    note_rubbing(m, t, y)
    add_rubbing(m, end, -bend)
    if keeps_rubbing(m):
        divide_rubbing(m, between if halved else y)
    last = _powers(m)
    for i in range(_POWERS):
        j = _POWERS + i
        rate = 2.0 * (last[i] - first[i]) / h - first[j] if bends else last[j]  # of a parabola
        loss = integral(h, first[i], last[i], first[j], rate)
        error = error_estimate(h, first[i], last[i], first[j], rate)
        if halved:
            rough, loss = loss, integral_with_middle(h, first[i], middle[i], last[i], first[j], last[j])
            error = min(error, abs(loss - rough) / 16.0)
        _book(m, i, loss, error)


@compiled
def _note_within(m: Model, t: float, between: Floats, rates: Floats) -> None:
    """Note the powers at a time within the step, at the state that its formula gives, which is left in `between`."""
    adams.between(m.work.adams, t, between, rates)
    if is_eliminated(m):
        set_deflections(m, t, between, False)
    note_rubbing(m, t, between)


@compiled
def _book_inside(m: Model, start: float, h: float, between: Floats, rates: Floats) -> None:
    """Add the losses of an interval from the powers at three points inside it, by the Gaussian rule."""
    for point in range(3):
        then = start + (0.5 + (point - 1) * _OUTER) * h
        _note_within(m, then, between, rates)
        weight = (8.0 if point == 1 else 5.0) / 18.0 * h
        for i in range(_POWERS):
            _book(m, i, weight * m.work.rubbing.power[i], 0.0)
        add_rubbing(m, weight, 0.0)
        if keeps_rubbing(m):
            divide_rubbing(m, between)


@compiled(inline=True)
def _book(m: Model, i: int, loss: float, error: float) -> None:
    """Add a loss of the i-th power, and its error."""
    e = m.state.energy
    if i < 2:
        e.flank_loss[i] += loss
    else:
        e.hub_loss[i - 2] += loss
    e.loss_error += error
    e.throughput += abs(loss)


@compiled(inline=True)
def _powers(m: Model) -> tuple[float, float, float, float, float, float, float, float]:
    """Powers that have been noted last, then their rates."""
    p, r = m.work.rubbing.power, m.work.rubbing.power_rate
    return p[0], p[1], p[2], p[3], r[0], r[1], r[2], r[3]
