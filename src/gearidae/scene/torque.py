"""What drives the pinion and what loads the gear.

Both torques are a constant, plus harmonics, plus a schedule, linear or monotone cubic between its knots, that holds its
end values outside them (Teodorescu et al. 2009, Eqs. 2 and 3), plus a law of time and speed by its name
(`gearidae.torques`). A drive may hold a speed besides, ``gain (w(t) - w1)``, the torque-speed line of a motor. The
gear's motion is resisted by a quadratic and a viscous drag.
"""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import BeforeValidator, Field, model_validator

from gearidae.errors import SceneError
from gearidae.scene.group import Group, shorten
from gearidae.scene.knots import Knots, Resistance, ResistanceSchedule, Schedule, Scheduled, Torque
from gearidae.scene.named import Named
from gearidae.scene.quantity import Phase, Quantity
from gearidae.scene.tables import one_or_more
from gearidae.torques import torque_law, torque_names

__all__ = ["Drive", "Harmonic", "Law", "Load"]

_SCHEDULE = "torque over time, added to the constant: [time, torque] knots, or a table with columns"


class Harmonic(Group):
    """One harmonic of a torque, ``amplitude cos(2 pi frequency t + phase)``."""

    amplitude: Torque = Field(description="amplitude")
    frequency: Annotated[float, Quantity(unit="Hz", at_least=0, at_most=1e18, shown=("kHz", 3))] = Field(
        description="frequency"
    )
    phase: Phase = Field(default=0.0, description="phase")


Harmonics = Annotated[tuple[Harmonic, ...], one_or_more("amplitude, frequency, phase")]


def _as_numbers(value: object) -> object:
    """Accept one number, a list of them, or an array; what it holds is read later."""
    value = value.tolist() if hasattr(value, "tolist") else value
    return tuple(value) if isinstance(value, (list, tuple)) else (value,)


class Law(Group):
    """A torque law by its name, and its parameters; see `gearidae.torques`."""

    name: Annotated[str, Named(torque_names)] = Field(description="name of a registered torque law")
    parameters: Annotated[tuple[Annotated[float, Quantity(unit="1")], ...], BeforeValidator(_as_numbers)] = (
        Field(default=(), description="its parameters, as many as it takes, in SI units")
    )

    @model_validator(mode="after")
    def _complete(self) -> Self:
        """Let the law have as many parameters as it reads."""
        wanted = torque_law(self.name).parameters
        if len(self.parameters) != wanted:
            raise SceneError(
                "parameters", shorten(list(self.parameters)), f"the law {self.name} takes {wanted} numbers"
            )
        return self


class Drive(Group):
    """Torque on the pinion, M1."""

    torque: Torque = Field(default=0.0, description="constant part, M10")
    harmonic: Harmonics = Field(default=(), description="harmonic part, a table or a list of tables")
    schedule: Schedule = Field(default=Knots(), description=_SCHEDULE)
    law: Law | None = Field(default=None, description="a torque law of time and speed, added to the rest")
    speed: Annotated[
        float | Knots | None, Scheduled(unit="rad/s", at_least=-1e12, at_most=1e12, least=1e-30)
    ] = Field(default=None, description="speed of the pinion that the drive holds, a number or a schedule")
    speed_gain: Annotated[float, Quantity(unit="N m s/rad", at_least=0, at_most=1e12)] = Field(
        default=0.0, description="torque over what the pinion's speed is short of that speed"
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
        description="a law of time and speed, added to the dry resistance, whose sum is cut off at 0",
    )

    @property
    def is_dry(self) -> bool:
        """Whether there is a resistance that opposes whichever motion there is, and may hold the gear at rest."""
        return self.torque != 0.0 or bool(self.harmonic) or bool(self.schedule) or self.law is not None
