"""The two gears and how their teeth meet."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from gearidae.scene.group import Group
from gearidae.scene.quantity import Count, Phase, Quantity
from gearidae.scene.tables import one_or_more

__all__ = ["Gears", "Mesh", "StaticErrorHarmonic"]

Inertia = Annotated[float, Quantity(unit="kg m^2", at_least=1e-40, at_most=1)]
# the disc of one atom's thickness and the smallest base radius has 1e-38 kg m^2
Teeth = Annotated[int, Count(at_least=3, at_most=10_000)]


class Gears(Group):
    """Two spur gears of full-depth involute teeth at their nominal centre distance."""

    pinion_inertia: Inertia = Field(description="moment of inertia of the pinion, I1")
    gear_inertia: Inertia = Field(description="moment of inertia of the gear, I2")
    pinion_base_radius: Annotated[float, Quantity(unit="m", at_least=1e-8, at_most=1, shown=("um", -6))] = (
        Field(description="base radius of the pinion, R1; that of the gear follows from the teeth")
    )
    pinion_teeth: Teeth = Field(description="teeth of the pinion, z1")
    gear_teeth: Teeth = Field(description="teeth of the gear, z2")
    pressure_angle: Annotated[float, Quantity(unit="rad", above=0, below=1.5)] = Field(
        description="pressure angle at the pitch circle"
    )
    face_width: Annotated[float, Quantity(unit="m", at_least=1e-10, at_most=1, shown=("um", -6))] = Field(
        description="width of the teeth along the axis, L"
    )


class StaticErrorHarmonic(Group):
    """One harmonic of the static transmission error, ``amplitude cos(order phi1 + phase)``."""

    order: Annotated[int, Count(at_least=1, at_most=100_000)] = Field(
        description="cycles per turn of the pinion"
    )
    amplitude: Annotated[float, Quantity(unit="m", at_least=-1, at_most=1, shown=("nm", -9))] = Field(
        description="amplitude along the line of action"
    )
    phase: Phase = Field(default=0.0, description="phase")


class Mesh(Group):
    """How the teeth meet along the line of action."""

    backlash: Annotated[float, Quantity(unit="m", at_least=0, at_most=1, shown=("um", -6))] = Field(
        description="total play between the flanks, 2b"
    )
    tip_relief_radius: Annotated[float, Quantity(unit="m", at_least=1e-10, at_most=1, shown=("um", -6))] = (
        Field(default=10e-6, description="radius of the rounded tooth end, rho")
    )
    damping: Annotated[float, Quantity(unit="N s/m", at_least=0, at_most=1e9)] = Field(
        default=0.0, description="viscous damping of the transmission error"
    )
    static_error: Annotated[tuple[StaticErrorHarmonic, ...], one_or_more("order, amplitude, phase")] = Field(
        default=(), description="harmonics of the static transmission error, a list of tables"
    )
