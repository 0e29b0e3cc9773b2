"""Torques at the shafts: a sum of terms (Teodorescu et al. 2009, Eq. 2), each a file of `torques`.

A term says what it adds to the torque at a time and to its rate. Forces and times are scaled: torques are over the
base radius and the reference load.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.state import Model
from gearidae.engine.model.torques.harmonic import harmonic_rate, harmonic_value
from gearidae.engine.model.torques.schedule import schedule_rate, schedule_value

__all__ = ["is_constant", "torque_force", "torque_rate"]


@compiled(inline=True)
def torque_force(m: Model, shaft: int, t: float) -> float:
    """Torque over base radius at scaled time t, in units of the reference load."""
    value = m.scene.torque[shaft].constant
    value = harmonic_value(m, shaft, t, value)
    return schedule_value(m, shaft, t, value)


@compiled
def torque_rate(m: Model, shaft: int, t: float) -> float:
    """Rate of change of `torque_force`."""
    return harmonic_rate(m, shaft, t) + schedule_rate(m, shaft)


@compiled
def is_constant(m: Model, shaft: int) -> bool:
    """Whether a shaft's torque never changes."""
    own = m.scene.torque[shaft]
    return own.harmonic_count == 0 and own.knot_count == 0
