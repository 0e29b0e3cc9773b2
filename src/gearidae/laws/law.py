"""What a law is, and how laws add up.

A law declares the fields that it needs in the records of a run, and has compiled functions, its verbs. A verb takes
what it is asked about and, last, what the laws before it in the list have said, and returns that with its own added.
So a sum over laws is one function after the other, and the order of the list is the order of additions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
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

SHAFT_NAMES: Final = ("pinion", "gear")
"""Of the shafts, with which the keys, samples and events of their laws begin."""


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


@dataclass(frozen=True, kw_only=True)
class Key:
    """A key of a law, from 0 to a bound, 0 by default: of either shaft ``gears.gear_NAME``, of a mesh ``mesh.NAME``.

    Attributes
    ----------
    unit : str
        SI unit in pint's spelling.
    description : str
        What it means; ``{shaft}`` stands for the shaft's name.
    at_most : float
        Largest number.
    example : float
        Of a polysilicon microgear, for the tests of laws against each other.
    least : float, optional
        Smallest number that is not 0.
    shown : tuple of (str, int), optional
        Unit in which a case file shows it, and the power of ten that this unit is.
    """

    unit: str = field(kw_only=False)
    description: str = field(kw_only=False)
    at_most: float
    example: float
    least: float | None = None
    shown: tuple[str, int] | None = None


@dataclass(frozen=True)
class Coefficient:
    """A constant of a law that is a key of a scene: torque over a power of the angular speed.

    Attributes
    ----------
    name : str
        Of the key and of the field among the constants of a shaft.
    power : int, optional
        Of the speed; None for a number that is no torque, and is not scaled.
    key : Key, optional
        Declaration of the key of the gears; without one it is a key of the tables of drive or load.
    """

    name: str
    power: int | None
    key: Key | None = None

    def scaled(self, value: float, radius: float, speed: float, force: float) -> float:
        """Force at the base circle over that power of its speed, in units of speed and force; radius [m], all SI."""
        if self.power is None:
            return value
        return value / radius ** (self.power + 1) * speed**self.power / force


class Memory(NamedTuple):
    """A whole number that a law remembers of a shaft, in ``STATE.shaft``; 0 at the start of a chain of runs.

    Attributes
    ----------
    name, meaning : str
    low, high : int
        Bounds, in a checkpoint.
    """

    name: str
    meaning: str
    low: int
    high: int


class Loss(NamedTuple):
    """A term of the energy balance that a law books, in ``STATE.energy``.

    Attributes
    ----------
    name, meaning : str
        Also in an archive.
    since : str
        Version that began to archive it; empty for the first.
    group : str
        Of losses that are added up for the run summary: ``useful`` or ``friction``; empty for others.
    """

    name: str
    meaning: str
    since: str = "0.3"
    group: str = ""


class Sample(NamedTuple):
    """A sampled column with the torque of a law on a shaft that has it, with the shaft's name before its own.

    Attributes
    ----------
    name, meaning : str
        ``{shaft}`` stands in the meaning for the shaft's name.
    """

    name: str
    meaning: str


class ShaftEvent(NamedTuple):
    """A kind of event of either shaft: ``EventKind`` has it with the shaft's name before its own.

    Attributes
    ----------
    name : str
    pinion, gear : int
        Numbers of the kinds, which stay as they are in archives.
    """

    name: str
    pinion: int
    gear: int

    @property
    def numbers(self) -> tuple[int, int]:
        """Numbers of the kinds, by shaft."""
        return self.pinion, self.gear


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
        Whether its work counts as the drive's. At the gear such a law is a part of the dry load, which is set-valued
        (`gearidae.laws.shaft.dry_load`). All others act as they are on either shaft, book their own losses, and at rest
        do not change.
    fields : tuple of (name, type)
        Constants of a shaft, in ``SCENE.torque``.
    coefficients : tuple of Coefficient
        Constants that keys of a scene say; fields, too.
    memory : tuple of Memory
        What it remembers between events, for a force that is smooth within a step.
    losses : tuple of Loss
    events : tuple of ShaftEvent
    sample : Sample, optional
    force : (m, shaft, t, angle, speed, value) -> value
    rate : (m, shaft, t, angle, speed, acceleration, value) -> value
        Of the force along the motion.
    by_speed : (m, shaft, angle, speed, value) -> value
        Slope of the force in the speed, of a law that is not mild: Newton's iteration reduces what is left by the ratio
        of a step to the time in which the law would stop a shaft.
    by_angle : (m, shaft, angle, speed, value) -> value
        Slope of the force in the angle [1/rad], of a law that is not mild. A law with this verb is told the angle.
    is_constant : (m, shaft, value) -> value
        Whether the force never changes.
    is_steady : (m, shaft, t, value) -> value
        Whether that of a shaft that does not turn stays until a schedule enters its next segment.
    range : (m, shaft, t, to, value) -> value
        Adds to a `Range`.
    energy : (m, shaft, angle, value) -> value
        Energy that it stores.
    loss : (m, shaft, h, angle, travel, turn, value) -> value
        Books its loss in a step of the length h, from the angle at its end, the travel of the base circle and its speed
        and rate at both ends, and adds it; errors are booked, too.
    guard : (m, shaft, angle, speed, value) -> value
        Least of the value and of its distance to its next switch, above 0 while that waits and smooth within a step.
    switch : (m, shaft, angle, speed, value) -> value
        Switches where the guard has fallen and returns the number of its event; a value of 0 or more is that of a
        law that has switched just before, and is returned as it is. The integration begins anew.
    holds : (scene, shaft) -> bool
        Whether the shaft cannot turn on for ever. In Python.
    slowing : (scene, shaft, value) -> value
        Adds to torques over angular speed and over its square [SI], at which a mean speed is reached. In Python.
    """

    name: str
    force: Verb
    drives: bool = False
    fields: tuple[tuple[str, str], ...] = ()
    coefficients: tuple[Coefficient, ...] = ()
    memory: tuple[Memory, ...] = ()
    losses: tuple[Loss, ...] = ()
    events: tuple[ShaftEvent, ...] = ()
    sample: Sample | None = None
    rate: Verb | None = None
    by_speed: Verb | None = None
    by_angle: Verb | None = None
    is_constant: Verb | None = None
    is_steady: Verb | None = None
    range: Verb | None = None
    energy: Verb | None = None
    loss: Verb | None = None
    guard: Verb | None = None
    switch: Verb | None = None
    holds: Callable[[Any, int], bool] | None = None
    slowing: Verb | None = None


def on_shaft(shaft: int, name: str) -> str:
    """Return the name of a key, a sample or an event of a shaft, with the shaft's name before its own."""
    return f"{SHAFT_NAMES[shaft]}_{name}"


def number_of(scene: Any, shaft: int, name: str) -> float:
    """Number of a key of a shaft in the gears' table, see `Key`."""
    return float(getattr(scene.gears, on_shaft(shaft, name)))


def in_turn(verbs: tuple[Verb | None, ...]) -> Any:
    """Make one compiled function of verbs that are called one after the other, each with what the last has returned."""
    *others, last = (verb for verb in verbs if verb is not None)
    return reduce(_before, reversed(others), last)


def _before(rest: Verb, verb: Verb) -> Verb:
    # closures, and not code that is put together: numba keeps each on disk by what it closes over; the first verb is
    # outermost, so that the code of the first ones, the longest, is compiled into one closure and not into all
    @compiled(inline=True)
    def both(*arguments: Any) -> Any:
        return rest(*arguments[:-1], verb(*arguments))

    return both
