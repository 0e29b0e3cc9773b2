"""The two gears and how their teeth meet."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, Final

from pydantic import Field, create_model, model_validator

from gearidae.errors import SceneError
from gearidae.laws.frictions import LAWS_OF_SHAFTS
from gearidae.laws.law import SHAFT_NAMES, Key
from gearidae.laws.pairs import MESH_LAWS
from gearidae.scene.group import Group, shorten
from gearidae.scene.pitch_errors import PitchErrors
from gearidae.scene.quantity import Count, Phase, Quantity, Switch
from gearidae.scene.surface import AgeingTime, Friction, FrictionRise, MemoryLength
from gearidae.scene.tables import one_or_more

Inertia = Annotated[float, Quantity(unit="kg m^2", at_least=1e-40, at_most=1)]
# the disc of one atom's thickness and the smallest base radius has 1e-38 kg m^2
HubRadius = Annotated[float, Quantity(unit="m", at_least=0, at_most=1, least=1e-10, shown=("um", -6))]
JointForce = Annotated[float, Quantity(unit="N", at_least=0, at_most=1, shown=("uN", -6))]
Teeth = Annotated[int, Count(at_least=3, at_most=10_000)]

SILICON: Final = 2330.0
"""Density of silicon [kg/m^3]."""
DISC_FACTOR: Final = 3.0
"""Ratio of the inertias of a gear and of a solid disc of its size, or its inverse, above which a doubt is reported."""


def disc_inertia(density: float, width: float, base_radius: float, pressure_angle: float) -> float:
    """Moment of inertia [kg m^2] of a solid disc as large as a gear's pitch circle.

    Parameters
    ----------
    density : float
        [kg/m^3].
    width, base_radius : float
        Of the gear [m].
    pressure_angle : float
        At the pitch circle [rad].
    """
    return 0.5 * math.pi * density * width * (base_radius / math.cos(pressure_angle)) ** 4


def _key_of_law(key: Key, description: str) -> tuple[Any, Any]:
    """Field of a table for a key of a law."""
    kind = Quantity(unit=key.unit, at_least=0, at_most=key.at_most, least=key.least, shown=key.shown)
    return Annotated[float, kind], Field(default=0.0, description=description)


def _keys_of_laws() -> dict[str, Any]:
    """Keys of the laws of a shaft, of either shaft."""
    return {
        f"{shaft}_{constant.name}": _key_of_law(key, key.description.format(shaft=shaft))
        for law in LAWS_OF_SHAFTS
        for constant in law.coefficients
        if (key := constant.key) is not None
        for shaft in SHAFT_NAMES
    }


_LAW_FIELDS: Final = _keys_of_laws()
LAW_KEYS: Final = tuple(_LAW_FIELDS)
"""Keys of ``gears`` that are those of a law of a shaft."""


class PairOfGears(Group):
    """Teeth, inertias and joints of two gears: the keys of ``gears`` that are of no law of a shaft."""

    density: Annotated[float | None, Quantity(unit="kg/m^3", at_least=1, at_most=1e5)] = Field(
        default=None,
        description="density, in place of both inertias: solid discs of the pitch circles; a scene keeps the inertias",
    )
    pinion_inertia: Inertia = Field(description="moment of inertia of the pinion, I1")
    gear_inertia: Inertia = Field(description="moment of inertia of the gear, I2")
    pinion_base_radius: Annotated[float, Quantity(unit="m", at_least=1e-8, at_most=1, shown=("um", -6))] = (
        Field(description="base radius of the pinion, R1; that of the gear follows from the teeth")
    )
    module: Annotated[float | None, Quantity(unit="m", at_least=1e-9, at_most=1, shown=("um", -6))] = Field(
        default=None,
        description="module m, in place of the base radius, which is m z1 cos(alpha) / 2; a scene keeps the radius",
    )
    pinion_teeth: Teeth = Field(description="teeth of the pinion, z1")
    gear_teeth: Teeth = Field(description="teeth of the gear, z2")
    pressure_angle: Annotated[float, Quantity(unit="rad", above=0, below=1.5)] = Field(
        description="pressure angle at the pitch circle"
    )
    face_width: Annotated[float, Quantity(unit="m", at_least=1e-10, at_most=1, shown=("um", -6))] = Field(
        description="width of the teeth along the axis, L"
    )
    hub_friction: Friction = Field(
        default=0.0,
        description="coefficient of friction of both hubs that slide; with a rise, of fresh contacts",
    )
    hub_friction_rise: FrictionRise = Field(
        default=0.0, description="by how much that coefficient grows with time at rest, towards a long one"
    )
    hub_ageing_time: AgeingTime = Field(
        default=None, description="time at rest of 63 % of the rise; needed with one"
    )
    hub_memory_length: MemoryLength = Field(
        default=None,
        description="way of the hubs' surfaces on which the rise is forgotten, some 20 to 100 nm; needed with one",
    )
    pinion_hub_radius: HubRadius = Field(
        default=0.0, description="radius of the pinion's hub, 0 for one without friction"
    )
    gear_hub_radius: HubRadius = Field(
        default=0.0, description="radius of the gear's hub, 0 for one without friction"
    )
    pinion_hub_clearance: Annotated[
        float, Quantity(unit="m", at_least=0, at_most=1e-3, least=1e-12, shown=("nm", -9))
    ] = Field(
        default=0.0,
        description="radial clearance of the pinion's hub, in which the force of the drive carries its centre round",
    )
    pinion_hub_adhesion: JointForce = Field(
        default=0.0, description="adhesion of the pinion's hub, which its friction takes for a load"
    )
    gear_hub_adhesion: JointForce = Field(default=0.0, description="the same of the gear's hub")
    pinion_axial_load: JointForce = Field(
        default=0.0, description="load along the pinion's axis: weight, electrostatic pull on the substrate"
    )
    gear_axial_load: JointForce = Field(default=0.0, description="the same of the gear")
    pinion_dimple_radius: HubRadius = Field(
        default=0.0, description="radius at which dimples carry the axial load of the pinion"
    )
    gear_dimple_radius: HubRadius = Field(default=0.0, description="the same of the gear")

    @model_validator(mode="before")
    @classmethod
    def _in_place_of_others(cls, data: Any) -> Any:
        """Put the base radius in the place of the module, and the inertias of discs in that of the density."""
        if not isinstance(data, dict):
            return data
        table = dict(data)
        if cls._is_given(table, "module", "pinion_base_radius"):
            module, teeth, angle = (
                cls._number(table, name) for name in ("module", "pinion_teeth", "pressure_angle")
            )
            del table["module"]
            table["pinion_base_radius"] = 0.5 * module * teeth * math.cos(angle)
        if cls._is_given(table, "density", "pinion_inertia", "gear_inertia"):
            density, width = cls._number(table, "density"), cls._number(table, "face_width")
            radius, angle = cls._number(table, "pinion_base_radius"), cls._number(table, "pressure_angle")
            larger = radius * cls._number(table, "gear_teeth") / cls._number(table, "pinion_teeth")
            del table["density"]
            for name, base in (("pinion_inertia", radius), ("gear_inertia", larger)):
                table[name] = disc_inertia(density, width, base, angle)
        return table

    @staticmethod
    def _is_given(data: dict[str, Any], name: str, *others: str) -> bool:
        """Whether a key is given, and none of those that it takes the place of."""
        if data.get(name) is None:
            return False
        for other in others:
            if data.get(other) is not None:
                raise SceneError(
                    name, shorten(data[name]), f"cannot be given beside {other}: choose one of the two"
                )
        return True

    @classmethod
    def _number(cls, data: dict[str, Any], name: str) -> float:
        """Read one key as pydantic would, which has not come to it yet."""
        field = cls.model_fields[name]
        if name not in data:
            raise SceneError(name, "(missing)", f"is required: {field.description}")
        kind = next(entry for entry in field.metadata if isinstance(entry, (Quantity, Count)))
        try:
            return kind.read(data[name])
        except ValueError as error:
            raise SceneError(name, shorten(data[name]), str(error)) from error


if TYPE_CHECKING:
    _WithLaws = PairOfGears
else:
    _WithLaws = create_model("_WithLaws", __base__=PairOfGears, __module__=__name__, **_LAW_FIELDS)


class Gears(_WithLaws):
    """Two spur gears of full-depth involute teeth at their nominal centre distance.

    Their size is given by the pinion's base radius, or by the module m in its place, from which it follows as
    ``R1 = m z1 cos(alpha) / 2``: the pitch circle has the diameter ``m z1``, and the base circle is that times
    ``cos(alpha)`` (ISO 21771). A scene keeps the radius. Moments of inertia may be those of solid discs as large as the
    pitch circles and as thick as the face width, ``pi/2 density L (R / cos(alpha))^4``, by their density. What else
    acts on a shaft has the keys that its law declares (`gearidae.laws.shafts`), for either shaft.
    """


class StaticErrorHarmonic(Group):
    """One harmonic of the static transmission error, ``amplitude cos(order phi1 + phase)``."""

    order: Annotated[int, Count(at_least=1, at_most=100_000)] = Field(
        description="cycles per turn of the pinion"
    )
    amplitude: Annotated[float, Quantity(unit="m", at_least=-1, at_most=1, shown=("nm", -9))] = Field(
        description="amplitude along the line of action"
    )
    phase: Phase = Field(default=0.0, description="phase")


class Runout(Group):
    """Runout of a gear, ``amplitude cos(angle + phase)`` with the angle of its own shaft."""

    amplitude: Annotated[float, Quantity(unit="m", at_least=-1, at_most=1, shown=("nm", -9))] = Field(
        description="amplitude along the line of action"
    )
    phase: Phase = Field(
        default=0.0, description="phase; the angle is 0 where pair 0 enters the path of contact"
    )


class MeshOfTeeth(Group):
    """How the teeth meet along the line of action: the keys of ``mesh`` that are of no law of a mesh."""

    backlash: Annotated[float, Quantity(unit="m", at_least=0, at_most=1, shown=("um", -6))] = Field(
        description="total play between the flanks, 2b, from the summits' mean plane"
    )
    tip_relief_radius: Annotated[float, Quantity(unit="m", at_least=1e-10, at_most=1, shown=("um", -6))] = (
        Field(default=10e-6, description="radius of the rounded tooth end, rho")
    )
    static_error: Annotated[tuple[StaticErrorHarmonic, ...], one_or_more("order, amplitude, phase")] = Field(
        default=(), description="harmonics of the static transmission error, a list of tables"
    )
    pinion_pitch_error: PitchErrors = Field(
        default=(),
        description="errors of the pinion's teeth: how far each stands back from its drive flank; a list or a file",
    )
    gear_pitch_error: PitchErrors = Field(default=(), description="the same of the gear's teeth")
    pitch_error_rms: Annotated[
        float, Quantity(unit="m", at_least=0, at_most=1, least=1e-15, shown=("nm", -9))
    ] = Field(
        default=0.0,
        description="rms of the sum of the errors of two teeth that meet, in place of lists: both gears' are drawn",
    )
    pitch_error_seed: Annotated[int, Count(at_least=0, at_most=2**53)] = Field(
        default=0, description="which gears of this kind the errors are drawn as"
    )
    pinion_runout: Runout | None = Field(
        default=None,
        description="runout of the pinion, counted with its angle from where pair 0 enters the path of contact",
    )
    gear_runout: Runout | None = Field(
        default=None,
        description="runout of the gear, counted with its own angle from where pair 0 enters the path of contact",
    )
    radius_force: Switch = Field(
        default=True,
        description="whether the changing radius of curvature pushes the gear, so that energy is conserved",
    )
    module: Annotated[float | None, Quantity(unit="m", at_least=1e-9, at_most=1, shown=("um", -6))] = Field(
        default=None, description="module of the gears of a train"
    )
    driver_base_radius: Annotated[
        float | None, Quantity(unit="m", at_least=1e-8, at_most=1, shown=("um", -6))
    ] = Field(default=None, description="base radius of a train's driving gear, in place of the module")
    pressure_angle: Annotated[float | None, Quantity(unit="rad", above=0, below=1.5)] = Field(
        default=None, description="pressure angle at the pitch circle of the gears of a train"
    )
    face_width: Annotated[float | None, Quantity(unit="m", at_least=1e-10, at_most=1, shown=("um", -6))] = (
        Field(default=None, description="width of the teeth of a train along the axis")
    )


if TYPE_CHECKING:
    _MeshWithLaws = MeshOfTeeth
else:
    _MeshWithLaws = create_model(
        "_MeshWithLaws",
        __base__=MeshOfTeeth,
        __module__=__name__,
        **{
            constant.name: _key_of_law(constant.key, constant.key.description)
            for law in MESH_LAWS
            for constant in law.constants
        },
    )


class Mesh(_MeshWithLaws):
    """How the teeth meet along the line of action, with the keys that laws of a mesh declare."""

    @model_validator(mode="after")
    def _keys_go_together(self) -> Mesh:
        for law in MESH_LAWS:
            if law.refuse is not None:
                law.refuse(self)
        return self
