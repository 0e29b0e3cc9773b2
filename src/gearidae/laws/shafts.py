"""All laws of a shaft, and their sums.

The first laws drive: they are the torque of the drive at the pinion, and at the gear the limit of the dry load. The
others act on either shaft as they are. Set-valued laws have a list of their own (`gearidae.laws.frictions`). Sums of
forces begin at -0.0, to which adding a number gives that number; those of rates and losses begin at 0.0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from gearidae.compiled import compiled
from gearidae.formulas.quadrature import Ends
from gearidae.laws.law import DRIVE, SHAFT_NAMES, Range, ShaftLaw, Verb, in_turn, number_of, on_shaft
from gearidae.laws.shaft.constant import CONSTANT
from gearidae.laws.shaft.drag import DRAG
from gearidae.laws.shaft.harmonic import HARMONICS, ORDERS
from gearidae.laws.shaft.held_speed import HELD_SPEED
from gearidae.laws.shaft.own import OWN, last_on_its_side
from gearidae.laws.shaft.schedule import SCHEDULE
from gearidae.laws.shaft.spring import SPRING

if TYPE_CHECKING:
    from gearidae.engine.model.state import Model
    from gearidae.laws.friction_law import FrictionLaw
    from gearidae.scene import GearScene

SHAFT_LAWS: Final[tuple[ShaftLaw, ...]] = (
    CONSTANT,
    HARMONICS,
    SCHEDULE,
    OWN,
    ORDERS,
    HELD_SPEED,
    DRAG,
    SPRING,
)
"""In the order of additions."""

_DRIVING = tuple(law for law in SHAFT_LAWS if law.drives)
ACTING: Final = tuple(law for law in SHAFT_LAWS if not law.drives)
"""A shaft says which of these it has: the constant `acts` is the sum of 1, 2, 4.. by their order here."""


def _bit(law: ShaftLaw) -> int:
    return 1 << ACTING.index(law)


def _where_it_acts(law: ShaftLaw, verb: Verb | None) -> Verb | None:
    """Verb of a law that acts, which is asked on the shafts that have the law only: most have few of them."""
    if verb is None:
        return None
    bit = _bit(law)

    @compiled(inline=True)
    def ask(*arguments: Any) -> Any:
        value = arguments[-1]
        if arguments[0].scene.torque[arguments[1]].acts & bit != 0:
            value = verb(*arguments)
        return value

    return ask


def _acting(name: str) -> tuple[Verb | None, ...]:
    """Verbs of one name of the laws that act."""
    return tuple(_where_it_acts(law, getattr(law, name)) for law in ACTING)


_driving = in_turn(tuple(law.force for law in _DRIVING))
_driving_rate = in_turn(tuple(law.rate for law in _DRIVING))
_constant = in_turn(tuple(law.is_constant for law in _DRIVING))
_steady = in_turn(tuple(law.is_steady for law in _DRIVING))
_range = in_turn(tuple(law.range for law in _DRIVING))
acting = in_turn(_acting("force"))
"""Add what acts on a shaft besides its driving torque: (m, shaft, t, angle, speed, value) -> value."""
by_speed = in_turn((*(law.by_speed for law in _DRIVING), *_acting("by_speed")))
"""Add the slopes of all forces on a shaft in its speed: (m, shaft, angle, speed, value) -> value."""
by_angle = in_turn(_acting("by_angle"))
"""Add the slopes of what acts on a shaft in its angle [1/rad]: (m, shaft, angle, speed, value) -> value."""
_losses = in_turn(_acting("loss"))
stored_by_laws = in_turn(_acting("energy"))
"""Add the energies that laws of a shaft store: (m, shaft, angle, value) -> value."""
guard = in_turn(_acting("guard"))
"""Take the least distance of the laws of a shaft to their next switch: (m, shaft, angle, speed, value) -> value."""
switch = in_turn(_acting("switch"))
"""Switch the first law whose guard has fallen: (m, shaft, angle, speed, -1) -> number of its event, -1 if none has."""


def _writer(law: ShaftLaw) -> Verb:
    """Verb that writes the torque of a law into a row of samples, where a shaft has it; `value` is the column there."""
    force, bit = law.force, _bit(law)

    @compiled
    def write(m: Any, shaft: int, t: float, angle: float, speed: float, row: Any, value: int) -> int:
        torque = m.scene.torque[shaft]
        if torque.acts & bit == 0:
            return value
        radius = m.scene.length_unit / torque.angle_unit
        row[value] = force(m, shaft, t, angle, speed, -0.0) * m.scene.force_unit * radius
        return value + 1

    return write


SAMPLED: Final = tuple(law for law in ACTING if law.sample is not None)
write_samples = in_turn(tuple(_writer(law) for law in SAMPLED))
"""Write the torques of all sampled laws of a shaft: (m, shaft, t, angle, speed, row, column) -> next column."""


@compiled(inline=True)
def driving_force(m: Model, shaft: int, t: float, angle: float, speed: float) -> float:
    """Driving torque over base radius and reference load, at a scaled time, an angle [rad] and a scaled speed."""
    return _driving(m, shaft, t, angle, speed, -0.0)


@compiled(inline=True)
def pinion_force(m: Model, t: float, angle: float, speed: float) -> float:
    """Driving torque on the pinion with all that acts there as it is, over its base radius and the reference load."""
    value = driving_force(m, DRIVE, t, angle, speed)
    if m.scene.torque[DRIVE].acts != 0:
        value = acting(m, DRIVE, t, angle, speed, value)
    return value


@compiled
def driving_rate(m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float) -> float:
    """Rate of change of `driving_force` along the motion."""
    return _driving_rate(m, shaft, t, angle, speed, acceleration, 0.0)


@compiled
def is_constant(m: Model, shaft: int) -> bool:
    """Whether a shaft's driving torque never changes."""
    return bool(_constant(m, shaft, True))


