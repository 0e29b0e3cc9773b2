"""Torques at the shafts: a sum of terms (Teodorescu et al. 2009, Eq. 2).

A term says what it adds to the torque at a time and to its rate. Harmonics by order know the shaft's angle; a
registered law (`gearidae.torques`) knows angle and speed. Forces and times are scaled: torques are over the base radius
and the reference load, speeds are those of the base circles, angles are in radians.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.state import DRIVE, SPEED, Model
from gearidae.engine.torques.harmonic import (
    add_cosines,
    slope_of_cosines,
    sum_of_cosines,
    swing_of_cosines,
)
from gearidae.engine.torques.law import law_rate, law_value
from gearidae.engine.torques.schedule import schedule_rate, schedule_value, turns_within


@compiled(inline=True)
def torque_force(m: Model, shaft: int, t: float, angle: float, speed: float) -> float:
    """Torque over base radius and reference load, at scaled time t, angle [rad] and scaled speed of the shaft."""
    torque = m.scene.torque[shaft]
    value = add_cosines(m, torque.harmonics_at, torque.harmonic_count, t, torque.constant)
    value = schedule_value(m, shaft, t, value)
    if m.work.torque_law[shaft] != 0:
        value += law_value(m, shaft, t, angle, speed)
    if torque.order_count != 0:
        value += sum_of_cosines(m, torque.orders_at, torque.order_count, angle)
    if shaft == DRIVE and m.scene.speed_gain != 0.0:
        value += held_speed_value(m, t, speed)
    return value


@compiled
def torque_rate(m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float) -> float:
    """Rate of change of `torque_force` along the motion."""
    torque = m.scene.torque[shaft]
    rate = slope_of_cosines(m, torque.harmonics_at, torque.harmonic_count, t) + schedule_rate(m, shaft, t)
    if m.work.torque_law[shaft] != 0:
        rate += law_rate(m, shaft, t, angle, speed, acceleration)
    if torque.order_count != 0:
        rate += slope_of_cosines(m, torque.orders_at, torque.order_count, angle) * speed * torque.angle_unit
    if shaft == DRIVE and m.scene.speed_gain != 0.0:
        rate += held_speed_rate(m, t, acceleration)
    return rate


@compiled
def is_constant(m: Model, shaft: int) -> bool:
    """Whether a shaft's torque never changes."""
    if shaft == DRIVE and m.scene.speed_gain != 0.0:
        return False
    torque = m.scene.torque[shaft]
    fixed = torque.harmonic_count == 0 and torque.order_count == 0 and m.scene.schedule[shaft].knot_count == 0
    return fixed and m.work.torque_law[shaft] == 0


@compiled
def is_steady(m: Model, shaft: int, t: float) -> bool:
    """Whether the torque of a shaft that does not turn stays as it is until a schedule enters its next segment."""
    torque = m.scene.torque[shaft]
    if torque.harmonic_count != 0 or m.work.torque_law[shaft] != 0 or turns_within(m, shaft):
        return False
    held = shaft == DRIVE and m.scene.speed_gain != 0.0
    if held and (turns_within(m, SPEED) or schedule_rate(m, SPEED, t) != 0.0):
        return False
    return schedule_rate(m, shaft, t) == 0.0


@compiled
def torque_range(m: Model, shaft: int, t: float, to: float, angle: float) -> tuple[float, float]:
    """Bounds of `torque_force` at rest over a time in which schedules go one way; without a law."""
    torque = m.scene.torque[shaft]
    moving, swing = swing_of_cosines(m, torque.harmonics_at, torque.harmonic_count, t)
    middle = torque_force(m, shaft, t, angle, 0.0) - moving
    change = schedule_value(m, shaft, to, 0.0) - schedule_value(m, shaft, t, 0.0)
    low, high = min(change, 0.0), max(change, 0.0)
    if shaft == DRIVE and m.scene.speed_gain != 0.0:
        change = m.scene.speed_gain * (schedule_value(m, SPEED, to, 0.0) - schedule_value(m, SPEED, t, 0.0))
        low, high = low + min(change, 0.0), high + max(change, 0.0)
    return middle - swing + low, middle + swing + high


@compiled
def held_speed_value(m: Model, t: float, speed: float) -> float:
    """Torque over base radius at a scaled time and speed of the pinion, in units of the reference load."""
    return m.scene.speed_gain * (schedule_value(m, SPEED, t, 0.0) - speed)


@compiled
def held_speed_rate(m: Model, t: float, acceleration: float) -> float:
    """Rate of change of that along the motion."""
    return m.scene.speed_gain * (schedule_rate(m, SPEED, t) - acceleration)
