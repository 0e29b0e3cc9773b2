"""Quantities of a run, each declared once: type, unit, meaning, part in the energy balance and name in an archive.

The records of the engine, the scaling to SI units and to the units of a continued run, the variables of an archive, the
terms of the energy balance and the tables of the reference follow from the declarations.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import KW_ONLY, dataclass
from functools import partial
from typing import Any, Final

import numpy as np

REAL: Final = "f8"
INT: Final = "i8"
"""Types of numbers."""


@dataclass(frozen=True, slots=True)
class Unit:
    """Unit of a scaled quantity.

    Attributes
    ----------
    scaled : str
        In units of the scene: its length sigma, time tau and force F.
    si : str
        The same as UDUNITS.
    force, length, time : int
        Powers of the scene's units in it.
    radius : int
        Power of the gear's base radius, where an angular speed is scaled as a surface speed.
    """

    scaled: str
    si: str = "1"
    force: int = 0
    length: int = 0
    time: int = 0
    radius: int = 0

    def in_si(self, scene: Any) -> float:
        """Return the unit in SI units, from the units of a scene, the engine's record ``SCENE``."""
        above = below = 1.0
        for power, unit in (
            (self.force, scene.force_unit),
            (self.length, scene.length_unit),
            (self.time, scene.time_unit),
            (self.radius, scene.gear_radius),
        ):
            if power > 0:
                above *= float(unit) ** power
            elif power < 0:
                below *= float(unit) ** -power
        return above / below

    def ratio(self, force: float, time: float) -> float:
        """Factor of a scaled number in other units of force and time, for their ratios, old over new; lengths stay."""
        ratio = force**self.force
        for _ in range(abs(self.time)):
            ratio *= time if self.time > 0 else 1.0 / time
        return ratio


NUMBER: Final = Unit("1")
PITCHES: Final = Unit("pb")
LENGTH: Final = Unit("sigma", "m", length=1)
TIME: Final = Unit("tau", "s", time=1)
SPEED: Final = Unit("sigma/tau", "m s-1", length=1, time=-1)
GEAR_SPEED: Final = Unit("sigma/tau", "rad s-1", length=1, time=-1, radius=-1)
FORCE: Final = Unit("F", "N", force=1)
ENERGY: Final = Unit("F sigma", "J", force=1, length=1)
POWER: Final = Unit("F sigma/tau", "W", force=1, length=1, time=-1)
POWER_RATE: Final = Unit("F sigma/tau^2", "W s-1", force=1, length=1, time=-2)
SECONDS: Final = Unit("s", "s")
TORQUE: Final = Unit("N m", "N m")
"""Units of what is not scaled."""

COUNT_HIGH: Final = 2**53
"""Counts beyond which a double no longer counts."""
LARGEST: Final = 1e200
"""Numbers of which squares are still finite."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """Declaration of a quantity, a field of a record.

    Attributes
    ----------
    name : str
        Of the field.
    meaning : str
        In words.
    unit : Unit, optional
    kind : str, or tuple of Quantity, optional
        `REAL` or `INT`, or the fields of a record within the record.
    shape : tuple of int, optional
        Of an array; empty for a number.
    archive : mapping of str to str, str or bool, optional
        Name in an archive and meaning there of each number; empty for what stays in the engine. A number may have
        its own name and meaning (true), or its meaning by another name.
    comment : str, optional
        What an archive adds to the meaning.
    sign : int, optional
        In the energy balance: 1 of a work, -1 of a loss or of energy that is stored, 0 of anything else.
    group : str, optional
        Losses that are added up for the run summary: ``useful`` or ``friction``; empty for others.
    remark : str, optional
        What a summary adds to a term of the balance.
    since : str, optional
        Version that began to archive it; empty for the first.
    low, high : number, or callable, optional
        Bounds in a checkpoint, of a scene's ``SCENE`` where callable: of whole numbers, and of the size of others.
    """

    name: str
    meaning: str
    unit: Unit = NUMBER
    _: KW_ONLY
    kind: str | tuple[Quantity, ...] = REAL
    shape: tuple[int, ...] = ()
    archive: Any = False
    comment: str = ""
    sign: int = 0
    group: str = ""
    remark: str = ""
    since: str = ""
    low: int = 0
    high: Any = None

    def __post_init__(self) -> None:
        """Give each archived number its name and meaning, and all numbers a bound."""
        if not isinstance(self.archive, Mapping):
            name = self.name if self.archive is True else self.archive
            object.__setattr__(self, "archive", {name: self.meaning} if name else {})
        if self.high is None:
            object.__setattr__(self, "high", LARGEST if self.kind == REAL else COUNT_HIGH)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the numbers in an archive; of what stays in the engine, of the field."""
        return tuple(self.archive) or (self.name,)


count = partial(Quantity, kind=INT)
"""A whole number."""
flag = partial(Quantity, kind=INT, high=1)
"""0 or 1."""


def convert(fields: Iterable[Quantity], record: Any, force: float, time: float) -> None:
    """Put a record into other units of force and time, in place, for their ratios, old over new."""
    for field in fields:
        if isinstance(field.kind, tuple):
            convert(field.kind, record[field.name], force, time)
        elif (ratio := field.unit.ratio(force, time)) != 1.0:
            record[field.name] *= ratio


def in_si(quantities: Iterable[Quantity], record: Any, scene: Any) -> dict[str, Any]:
    """Return the numbers of a record in SI units by their `Quantity.names`.

    Parameters
    ----------
    quantities : iterable of Quantity
        Fields of the record.
    record, scene : record
        The second holds the units, as for `Unit.in_si`.
    """
    numbers: dict[str, Any] = {}
    factors: dict[Unit, float] = {}  # dozens of quantities have one of a few units
    for quantity in quantities:
        if quantity.unit not in factors:
            factors[quantity.unit] = quantity.unit.in_si(scene)
        unit = factors[quantity.unit]
        found, number = record[quantity.name], int if quantity.kind == INT else float
        # no array for a single number: there are dozens of them at the end of each run
        values = np.ravel(found).tolist() if quantity.shape else (number(found),)
        for name, value in zip(quantity.names, values, strict=True):
            # the same object for each missing number, so that equal numbers compare equal
            numbers[name] = value if quantity.kind == INT else math.nan if math.isnan(value) else unit * value
    return numbers


class Totals(dict[str, Any]):
    """Numbers of a run by their names, which are attributes as well."""

    __slots__ = ()

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"{type(self).__name__} has no {name}") from None
