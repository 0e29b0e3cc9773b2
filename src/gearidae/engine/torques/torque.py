"""Torques at the shafts: a sum of terms (Teodorescu et al. 2009, Eq. 2), each a file of `torques`.

A term says what it adds to the torque at a time and to its rate; a registered law (`gearidae.torques`) is one that
knows the speed too. Forces and times are scaled: torques are over the base radius and the reference load, speeds are
those of the base circles.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.state import DRIVE, Model
from gearidae.engine.torques.harmonic import harmonic_rate, harmonic_value
from gearidae.engine.torques.held_speed import held_speed_rate, held_speed_value
from gearidae.engine.torques.law import law_rate, law_value
from gearidae.engine.torques.schedule import schedule_rate, schedule_value

__all__ = ["is_constant", "torque_force", "torque_rate"]


@compiled(inline=True)
def torque_force(m: Model, shaft: int, t: float, speed: float) -> float:
    """Torque over base radius at scaled time t and scaled speed of the shaft, in units of the reference load."""
    value = m.scene.torque[shaft].constant
    value = harmonic_value(m, shaft, t, value)
    value = schedule_value(m, shaft, t, value)
    if m.work.torque_law[shaft] != 0:
        value += law_value(m, shaft, t, speed)
    if shaft == DRIVE and m.scene.speed_gain != 0.0:
        value += held_speed_value(m, t, speed)
    return value


@compiled
def torque_rate(m: Model, shaft: int, t: float, speed: float, acceleration: float) -> float:
    """Rate of change of `torque_force` along the motion."""
    rate = harmonic_rate(m, shaft, t) + schedule_rate(m, shaft, t)
    if m.work.torque_law[shaft] != 0:
        rate += law_rate(m, shaft, t, speed, acceleration)
    if shaft == DRIVE and m.scene.speed_gain != 0.0:
        rate += held_speed_rate(m, t, acceleration)
    return rate


@compiled
def is_constant(m: Model, shaft: int) -> bool:
    """Whether a shaft's torque never changes."""
    if shaft == DRIVE and m.scene.speed_gain != 0.0:
        return False
    fixed = m.scene.torque[shaft].harmonic_count == 0 and m.scene.schedule[shaft].knot_count == 0
    return fixed and m.work.torque_law[shaft] == 0
