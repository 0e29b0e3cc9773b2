"""A drive that holds a speed: ``gain (w(t) - w)``, the torque-speed line of a motor."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.state import SPEED, Model
from gearidae.engine.torques.schedule import schedule_rate, schedule_value


@compiled
def held_speed_value(m: Model, t: float, speed: float) -> float:
    """Torque over base radius at a scaled time and speed of the pinion, in units of the reference load."""
    return m.scene.speed_gain * (schedule_value(m, SPEED, t, 0.0) - speed)


@compiled
def held_speed_rate(m: Model, t: float, acceleration: float) -> float:
    """Rate of change of that along the motion."""
    return m.scene.speed_gain * (schedule_rate(m, SPEED, t) - acceleration)
