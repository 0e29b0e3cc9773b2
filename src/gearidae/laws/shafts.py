"""All laws of a shaft, and their sums.

The first laws drive: they are the torque of the drive at the pinion, and at the gear the limit of the dry resistance.
The others act on either shaft as they are. Sums begin at -0.0, to which adding a number gives that number.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from gearidae.compiled import compiled
from gearidae.formulas.quadrature import Ends
from gearidae.laws.law import Range, ShaftLaw, in_turn
from gearidae.laws.shaft.constant import CONSTANT
from gearidae.laws.shaft.drag import DRAG
from gearidae.laws.shaft.harmonic import HARMONICS, ORDERS
from gearidae.laws.shaft.held_speed import HELD_SPEED
from gearidae.laws.shaft.own import OWN
from gearidae.laws.shaft.schedule import SCHEDULE

if TYPE_CHECKING:
    from gearidae.engine.model.state import Model
    from gearidae.scene import GearScene

SHAFT_LAWS: Final[tuple[ShaftLaw, ...]] = (CONSTANT, HARMONICS, SCHEDULE, OWN, ORDERS, HELD_SPEED, DRAG)
"""In the order of additions."""

_DRIVING = tuple(law for law in SHAFT_LAWS if law.drives)
_ACTING = tuple(law for law in SHAFT_LAWS if not law.drives)

_driving = in_turn(tuple(law.force for law in _DRIVING))
_driving_rate = in_turn(tuple(law.rate for law in _DRIVING))
_constant = in_turn(tuple(law.is_constant for law in _DRIVING))
_steady = in_turn(tuple(law.is_steady for law in _DRIVING))
_range = in_turn(tuple(law.range for law in _DRIVING))
acting = in_turn(tuple(law.force for law in _ACTING))
"""Add what acts on a shaft besides its driving torque: (m, shaft, t, angle, speed, value) -> value."""
by_speed = in_turn(tuple(law.by_speed for law in SHAFT_LAWS))
"""Add the slopes of all forces on a shaft in its speed: (m, shaft, angle, speed, value) -> value."""
_losses = in_turn(tuple(law.loss for law in _ACTING))


@compiled(inline=True)
def driving_force(m: Model, shaft: int, t: float, angle: float, speed: float) -> float:
    """Driving torque over base radius and reference load, at a scaled time, an angle [rad] and a scaled speed."""
    return _driving(m, shaft, t, angle, speed, -0.0)


@compiled
def driving_rate(m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float) -> float:
    """Rate of change of `driving_force` along the motion."""
    return _driving_rate(m, shaft, t, angle, speed, acceleration, 0.0)


@compiled
def is_constant(m: Model, shaft: int) -> bool:
    """Whether a shaft's driving torque never changes."""
    return bool(_constant(m, shaft, True))


@compiled
def is_steady(m: Model, shaft: int, t: float) -> bool:
    """Whether that of a shaft that does not turn stays as it is until a schedule enters its next segment."""
    return bool(_steady(m, shaft, t, True))


@compiled
def driving_range(m: Model, shaft: int, t: float, to: float, angle: float) -> tuple[float, float]:
    """Bounds of `driving_force` at rest over a time in which schedules go one way; without a law of a user."""
    changes = _range(m, shaft, t, to, Range(0.0, 0.0, 0.0, 0.0))
    middle = driving_force(m, shaft, t, angle, 0.0) - changes.moving
    return middle - changes.swing + changes.low, middle + changes.swing + changes.high


@compiled(inline=True)
def book_losses(m: Model, shaft: int, h: float, travel: float, turn: Ends) -> float:
    """Book the losses of what acts on a shaft in a step of the length h, and return them."""
    return _losses(m, shaft, h, travel, turn, 0.0)


def slowing(scene: GearScene, shaft: int) -> tuple[float, float]:
    """Torques of all laws that slow a shaft down, over its angular speed and over the square of that [SI]."""
    value = (0.0, 0.0)
    for law in SHAFT_LAWS:
        if law.slowing is not None:
            value = law.slowing(scene, shaft, value)
    return value
