"""Schedules: a quantity over time by its knots, linear or monotone cubic between them.

A schedule is a tuple of (time, value) pairs that knows its interpolation. It may be given as a list of pairs, or as a
table with columns; see `gearidae.scene.schedule_table`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import chain
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Final

import numpy as np
from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, PlainSerializer, TypeAdapter, WrapValidator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from gearidae.scene.quantity import Quantity
from gearidae.scene.schedule_table import pack_knots, read_schedule
from gearidae.scene.tables import MOST_KNOTS, check_increasing, increasing, pairs

__all__ = [
    "INTERPOLATIONS",
    "Knots",
    "Resistance",
    "ResistanceSchedule",
    "Schedule",
    "Scheduled",
    "Time",
    "Torque",
]

INTERPOLATIONS: Final = ("linear", "cubic")
PACKED_ABOVE: Final = 500
"""Knots from which on plain tables hold them packed: as decimals they take 45 bytes each."""


class Knots(tuple[tuple[float, float], ...]):
    """Knots of a schedule, (time [s], value [SI]) each, with the interpolation between them.

    Without knots, or with ``linear`` interpolation, it equals a plain tuple of the same pairs.

    Attributes
    ----------
    interpolation : {"linear", "cubic"}
        Straight lines, or the monotone cubic of Fritsch and Carlson (`scipy.interpolate.PchipInterpolator`), which
        has no corners and never leaves the range of two neighbouring knots.
    """

    interpolation: str
    _plain: ClassVar[str] = "linear"

    def __new__(cls, knots: Iterable[tuple[float, float]] = (), interpolation: str = "linear") -> Knots:
        """Make a schedule of pairs that have been checked."""
        made = super().__new__(cls, tuple(knots))
        made.interpolation = interpolation if len(made) > 0 else cls._plain
        return made

    def __eq__(self, other: object) -> bool:
        """Compare knots and interpolation."""
        return tuple.__eq__(self, other) is True and self.interpolation == getattr(
            other, "interpolation", self._plain
        )

    def __ne__(self, other: object) -> bool:
        """Compare knots and interpolation."""
        return not self == other

    def __hash__(self) -> int:
        """Hash as the plain tuple does."""
        return tuple.__hash__(self)


def plain(knots: Iterable[tuple[float, float]]) -> Any:
    """Write knots as plain lists and texts, ready for JSON and exact to the last bit."""
    interpolation = getattr(knots, "interpolation", "linear")
    pairs = tuple(knots)
    if len(pairs) > PACKED_ABOVE:
        return {"packed": pack_knots(pairs), "interpolation": interpolation}
    numbers = [list(pair) for pair in pairs]
    return numbers if interpolation == "linear" else {"knots": numbers, "interpolation": interpolation}


def _reader(quantity: Quantity) -> WrapValidator:
    """Read whatever may stand for a schedule; the field's own types read pairs that hold more than plain numbers."""

    def read(value: object, handler: Any) -> Knots:
        pairs, interpolation = read_schedule(value, quantity.unit)
        knots = _plain_knots(pairs, quantity)
        return Knots(handler(pairs) if knots is None else knots, interpolation)

    return WrapValidator(read)


def _plain_knots(pairs: object, quantity: Quantity) -> Iterable[tuple[float, float]] | None:
    """Check pairs of plain numbers all at once; None if one of them is not as it must be."""
    if not isinstance(pairs, (list, tuple)) or not 0 < len(pairs) <= MOST_KNOTS:
        return None
    try:
        if not set(map(type, chain.from_iterable(pairs))) <= {float, int} or set(map(len, pairs)) != {2}:
            return None
        times, values = np.array(pairs, np.float64).T
    except (TypeError, OverflowError):
        return None
    if not (_TIME.admits_all(times) and quantity.admits_all(values)):
        return None
    check_increasing(times)
    return zip(times.tolist(), values.tolist(), strict=True)


class _OrTable:
    """Says in the JSON Schema that a table may stand for the pairs."""

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Describe what may stand here."""
        table = {"type": "object", "description": "a table with file or knots, and their interpolation"}
        return {"anyOf": [handler(core), table]}


def _schedule(quantity: Quantity) -> Any:
    """Return the type of a schedule of a quantity."""
    pair = tuple[Time, Annotated[float, quantity]]
    return Annotated[
        tuple[pair, ...], pairs, increasing, _reader(quantity), PlainSerializer(plain), _OrTable()
    ]


_TIME: Final = Quantity(unit="s", at_least=0, at_most=1e12, least=1e-20)
_TORQUE: Final = Quantity(unit="N m", at_least=-1e9, at_most=1e9, least=1e-40)
_RESISTANCE: Final = replace(_TORQUE, at_least=0)
_SPEED: Final = Quantity(unit="rad/s", at_least=-1e12, at_most=1e12, least=1e-30)
Time = Annotated[float, _TIME]
Torque = Annotated[float, _TORQUE]
Resistance = Annotated[float, _RESISTANCE]
if TYPE_CHECKING:
    Schedule = Knots  # what every reader ends with
    ResistanceSchedule = Knots
else:
    Schedule = _schedule(_TORQUE)
    ResistanceSchedule = _schedule(_RESISTANCE)
_SPEEDS: Final[TypeAdapter[Any]] = TypeAdapter(_schedule(_SPEED))


class Scheduled(Quantity):
    """An angular speed in SI units, or a schedule of it."""

    def read(self, value: object) -> Any:
        """Read a number, a text with a unit, or whatever may stand for a schedule.

        Parameters
        ----------
        value : object
            What the user gave.

        Returns
        -------
        float or Knots

        Raises
        ------
        ValueError
            Saying what is allowed.
        """
        if (
            isinstance(value, (list, tuple, dict))
            or hasattr(value, "columns")
            or getattr(value, "ndim", 0) > 0
        ):
            return _SPEEDS.validate_python(value)
        return Quantity.read(self, value)

    def allowed(self) -> str:
        """Return what may stand here, in words."""
        return Quantity.allowed(self) + ", or a schedule of it"

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Describe what may stand here."""
        number = Quantity.__get_pydantic_json_schema__(self, core, handler)
        return {"anyOf": [*number["anyOf"], *_SPEEDS.json_schema()["anyOf"]]}

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Let pydantic call `read`, and write schedules as `plain` does."""

        def write(value: Any) -> Any:
            return plain(value) if isinstance(value, tuple) else value

        return core_schema.no_info_plain_validator_function(
            self.read, serialization=core_schema.plain_serializer_function_ser_schema(write)
        )
