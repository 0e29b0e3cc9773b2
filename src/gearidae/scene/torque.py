"""What drives the pinion and what loads the gear.

Both torques are a constant, plus harmonics, plus a piecewise linear schedule that holds its end values
outside its knots (Teodorescu et al. 2009, Eqs. 2 and 3).
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from gearidae.scene.group import Group
from gearidae.scene.quantity import Phase, Quantity
from gearidae.scene.tables import increasing, one_or_more, pairs

__all__ = ["Drive", "Harmonic", "Load"]

Torque = Annotated[float, Quantity(unit="N m", at_least=-1e9, at_most=1e9, least=1e-40)]
Time = Annotated[float, Quantity(unit="s", at_least=0, at_most=1e12, least=1e-20)]
Schedule = Annotated[tuple[tuple[Time, Torque], ...], pairs, increasing]


class Harmonic(Group):
    """One harmonic of a torque, ``amplitude cos(2 pi frequency t + phase)``."""

    amplitude: Torque = Field(description="amplitude")
    frequency: Annotated[float, Quantity(unit="Hz", at_least=0, at_most=1e18, shown=("kHz", 3))] = Field(
        description="frequency"
    )
    phase: Phase = Field(default=0.0, description="phase")


Harmonics = Annotated[tuple[Harmonic, ...], one_or_more("amplitude, frequency, phase")]


class Drive(Group):
    """Torque on the pinion, M1."""

    torque: Torque = Field(default=0.0, description="constant part, M10")
    harmonic: Harmonics = Field(default=(), description="harmonic part, a table or a list of tables")
    schedule: Schedule = Field(
        default=(), description="[time, torque] knots, joined linearly, added to the constant"
    )


class Load(Group):
    """Torque that resists the gear, M2."""

    torque: Annotated[float, Quantity(unit="N m", at_least=0, at_most=1e9, least=1e-40)] = Field(
        default=0.0, description="dry resistance against the motion, M20"
    )
    harmonic: Harmonics = Field(default=(), description="harmonic part, a table or a list of tables")
    drag: Annotated[float, Quantity(unit="N m s^2/rad^2", at_least=0, at_most=1e12)] = Field(
        default=0.0, description="quadratic drag alpha, torque over angular speed squared"
    )
    schedule: Schedule = Field(
        default=(), description="[time, torque] knots, joined linearly, added to the constant"
    )
