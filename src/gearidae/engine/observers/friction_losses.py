"""Losses by friction of flanks and joints, integrated over every step from powers and their rates at both ends.

The sliding of a joint, the integral of its load over its sliding distance, is found with them.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gearidae.compiled import compiled, compiled_once
from gearidae.engine import adams
from gearidae.engine.compiling import FRICTION
from gearidae.engine.friction.ageing import OfJoints, joint_friction, joint_friction_rate
from gearidae.engine.friction.forces import Shafts, solve_shafts
from gearidae.engine.friction.hubs import Loads, Mesh, has_hubs, pin_rate, vector_sum
from gearidae.engine.friction.pairs import direction, lever_rate, levers, rate_of_force, set_limits
from gearidae.engine.laws.pairs import mesh_force
from gearidae.engine.model.record_types import HELD_PAIR
from gearidae.engine.model.state import COAST, PHASE, Floats, Model, U, V, W
from gearidae.engine.motion.pair_forces import follow_slopes, is_eliminated, set_deflections
from gearidae.engine.motion.shafts import forces_at_shafts
from gearidae.engine.observers.exposures.friction_work import (
    add_friction_work,
    begin_powers,
    divide_friction_work,
    keeps_friction_work,
    note_power,
)
from gearidae.engine.pairs.mesh_error import acceleration_of, error_at
from gearidae.engine.pairs.tooth_pairs import flank_of_history
from gearidae.formulas.quadrature import error_estimate, integral, integral_with_middle
from gearidae.laws.friction_law import slip_of
from gearidae.laws.joints import SHAFT_OF_JOINT
from gearidae.laws.law import LOAD

_POWERS: Final = 8
"""Of the drive and the coast flank, of both hubs and the pin; and load times sliding speed of hubs and pin."""
_LOSSES: Final = 5
"""How many of them are losses."""
_AHEAD: Final = 1e-6
"""Over tau: how far ahead the rate of a load is found that has no closed form."""
_OUTER: Final = 0.5 * math.sqrt(0.6)
"""Distance of the outer points of the Gaussian rule from the middle of an interval of length 1."""


@compiled_once(FRICTION)
def note_friction(m: Model, t: float, y: Floats) -> float:
    """Note the powers of friction and their rates, with the present directions of slip; the force that it has found.

    The force is that along the line of action, mesh damping included.
    """
    rolls = m.scene.friction.joints != 0 and m.state.hold == HELD_PAIR
    ahead = _loads_ahead(m, t, y) if rolls else Loads(0.0, 0.0)
    surface_speed, pinion, gear = forces_at_shafts(m, t, y)
    if m.scene.nodes > 0:
        follow_slopes(m, t, y, 0.0, y)
        set_limits(m, t, y[W])
    shafts = solve_shafts(m, t, y, surface_speed, pinion, gear)
    r = m.work.friction
    r.time, force = t, mesh_force(m, y[V], shafts.mesh.drive - shafts.mesh.coast)
    for which in range(_POWERS):
        r.power[which] = r.power_rate[which] = 0.0
    e = error_at(m, y[U], y[PHASE])
    v_rate = acceleration_of(e, surface_speed, y[W], shafts.pinion, shafts.gear)
    drive = coast = drive_friction = coast_friction = 0.0  # rates
    begin_powers(m)
    for i in range(m.work.pair_forces.count):
        noted = m.work.pair_forces.pair[i]
        flank = flank_of_history(m, noted.history)
        first, second = levers(m, noted.position)
        slip = direction(m, noted) if m.scene.friction.flanks != 0 else 0.0
        friction, rate = slip * noted.limit, slip * noted.limit_rate
        speed = first * surface_speed - second * y[W]
        speed_rate = first * shafts.pinion - second * shafts.gear + lever_rate(m, noted, surface_speed, y[W])
        power, power_rate = friction * speed, rate * speed + friction * speed_rate
        r.power[flank] += power
        r.power_rate[flank] += power_rate
        note_power(m, noted.history, power, power_rate)
        changes = rate_of_force(m, noted, y[W], v_rate, shafts.gear)
        if flank == COAST:
            coast += changes
            coast_friction += rate
        else:
            drive += changes
            drive_friction += rate
    if m.scene.friction.joints != 0:
        force_rate = pin_rate(m, t, y, surface_speed, shafts.pinion)
        if rolls:
            load_rate = Loads(
                (ahead.pinion - shafts.loads.pinion) / _AHEAD, (ahead.gear - shafts.loads.gear) / _AHEAD
            )
        else:
            load_rate = _load_rate(m, shafts, Mesh(drive, coast, drive_friction, coast_friction), force_rate)
        joints, rates = joint_friction(m, t, y), joint_friction_rate(m, t, y)
        _note_joints(m, shafts, joints, rates, load_rate, force_rate, (surface_speed, y[W]))
    return float(force)


@compiled
def _note_joints(
    m: Model,
    shafts: Shafts,
    joints: OfJoints,
    rates: OfJoints,
    load_rate: Loads,
    force_rate: tuple[float, float],
    speeds: tuple[float, float],
) -> None:
    """Note the powers of the joints, for the rates of their friction, of the hubs' loads and of the pin's force."""
    pin, pin_rate = math.hypot(shafts.pin[0], shafts.pin[1]), 0.0
    if pin > 0.0:
        pin_rate = (shafts.pin[0] * force_rate[0] + shafts.pin[1] * force_rate[1]) / pin
    loads, load_rates = (
        (shafts.loads.pinion, shafts.loads.gear, pin),
        (load_rate.pinion, load_rate.gear, pin_rate),
    )
    for i in range(len(SHAFT_OF_JOINT)):
        shaft, load, by_time = SHAFT_OF_JOINT[i], loads[i], load_rates[i]
        friction, rate, slip = joints[i], rates[i], slip_of(m, shaft)
        speed, acceleration = speeds[shaft], shafts.gear if shaft == LOAD else shafts.pinion
        force = slip * (friction.by_load * load + friction.constant)
        changes = slip * (friction.by_load * by_time + (rate.by_load * load + rate.constant))
        _note(m, 2 + i, force, changes, speed, acceleration)
        arm = math.copysign(1.0, speed) * m.scene.friction.joint[i].arm
        _note(m, _LOSSES + i, arm * load, arm * by_time, speed, acceleration)


@compiled(inline=True)
def _note(m: Model, which: int, force: float, force_rate: float, speed: float, acceleration: float) -> None:
    """Note a power and its rate."""
    m.work.friction.power[which] = force * speed
    m.work.friction.power_rate[which] = force_rate * speed + force * acceleration


@compiled(makes_arrays=True)
def _loads_ahead(m: Model, t: float, y: Floats) -> Loads:
    """Loads of the hubs a short time later: the friction that holds a pair changes with all forces at both shafts."""
    surface_speed, pinion, gear = forces_at_shafts(m, t, y)
    shafts, later = solve_shafts(m, t, y, surface_speed, pinion, gear), np.zeros(y.size)
    if m.scene.nodes > 0:
        follow_slopes(m, t, y, _AHEAD, later)
    later[U] = y[U] + _AHEAD * y[V]
    e = error_at(m, y[U], y[PHASE])
    later[V] = y[V] + _AHEAD * acceleration_of(e, surface_speed, y[W], shafts.pinion, shafts.gear)
    later[PHASE] = y[PHASE] + _AHEAD * m.scene.phase_rate * y[W]
    later[W] = y[W] + _AHEAD * shafts.gear
    surface_speed, pinion, gear = forces_at_shafts(m, t + _AHEAD, later)
    return solve_shafts(m, t + _AHEAD, later, surface_speed, pinion, gear).loads


@compiled(inline=True)
def _load_rate(m: Model, shafts: Shafts, rate: Mesh, force_rate: tuple[float, float]) -> Loads:
    """Rates of the hubs' loads, for the rates of the forces that they are the moduli of vector sums of."""
    along, over = vector_sum(m, shafts.mesh)
    along_rate, over_rate = vector_sum(m, rate)
    pinion = (along - shafts.pin[0]) * (along_rate - force_rate[0])
    pinion += (over - shafts.pin[1]) * (over_rate - force_rate[1])
    gear = along * along_rate + over * over_rate
    by_pinion, by_gear = shafts.loads.pinion, shafts.loads.gear
    return Loads(pinion / by_pinion if by_pinion != 0.0 else 0.0, gear / by_gear if by_gear != 0.0 else 0.0)


