"""A drive that holds a speed, which may follow a schedule: a torque over what the speed is short of."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gearidae.compiled import compiled
from gearidae.laws.law import DRIVE, SPEED, Coefficient, Range, ShaftLaw
from gearidae.laws.shaft.schedule import range_of_schedule, schedule_rate, schedule_value, turns_within

if TYPE_CHECKING:
    from gearidae.engine.model.state import Model


@compiled(inline=True)
def _force(m: Model, shaft: int, t: float, angle: float, speed: float, value: float) -> float:
    gain = m.scene.torque[shaft].speed_gain
    if gain != 0.0:
        value += gain * (schedule_value(m, SPEED, t, 0.0) - speed)
    return value


@compiled
def _rate(
    m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float, value: float
) -> float:
    gain = m.scene.torque[shaft].speed_gain
    if gain != 0.0:
        value += gain * (schedule_rate(m, SPEED, t) - acceleration)
    return value


@compiled(inline=True)
def _by_speed(m: Model, shaft: int, angle: float, speed: float, value: float) -> float:
    return value - m.scene.torque[shaft].speed_gain


@compiled
def _is_constant(m: Model, shaft: int, value: bool) -> bool:
    return bool(value and m.scene.torque[shaft].speed_gain == 0.0)


@compiled
def _is_steady(m: Model, shaft: int, t: float, value: bool) -> bool:
    changes = turns_within(m, SPEED) or schedule_rate(m, SPEED, t) != 0.0
    return bool(value and not (m.scene.torque[shaft].speed_gain != 0.0 and changes))


@compiled
def _range(m: Model, shaft: int, t: float, to: float, value: Range) -> Range:
    gain = m.scene.torque[shaft].speed_gain
    return value if gain == 0.0 else range_of_schedule(m, SPEED, t, to, gain, value)


def _slowing(scene: Any, shaft: int, value: tuple[float, float]) -> tuple[float, float]:
    return (value[0] + scene.drive.speed_gain, value[1]) if shaft == DRIVE else value


HELD_SPEED = ShaftLaw(
    "held speed",
    drives=True,
    coefficients=(Coefficient("speed_gain", 1),),  # force per speed that the shaft lacks [F tau/sigma]
    force=_force,
    rate=_rate,
    by_speed=_by_speed,
    is_constant=_is_constant,
    is_steady=_is_steady,
    range=_range,
    slowing=_slowing,
)
