"""What a law is, and how laws add up.

A law declares the fields that it needs in the records of a run, and has compiled functions, its verbs. A verb takes
what it is asked about and, last, what the laws before it in the list have said, and returns that with its own added.
So a sum over laws is one function after the other, and the order of the list is the order of additions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from typing import Any, Final, NamedTuple, TypeAlias

from gearidae.compiled import compiled

Verb: TypeAlias = Callable[..., Any]

DRIVE: Final = 0
LOAD: Final = 1
"""Shafts: the pinion's and the gear's."""

SPEED: Final = 2
SCHEDULES: Final = 3
"""The speed that a drive holds among the schedules, beside both torques; and how many there are."""

REAL: Final = "f8"
INT: Final = "i8"


class Range(NamedTuple):
    """What changes of a shaft's torque over a time in which schedules go one way.

    Attributes
    ----------
    moving : float
        What harmonics add to the torque at the beginning.
    swing : float
        The largest size that they can have.
    low, high : float
        How far schedules change it downwards and upwards.
    """

    moving: float
    swing: float
    low: float
    high: float


@dataclass(frozen=True)
class Coefficient:
    """A constant of a law that is a key of a scene's table: torque over a power of the angular speed.

    Attributes
    ----------
    name : str
        Of the key and of the field among the constants of a shaft.
    power : int
        Of the speed.
    """

    name: str
    power: int

    def scaled(self, value: float, radius: float, speed: float, force: float) -> float:
        """Force at the base circle over that power of its speed, in units of speed and force; radius [m], all SI."""
        return value / radius ** (self.power + 1) * speed**self.power / force


@dataclass(frozen=True)
class ShaftLaw:
    """A law of a shaft. A verb that it has no use for is left out, and adds nothing.

    Forces are torques over the base radius, in the sense of the shaft's own turning; speeds are those of the base
    circles, all scaled. `m` is the model of a run, `shaft` is `DRIVE` or `LOAD`, `t` the time, `angle` [rad] and
    `speed` those of the shaft.

    Attributes
    ----------
    name : str
    drives : bool
        Whether its work is that of the drive. At the gear such a law is a part of the dry resistance, which is
        set-valued. All others act as they are on either shaft, and book their own losses.
    fields : tuple of (name, type)
        Constants of a shaft, in ``SCENE.torque``.
    coefficients : tuple of Coefficient
        Constants that keys of a scene say; fields, too.
    force : (m, shaft, t, angle, speed, value) -> value
    rate : (m, shaft, t, angle, speed, acceleration, value) -> value
        Of the force along the motion.
    by_speed : (m, shaft, angle, speed, value) -> value
        Slope of the force in the speed, of a law that is not mild: Newton's iteration reduces what is left by the ratio
        of a step to the time in which the law would stop a shaft.
    is_constant : (m, shaft, value) -> value
        Whether the force never changes.
    is_steady : (m, shaft, t, value) -> value
        Whether that of a shaft that does not turn stays until a schedule enters its next segment.
    range : (m, shaft, t, to, value) -> value
        Adds to a `Range`.
    loss : (m, shaft, h, travel, turn, value) -> value
        Books its loss in a step of the length h, from the travel of the base circle and its speed and rate at both
        ends, and adds it; errors are booked, too.
    slowing : (scene, shaft, value) -> value
        Adds to torques over angular speed and over its square [SI], at which a mean speed is reached. In Python.
    """

    name: str
    force: Verb
    drives: bool = False
    fields: tuple[tuple[str, str], ...] = ()
    coefficients: tuple[Coefficient, ...] = ()
    rate: Verb | None = None
    by_speed: Verb | None = None
    is_constant: Verb | None = None
    is_steady: Verb | None = None
    range: Verb | None = None
    loss: Verb | None = None
    slowing: Verb | None = None


def in_turn(verbs: tuple[Verb | None, ...]) -> Any:
    """Make one compiled function of verbs that are called one after the other, each with what the last has returned."""
    first, *others = (verb for verb in verbs if verb is not None)
    return reduce(_after, others, first)


def _after(before: Verb, verb: Verb) -> Verb:
    # closures, and not code that is put together: numba keeps each on disk by what it closes over
    @compiled(inline=True)
    def both(*arguments: Any) -> Any:
        return verb(*arguments[:-1], before(*arguments))

    return both
