"""Schedules: a quantity over time by its knots, linear or monotone cubic between them, once or again and again.

A schedule is a tuple of (time, value) pairs that knows its interpolation, after which time it repeats and from when its
times count. It may be given as a list of pairs, or as a table with columns; see `gearidae.scene.schedule_table`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from itertools import chain
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Final

import numpy as np
from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, PlainSerializer, TypeAdapter, WrapValidator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from gearidae.errors import SceneError
from gearidae.scene.quantity import Quantity
from gearidae.scene.schedule_table import pack_knots, read_schedule
from gearidae.scene.tables import CLOSEST_KNOTS, MOST_KNOTS, check_increasing, increasing, pairs

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

    Without knots, or with ``linear`` interpolation and nothing else, it equals a plain tuple of the same pairs.

    Attributes
    ----------
    interpolation : {"linear", "cubic"}
        Straight lines, or the monotone cubic of Fritsch and Carlson (`scipy.interpolate.PchipInterpolator`), which
        has no corners and never leaves the range of two neighbouring knots.
    repeat : float
        Time [s] after which everything comes again, before the first knot too; between the last knot and the first of
        the next cycle it is interpolated. 0 if the schedule holds its end values outside its knots.
    after : {"chain", "run"}
        Whether times count from the start of the first run of a chain, or of each run.
    """

    interpolation: str
    repeat: float
    after: str
    _plain: ClassVar[dict[str, Any]] = {"interpolation": "linear", "repeat": 0.0, "after": "chain"}

    def __new__(
        cls,
        knots: Iterable[tuple[float, float]] = (),
        interpolation: str = "linear",
        repeat: float = 0.0,
        after: str = "chain",
    ) -> Knots:
        """Make a schedule of pairs that have been checked.

        Raises
        ------
        ValueError
            If the knots do not fit into the time after which they repeat.
        """
        made = super().__new__(cls, tuple(knots))
        given = {"interpolation": interpolation, "repeat": repeat, "after": after}
        vars(made).update(given if len(made) > 0 else cls._plain)
        made._closes()
        return made

    def settings(self) -> dict[str, Any]:
        """Return what differs from a plain list of pairs, by the keys of a table."""
        return {key: value for key, value in vars(self).items() if value != self._plain[key]}

    def __eq__(self, other: object) -> bool:
        """Compare knots and all settings."""
        return tuple.__eq__(self, other) is True and self.settings() == (
            other.settings() if isinstance(other, Knots) else {}
        )

    def __ne__(self, other: object) -> bool:
        """Compare knots and all settings."""
        return not self == other

    def __hash__(self) -> int:
        """Hash as the plain tuple does."""
        return tuple.__hash__(self)

    @property
    def moves(self) -> bool:
        """Whether a run needs other knots than the run before, on the clock of their chain."""
        return self.repeat > 0.0 or self.after == "run"

    def cycle(self) -> Knots:
        """Return the knots of one cycle with the one that closes it; the schedule itself if it does not repeat."""
        if self.repeat == 0.0:
            return self
        closing = (self[0][0] + self.repeat, self[0][1])
        return Knots([*self[: len(self) - self._closes()], closing], self.interpolation)

    def during(self, begin: float, end: float, key: str = "schedule") -> Knots:
        """Return the schedule on the clock of a chain, as knots that say all of a run.

        Parameters
        ----------
        begin, end : float
            Of the run [s].
        key : str
            Name of the schedule in errors.

        Returns
        -------
        Knots
            Without repetition; that of another run has the same numbers, to the last bit, at the times of both.

        Raises
        ------
        SceneError
            If these are too many knots, or too close to each other so late in a chain.
        """
        if not self.moves:
            return self
        offset = begin if self.after == "run" else 0.0
        times, values = np.array(self.cycle()).T
        if self.repeat > 0.0:
            times, values = times[:-1], values[:-1]
            # a cycle more on both sides: the slope of a cubic at a knot depends on the knots beside it
            cycles = [math.floor((t - offset - times[0]) / self.repeat) for t in (begin, end)]
            count = cycles[1] - cycles[0] + 3
            if count * times.size > MOST_KNOTS:
                allowed = f"must be longer: it gives {count * times.size} knots, of which a run may have {MOST_KNOTS}"
                raise SceneError(f"{key}.repeat", self.repeat, allowed)
            starts = np.arange(cycles[0] - 1, cycles[1] + 2) * self.repeat
            times, values = (starts[:, None] + times).ravel(), np.tile(values, count)
        times = times + offset
        try:
            check_increasing(times)
        except ValueError as error:
            raise SceneError(key, f"knots at {begin:g} s and later", str(error)) from None
        return Knots(zip(times.tolist(), values.tolist(), strict=True), self.interpolation)

    def _closes(self) -> bool:
        """Whether the last knot is the first one of the next cycle, too."""
        if self.repeat == 0.0:
            return False
        (first, begins), (last, ends) = self[0], self[-1]
        left = self.repeat - (last - first)
        if left > CLOSEST_KNOTS * (first + self.repeat):
            return False
        if left < -CLOSEST_KNOTS * (first + self.repeat):
            raise ValueError(
                f"the knots take {last - first:g} s, more than the {self.repeat:g} s after which they repeat"
            )
        if ends != begins:
            raise ValueError(
                f"the last knot is the first of the next cycle and must have its value, {begins:g} in place of"
                f" {ends:g}; for a jump let it come a little earlier"
            )
        return True


def plain(knots: Iterable[tuple[float, float]]) -> Any:
    """Write knots as plain lists and texts, ready for JSON and exact to the last bit."""
    settings = knots.settings() if isinstance(knots, Knots) else {}
    pairs = tuple(knots)
    if len(pairs) > PACKED_ABOVE:
        return {"packed": pack_knots(pairs), "interpolation": "linear"} | settings
    numbers = [list(pair) for pair in pairs]
    return {"knots": numbers, **settings} if settings else numbers


def _reader(quantity: Quantity) -> WrapValidator:
    """Read whatever may stand for a schedule; the field's own types read pairs that hold more than plain numbers."""

    def read(value: object, handler: Any) -> Knots:
        pairs, settings = read_schedule(value, quantity.unit)
        if "repeat" in settings:
            settings["repeat"] = _period(settings["repeat"])
        knots = _plain_knots(pairs, quantity)
        return Knots(handler(pairs) if knots is None else knots, **settings)

    return WrapValidator(read)


def _period(value: object) -> float:
    """Read the time after which a schedule repeats."""
    try:
        period = _TIME.read(value)
    except ValueError as error:
        raise ValueError(f"repeat {error}") from None
    if period == 0.0:
        raise ValueError("repeat must be above 0 s")
    return period


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
        table = {
            "type": "object",
            "description": "a table with file or knots, interpolation, repeat and after",
        }
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
