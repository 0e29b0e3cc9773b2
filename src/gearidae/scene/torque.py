"""What drives the pinion and what loads the gear.

Both torques are a constant, plus harmonics, plus a schedule, linear or monotone cubic between its knots, that holds its
end values outside them (Teodorescu et al. 2009, Eqs. 2 and 3), plus a law of time, angle and speed by its name
(`gearidae.torques`). A drive may hold a speed besides, ``gain (w(t) - w1)``, the torque-speed line of a motor. The
gear's motion is resisted by a quadratic and a viscous drag.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Final, Self

from pydantic import BeforeValidator, ConfigDict, Field, TypeAdapter, ValidationError, model_validator

from gearidae.errors import SceneError
from gearidae.scene.gears import HubRadius
from gearidae.scene.group import Group, shorten
from gearidae.scene.knots import Knots, Resistance, ResistanceSchedule, Schedule, Scheduled, Time, Torque
from gearidae.scene.named import Named
from gearidae.scene.quantity import Phase, Quantity
from gearidae.scene.surface import AgeingTime, MemoryLength, OptionalFriction, OptionalRise
from gearidae.scene.tables import increasing, one_or_more, pairs
from gearidae.scene.units import to_si
from gearidae.torques import Parameter, torque_law, torque_names

_SCHEDULE = (
    "torque over time, added to the constant: [time, torque] knots, or a table with columns; repeat, after"
)


class Harmonic(Group):
    """One harmonic of a torque, ``amplitude cos(2 pi frequency t + phase)`` or ``amplitude cos(order angle + phase)``.

    The angle is that of the shaft since the start of the first run of a chain.
    """

    amplitude: Torque = Field(description="amplitude")
    frequency: Annotated[float | None, Quantity(unit="Hz", at_least=0, at_most=1e18, shown=("kHz", 3))] = (
        Field(default=None, description="frequency in time; this or the order")
    )
    order: Annotated[float | None, Quantity(unit="1", at_least=0, at_most=1e6)] = Field(
        default=None, description="periods in a turn of the shaft; this or the frequency"
    )
    phase: Phase = Field(default=0.0, description="phase")

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        """Let a harmonic follow either the time or the angle."""
        if (self.frequency is None) == (self.order is None):
            raise SceneError(
                "frequency",
                "(missing)" if self.frequency is None else self.frequency,
                "give either the frequency in time or the order, periods in a turn of the shaft",
            )
        return self


Harmonics = Annotated[tuple[Harmonic, ...], one_or_more("amplitude, frequency or order, phase")]


def _as_numbers(value: object) -> object:
    """Accept one number, a list of them, or an array; what it holds is read later."""
    value = value.tolist() if hasattr(value, "tolist") else value
    return tuple(value) if isinstance(value, (list, tuple)) else (value,)


_KNOTS: Final[TypeAdapter[Any]] = TypeAdapter(
    Annotated[tuple[tuple[Time, Annotated[float, Quantity(unit="1")]], ...], pairs, increasing]
)


def _read_parameter(parameter: Parameter, value: object) -> Any:
    """Read a number or a text with a unit, or where that is allowed a schedule as [time, value] knots."""
    if parameter.over_time and isinstance(value, (list, tuple)):
        knots = [pair if isinstance(pair, (str, bytes)) else list(pair) for pair in value]
        return _KNOTS.validate_python(
            [[pair[0], _read_number(parameter, pair[1])] if len(pair) == 2 else pair for pair in knots]
        )
    return _read_number(parameter, value)


def _read_number(parameter: Parameter, value: object) -> float:
    if not parameter.unit and isinstance(value, str):
        value = to_si(value)
    return Quantity(unit=parameter.unit or "1").read(value)


class Law(Group):
    """A torque law by its name, and its parameters, by their names or as a list; see `gearidae.torques`."""

    model_config = ConfigDict(frozen=True, extra="allow")

    name: Annotated[str, Named(torque_names)] = Field(description="name of a registered torque law")
    parameters: Annotated[tuple[Annotated[float, Quantity(unit="1")], ...], BeforeValidator(_as_numbers)] = (
        Field(
            default=(), description="its parameters, as many as it takes, in SI units, if they have no names"
        )
    )

    @classmethod
    def known_keys(cls, data: Mapping[str, Any]) -> list[str]:
        """Return the keys of the table, with the names of the law's parameters."""
        name = data.get("name")
        if name is not None:  # a misspelt law would make its parameters unknown keys
            try:
                Named(torque_names).read(name)
            except ValueError as error:
                raise SceneError("name", shorten(name), str(error)) from None
        named = torque_law(name).named if name in torque_names() else ()
        return [*cls.model_fields, *(parameter.name for parameter in named)]

    @classmethod
    def open_key(cls, name: str) -> tuple[str, str] | None:
        """Return unit and description of a parameter that any law has by this name."""
        every = (parameter for law in torque_names() for parameter in torque_law(law).named)
        match = next((parameter for parameter in every if parameter.name == name), None)
        return None if match is None else (match.unit, match.description or f"parameter {name} of the law")

    @model_validator(mode="before")
    @classmethod
    def _read_named(cls, data: Any) -> Any:
        """Read the parameters that the law has by name."""
        if not isinstance(data, dict) or data.get("name") not in torque_names():
            return data
        read = dict(data)
        for parameter in torque_law(data["name"]).named:
            value = data.get(parameter.name, parameter.default)
            if value is None:
                meaning = f": {parameter.description}" if parameter.description else ""
                raise SceneError(
                    parameter.name, "(missing)", f"is required by the law {data['name']}{meaning}"
                )
            try:
                read[parameter.name] = _read_parameter(parameter, value)
            except ValidationError as error:  # of a schedule: what is wrong with its first bad knot
                first = error.errors(include_url=False)[0]
                reason = str(first.get("ctx", {}).get("error", first["msg"]))
                raise SceneError(parameter.name, shorten(value), reason) from None
            except ValueError as error:
                raise SceneError(parameter.name, shorten(value), str(error)) from None
        return read

    @model_validator(mode="after")
    def _complete(self) -> Self:
        """Let the law have as many parameters as it reads."""
        law = torque_law(self.name)
        if law.named and self.parameters:
            names = ", ".join(parameter.name for parameter in law.named)
            raise SceneError(
                "parameters", shorten(list(self.parameters)), f"the law {self.name} has them by name: {names}"
            )
        if not law.named and len(self.parameters) != law.parameters:
            raise SceneError(
                "parameters",
                shorten(list(self.parameters)),
                f"the law {self.name} takes {law.parameters} numbers",
            )
        return self

    def numbers(self) -> tuple[float, ...]:
        """Return the parameters as the law's function reads them; a schedule as its knots."""
        numbers = list(self.parameters)
        for parameter in torque_law(self.name).named:
            value = (self.model_extra or {})[parameter.name]
            if isinstance(value, tuple):
                numbers += [x for pair in value for x in pair]
            else:
                numbers += [0.0, value] if parameter.over_time else [value]
        return tuple(numbers)