@compiled
def driving_along(
    m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float
) -> tuple[float, float]:
    """`driving_force`, and its rate along the motion; where a law of a user jumps, both of the side before."""
    if is_constant(m, shaft):
        return m.scene.torque[shaft].constant, 0.0
    then, angle, speed = last_on_its_side(m, shaft, t, angle, speed, acceleration)
    rate = driving_rate(m, shaft, then, angle, speed, acceleration)
    return driving_force(m, shaft, then, angle, speed) + (t - then) * rate, rate


@compiled
def is_steady(m: Model, shaft: int, t: float) -> bool:
    """Whether the torque of a shaft that does not turn stays as it is until a schedule enters its next segment."""
    return bool(_steady(m, shaft, t, True))


@compiled
def driving_range(m: Model, shaft: int, t: float, to: float, angle: float) -> tuple[float, float]:
    """Bounds of `driving_force` at rest over a time in which schedules go one way; without a law of a user."""
    changes = _range(m, shaft, t, to, Range(0.0, 0.0, 0.0, 0.0))
    middle = driving_force(m, shaft, t, angle, 0.0) - changes.moving
    return middle - changes.swing + changes.low, middle + changes.swing + changes.high


@compiled(inline=True)
def book_losses(m: Model, shaft: int, h: float, angle: float, travel: float, speeds: Ends) -> float:
    """Book the losses of what acts on a shaft in a step of the length h, and return them."""
    return _losses(m, shaft, h, angle, travel, speeds, 0.0)


def has_law(scene: Any, shaft: int, law: ShaftLaw | FrictionLaw) -> bool:
    """Whether a key of a law in the gears' table is not 0 for a shaft."""
    return any(number_of(scene, shaft, constant.name) != 0.0 for constant in law.coefficients if constant.key)


def sampled_laws(scene: Any) -> tuple[str, ...]:
    """Names of the columns that laws of the shafts sample of a scene, in the order in which they are written."""
    return tuple(
        on_shaft(shaft, law.sample.name)
        for shaft in range(len(SHAFT_NAMES))
        for law in SAMPLED
        if law.sample is not None and has_law(scene, shaft, law)
    )


def is_held(scene: GearScene) -> bool:
    """Whether a law of a shaft keeps the gears from turning on for ever."""
    return any(law.holds(scene, shaft) for law in SHAFT_LAWS if law.holds is not None for shaft in range(2))


def slowing(scene: GearScene, shaft: int) -> tuple[float, float]:
    """Torques of all laws that slow a shaft down, over its angular speed and over the square of that [SI]."""
    value = (0.0, 0.0)
    for law in SHAFT_LAWS:
        if law.slowing is not None:
            value = law.slowing(scene, shaft, value)
    return value