@compiled_once(FRICTION)
def accumulate_friction(m: Model, t: float, y: Floats, root: bool, between: Floats, rates: Floats) -> float:
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

    Returns
    -------
    float
        Force there along the line of action; NaN where no time has passed.
    """
    r, a = m.work.friction, m.work.adams
    h, start = t - r.time, r.time
    if h == 0.0:
        return math.nan
    first, first_rate = _copied(m.work.friction.power), _copied(m.work.friction.power_rate)
    is_curved = root and (m.scene.population.flanks != 0 or has_hubs(m))
    if is_curved and a.order_used > 0:
        _accumulate_inside(m, start, h, between, rates)
        return note_friction(m, t, y)
    middle, halved = first, a.order_used > 0
    # weights of the rule, of powers and rates at both ends
    begin, end, first_rate_weight, last_rate_weight = 0.5 * h, 0.5 * h, h * h / 12.0, -h * h / 12.0
    if halved:
        begin, end, first_rate_weight, last_rate_weight = (
            7.0 / 30.0 * h,
            7.0 / 30.0 * h,
            h * h / 60.0,
            -h * h / 60.0,
        )
    elif is_curved:  # of a parabola
        begin, end, first_rate_weight, last_rate_weight = 2.0 / 3.0 * h, h / 3.0, h * h / 6.0, 0.0
    add_friction_work(m, begin, first_rate_weight)
    if halved:
        _note_within(m, start + 0.5 * h, between, rates)
        add_friction_work(m, 16.0 / 30.0 * h, 0.0)
        middle = _copied(m.work.friction.power)
    force = note_friction(m, t, y)
    add_friction_work(m, end, last_rate_weight)
    if keeps_friction_work(m):
        divide_friction_work(m, between if halved else y)
    for i in range(_POWERS):
        last, last_rate = r.power[i], r.power_rate[i]
        rate = 2.0 * (last - first[i]) / h - first_rate[i] if is_curved else last_rate  # of a parabola
        loss = integral(h, first[i], last, first_rate[i], rate)
        error = error_estimate(h, first[i], last, first_rate[i], rate)
        if halved:
            rough, loss = loss, integral_with_middle(h, first[i], middle[i], last, first_rate[i], last_rate)
            error = min(error, abs(loss - rough) / 16.0)
        _accumulate(m, i, loss, error)
    return force


@compiled
def _note_within(m: Model, t: float, between: Floats, rates: Floats) -> None:
    """Note the powers at a time within the step, at the state that its formula gives, which is left in `between`."""
    adams.between(m.work.adams, t, between, rates)
    if is_eliminated(m):
        set_deflections(m, t, between, False)
    note_friction(m, t, between)


@compiled
def _accumulate_inside(m: Model, start: float, h: float, between: Floats, rates: Floats) -> None:
    """Add the losses of an interval from the powers at three points inside it, by the Gaussian rule."""
    for point in range(3):
        then = start + (0.5 + (point - 1) * _OUTER) * h
        _note_within(m, then, between, rates)
        weight = (8.0 if point == 1 else 5.0) / 18.0 * h
        for i in range(_POWERS):
            _accumulate(m, i, weight * m.work.friction.power[i], 0.0)
        add_friction_work(m, weight, 0.0)
        if keeps_friction_work(m):
            divide_friction_work(m, between)


@compiled(inline=True)
def _accumulate(m: Model, i: int, loss: float, error: float) -> None:
    """Add a loss of the i-th power, and its error."""
    e = m.state.energy
    if i >= _LOSSES:
        e.sliding[i - _LOSSES] += loss
        return
    if i < 2:
        e.flank_loss[i] += loss
    else:
        e.joint_loss[i - 2] += loss
    e.loss_error += error
    e.throughput += abs(loss)


@compiled(inline=True)
def _copied(p: Floats) -> tuple[float, float, float, float, float, float, float, float]:
    """Numbers that have been noted last, which are written over."""
    return p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]