class Drive(Group):
    """Torque on the pinion, M1."""

    shaft: str | None = Field(default=None, description="shaft of a train that is driven; default the first")
    torque: Torque = Field(default=0.0, description="constant part, M10")
    harmonic: Harmonics = Field(default=(), description="harmonic part, a table or a list of tables")
    schedule: Schedule = Field(default=Knots(), description=_SCHEDULE)
    law: Law | None = Field(
        default=None, description="a torque law of time, angle and speed, added to the rest"
    )
    speed: Annotated[
        float | Knots | None, Scheduled(unit="rad/s", at_least=-1e12, at_most=1e12, least=1e-30)
    ] = Field(
        default=None,
        description="speed of the pinion, or the driven shaft, that the drive holds: a number or a schedule",
    )
    speed_gain: Annotated[float, Quantity(unit="N m s/rad", at_least=0, at_most=1e12)] = Field(
        default=0.0, description="torque over the difference between that speed and the actual one"
    )

    orientation: Phase = Field(
        default=0.0,
        description="angle from the line of centres (of a train: its x axis) to the x axis of a law's force",
    )
    pin_radius: HubRadius = Field(default=0.0, description="radius of the pin joint of a law with a force")
    pin_friction: OptionalFriction = Field(
        default=None, description="coefficient of friction of that joint; default gears.hub_friction"
    )
    pin_friction_rise: OptionalRise = Field(
        default=None,
        description="rise of it with time at rest; default gears.hub_friction_rise, or 0 with pin_friction",
    )
    pin_ageing_time: AgeingTime = Field(
        default=None, description="time at rest of 63 % of that rise; default gears.hub_ageing_time"
    )
    pin_memory_length: MemoryLength = Field(
        default=None, description="way on which that rise is forgotten; default gears.hub_memory_length"
    )

    @model_validator(mode="after")
    def _speed_is_held(self) -> Self:
        """Let speed and gain come together."""
        if self.speed is not None and self.speed_gain == 0.0:
            raise SceneError("speed_gain", 0.0, "must be above 0 N m s/rad where a speed is to be held")
        if self.speed is None and self.speed_gain != 0.0:
            raise SceneError("speed", "(missing)", "is required with speed_gain: the speed to be held")
        return self

    def speed_knots(self) -> Knots:
        """Return the speed that is held as a schedule, of one knot if it is constant; empty if none is held."""
        if self.speed is None:
            return Knots()
        return self.speed if isinstance(self.speed, Knots) else Knots([(0.0, self.speed)])


class Load(Group):
    """Torque that resists the gear, M2."""

    shaft: str | None = Field(default=None, description="shaft of a train that is loaded; default the last")
    torque: Resistance = Field(default=0.0, description="dry resistance against the motion, M20")
    harmonic: Harmonics = Field(
        default=(),
        description="harmonic part of the dry resistance, cut off at 0 with it: a table or a list of tables",
    )
    drag: Annotated[float, Quantity(unit="N m s^2/rad^2", at_least=0, at_most=1e12)] = Field(
        default=0.0, description="quadratic drag alpha, torque over angular speed squared"
    )
    viscous: Annotated[float, Quantity(unit="N m s/rad", at_least=0, at_most=1e12)] = Field(
        default=0.0, description="viscous drag, torque over angular speed"
    )
    schedule: ResistanceSchedule = Field(
        default=Knots(),
        description="dry resistance over time, not below 0, added to the constant: [time, torque] knots, or a table",
    )
    law: Law | None = Field(
        default=None,
        description="a law of time, angle and speed, added to the dry resistance, whose sum is cut off at 0",
    )
