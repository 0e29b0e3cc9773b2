"""All set-valued laws of a shaft, and the sums over them.

A shaft says which of them it has: the constant `resists` is the sum of 1, 2, 4.. by their order in the list.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

from gearidae.compiled import compiled
from gearidae.formulas.quadrature import Ends
from gearidae.laws.friction_law import FrictionLaw
from gearidae.laws.law import DRIVE, LOAD, ShaftLaw, Verb, in_turn, on_shaft
from gearidae.laws.shaft.dry_load import DRY_LOAD
from gearidae.laws.shafts import SHAFT_LAWS, has_law

if TYPE_CHECKING:
    from gearidae.engine.model.state import Model

FRICTION_LAWS: Final[tuple[FrictionLaw, ...]] = (DRY_LOAD,)
"""In the order of additions."""
LAWS_OF_SHAFTS: Final[tuple[ShaftLaw | FrictionLaw, ...]] = (*SHAFT_LAWS, *FRICTION_LAWS)
"""Laws with forces and set-valued ones, for the constants and keys that all of them declare."""
HELD_BY_LAWS: Final = sum({holder.number for law in FRICTION_LAWS for holder in law.holders})
"""All that they say when they hold, as a number of `gearidae.records.standing.Holding`."""


def _where_it_resists(law: FrictionLaw, verb: Verb | None) -> Verb | None:
    """Verb of a law, which is asked on the shafts that have the law only."""
    if verb is None:
        return None
    bit = 1 << FRICTION_LAWS.index(law)

    @compiled(inline=True)
    def ask(*arguments: Any) -> Any:
        value = arguments[-1]
        if arguments[0].scene.torque[arguments[1]].resists & bit != 0:
            value = verb(*arguments)
        return value

    return ask


def _least_of(law: FrictionLaw) -> Verb:
    """Smallest limit of a law at rest: its own verb, or its limit."""
    if law.least is not None:
        return law.least
    limit = law.limit

    @compiled(inline=True)
    def least(m: Any, shaft: int, t: float, angle: float, value: float) -> float:
        return limit(m, shaft, t, angle, 0.0, value)

    return least


def _sum(verbs: tuple[Verb | None, ...]) -> Any:
    return in_turn(
        tuple(_where_it_resists(law, verb) for law, verb in zip(FRICTION_LAWS, verbs, strict=True))
    )


_limits = _sum(tuple(law.limit for law in FRICTION_LAWS))
_least_limits = _sum(tuple(_least_of(law) for law in FRICTION_LAWS))
_begin = _sum(tuple(law.begin for law in FRICTION_LAWS))
_losses = _sum(tuple(law.loss for law in FRICTION_LAWS))
book_stop = _sum(tuple(law.book for law in FRICTION_LAWS))
"""Book the energy that a shaft loses which is brought to rest at once: (m, shaft, energy) -> what is left of it."""


@compiled(inline=True)
def resists(m: Model, shaft: int) -> bool:
    """Whether a shaft has any of these laws."""
    return bool(m.scene.torque[shaft].resists != 0)


@compiled(inline=True)
def law_limit(m: Model, shaft: int, t: float, angle: float, speed: float) -> float:
    """Largest force with which the laws of a shaft resist its turning, at a scaled time, an angle and a speed."""
    return _limits(m, shaft, t, angle, speed, -0.0)


@compiled
def least_law_limit(m: Model, shaft: int, t: float, angle: float) -> float:
    """Smallest `law_limit` of a shaft at rest whose harmonics are anywhere in their periods."""
    return _least_limits(m, shaft, t, angle, -0.0)


@compiled(inline=True)
def begin_friction(m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float) -> None:
    """Begin an interval of the energy balance."""
    _begin(m, shaft, t, angle, speed, acceleration, True)


@compiled(inline=True)
def book_friction(
    m: Model,
    shaft: int,
    h: float,
    t: float,
    angle: float,
    travel: float,
    speeds: Ends,
    value: tuple[float, float],
) -> tuple[float, float]:
    """Book the losses in an interval of the energy balance, and begin the next; add their magnitudes and errors."""
    return _losses(m, shaft, h, t, angle, travel, speeds, value)


def has_friction_law(scene: Any, shaft: int, law: FrictionLaw) -> bool:
    """Whether a scene has a law on a shaft."""
    if law.there is not None:
        return law.there(scene, shaft)
    return scene.gears is not None and has_law(scene, shaft, law)


def friction_laws_of(scene: Any, shaft: int) -> tuple[FrictionLaw, ...]:
    """List the laws that a scene has on a shaft."""
    return tuple(law for law in FRICTION_LAWS if has_friction_law(scene, shaft, law))


def bits_of(laws: tuple[FrictionLaw, ...]) -> int:
    """Return the number by which a shaft says that it has some laws."""
    return sum(1 << FRICTION_LAWS.index(law) for law in laws)


def key_of(law: FrictionLaw) -> str:
    """Key that asks for a law."""
    return law.key or f"gears.{on_shaft(LOAD, law.coefficients[0].name)}"


def asks_for(scene: Any, law: FrictionLaw) -> bool:
    """Whether a scene has a law on any shaft."""
    return any(has_friction_law(scene, shaft, law) for shaft in (DRIVE, LOAD))


def mean_limit(scene: Any, shaft: int, average: Callable[..., float]) -> float:
    """Sum of the mean limits of a shaft's laws over a run [N m]."""
    return sum(
        law.mean(scene, shaft, average) for law in friction_laws_of(scene, shaft) if law.mean is not None
    )


def largest_limit(scene: Any, shaft: int) -> float:
    """Sum of the bounds of the limits of a shaft's laws, besides those of its torques [N m]."""
    return sum(law.largest(scene, shaft) for law in friction_laws_of(scene, shaft) if law.largest is not None)
