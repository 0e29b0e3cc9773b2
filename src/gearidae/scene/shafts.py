"""Shafts and meshes of a train, in place of a pair of gears: tables by names of the user's own."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Annotated, Any, Final, Self

from pydantic import Field, create_model, model_validator

from gearidae.errors import SceneError
from gearidae.scene.coating import Coating
from gearidae.scene.gears import HubRadius, JointForce, Mesh, Teeth
from gearidae.scene.group import Group, shorten
from gearidae.scene.joints import HubFriction, Joint, hub_in
from gearidae.scene.knots import Resistance
from gearidae.scene.named_tables import NamedTables
from gearidae.scene.quantity import Count, Quantity
from gearidae.scene.surface import AgeingTime, Contact, Friction, FrictionRise, MemoryLength, Surface

FRICTION_KEYS: Final = ("hub_friction", "hub_friction_rise", "hub_ageing_time", "hub_memory_length")
"""Keys of the friction of a hub that a pair has for both."""


def friction_of(hubs: HubFriction) -> dict[str, Any]:
    """Keys of the friction of a hub that are given."""
    return {key: value for key in FRICTION_KEYS if (value := getattr(hubs, key)) is not None}


class Shaft(Group):
    """One shaft of a train: its gears, its inertia, its hub, and what resists it."""

    inertia: Annotated[float | None, Quantity(unit="kg m^2", at_least=1e-40, at_most=1)] = Field(
        default=None, description="moment of inertia of the shaft with all its gears; this or the density"
    )
    density: Annotated[float | None, Quantity(unit="kg/m^3", at_least=1, at_most=1e5)] = Field(
        default=None, description="density: solid discs of the pitch circles of all its gears are added"
    )
    teeth: Annotated[int | None, Count(at_least=3, at_most=10_000)] = Field(
        default=None, description="teeth of its one gear, which has the shaft's name"
    )
    gears: NamedTables[Teeth] | None = Field(
        default=None,
        description="teeth of several gears by their names, in place of teeth; a mesh names them SHAFT.GEAR",
    )
    hub_friction: Friction = Field(
        default=0.0, description="coefficient of friction of its hub; with a rise, of fresh contacts"
    )
    hub_friction_rise: FrictionRise = Field(
        default=0.0, description="by how much that coefficient grows with time at rest, towards a long one"
    )
    hub_ageing_time: AgeingTime = Field(
        default=None, description="time at rest of 63 % of the rise; needed with one"
    )
    hub_memory_length: MemoryLength = Field(
        default=None,
        description="way of the hub's surface on which the rise is forgotten, some 20 to 100 nm; needed with one",
    )
    hub_radius: HubRadius = Field(default=0.0, description="radius of its hub, 0 for one without friction")
    hub_adhesion: JointForce = Field(
        default=0.0, description="adhesion of its hub, which its friction takes for a load"
    )
    axial_load: JointForce = Field(default=0.0, description="load along its axis")
    dimple_radius: HubRadius = Field(default=0.0, description="radius at which dimples carry the axial load")
    resistance: Resistance = Field(default=0.0, description="dry resistance against its motion")
    viscous: Annotated[float, Quantity(unit="N m s/rad", at_least=0, at_most=1e12)] = Field(
        default=0.0, description="viscous drag of this shaft, torque over angular speed"
    )
    drag: Annotated[float, Quantity(unit="N m s^2/rad^2", at_least=0, at_most=1e12)] = Field(
        default=0.0, description="quadratic drag of this shaft, torque over angular speed squared"
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        """Let a shaft have either of two keys that say the same, and hubs and dimples what they need."""
        for first, second in (("inertia", "density"), ("teeth", "gears")):
            given = getattr(self, first), getattr(self, second)
            if given == (None, None):
                raise SceneError(first, "(missing)", f"is required, or {second} in its place")
            if None not in given:
                raise SceneError(first, given[0], f"cannot be given beside {second}: choose one of the two")
        for load, radius in (("hub_adhesion", "hub_radius"), ("axial_load", "dimple_radius")):
            if getattr(self, load) > 0.0 and getattr(self, radius) == 0.0:
                raise SceneError(radius, 0.0, f"must be above 0 with {load}")
        for key in ("hub_friction", "hub_friction_rise"):
            if getattr(self, key) > 0.0 and self.hub_radius == 0.0 and self.dimple_radius == 0.0:
                raise SceneError("hub_radius", 0.0, f"a hub or a dimple must have a radius with {key}")
        return self

    def hub_of(self, name: str) -> Joint | None:
        """Return its hub, of a shaft of this name; None without a radius at which a hub or dimples slide."""
        if self.hub_radius == 0.0 and self.dimple_radius == 0.0:
            return None
        return hub_in(self, f"hub of {name}")

    def gear_teeth(self, name: str) -> dict[str, int]:
        """Teeth of its gears by the names that meshes use, of a shaft of this name."""
        if self.gears is None:
            assert self.teeth is not None
            return {name: self.teeth}
        return {f"{name}.{gear}": teeth for gear, teeth in self.gears.items()}


def _optional(name: str, table: type[Group], meaning: str, only: Collection[str] = ()) -> type[Group]:
    """Make a table with the keys of another, or only some of them, none of which need be given."""
    fields: dict[str, Any] = {
        key: (
            # the field's own annotations read what is given; None says that nothing is
            Annotated[(field.annotation | None, *field.metadata, Field(description=field.description))],  # type: ignore[operator]
            None,
        )
        for key, field in table.model_fields.items()
        if key in (only or table.model_fields)
    }
    made = create_model(name, __base__=Group, __module__=__name__, **fields)
    made.__doc__ = meaning
    return made


if TYPE_CHECKING:
    MeshKeys = Group
    MeshCoating = Group
    MeshSurface = Group
    MeshContact = Group
else:
    MeshKeys = _optional("MeshKeys", Mesh, "Keys of the table ``mesh``, which one mesh may repeat.")
    MeshCoating = _optional("MeshCoating", Coating, "Keys of the coating that one mesh has of its own.")
    MeshSurface = _optional("MeshSurface", Surface, "Keys of the surface that one mesh has of its own.")
    MeshContact = _optional(
        "MeshContact",
        Contact,
        "Which discrete asperities one mesh has; laws are those of the scene.",
        ("seed", "radius_spread", "asperities"),
    )


class Meshing(MeshKeys):
    """One mesh of a train: the two gears that meet, and what it has in place of the tables of the scene."""

    driver: str = Field(description="the gear nearer to the drive: SHAFT, or SHAFT.GEAR of several")
    driven: str = Field(description="the gear that it drives")
    angle: Annotated[float | None, Quantity(unit="rad", at_least=-1e9, at_most=1e9)] = Field(
        default=None,
        description="angle of the line of centres from driver to driven, counter-clockwise; default 0, of a mesh that "
        "closes a loop that of the centres",
    )
    phase: Annotated[float | None, Quantity(unit="1", at_least=0, below=10_000)] = Field(
        default=None,
        description="position of its pair 0 on the path of contact, in base pitches; default initial.mesh_phase, or as "
        "it follows from other meshes of its gears",
    )
    offset: Annotated[float, Quantity(unit="m", at_least=-1, at_most=1, shown=("nm", -9))] = Field(
        default=0.0, description="by how much the driven gear stands back along the line of action"
    )
    coating: MeshCoating | None = Field(default=None, description="keys of the coating of this mesh alone")
    surface: MeshSurface | None = Field(default=None, description="keys of the surface of this mesh alone")
    contact: MeshContact | None = Field(
        default=None,
        description="seed, spread of radii and list of the discrete asperities of this mesh alone",
    )

    def own(self, table: str) -> dict[str, Any]:
        """Keys that this mesh has in place of those of a table of the scene (mesh, coating, surface, contact)."""
        if table == "mesh":
            return {key: value for key in Mesh.model_fields if (value := getattr(self, key)) is not None}
        group: Group | None = getattr(self, table)
        return {} if group is None else {key: value for key, value in group if value is not None}

    @model_validator(mode="after")
    def _one_size(self) -> Self:
        """Let a mesh have either a module or a base radius."""
        module, radius = self.own("mesh").get("module"), self.own("mesh").get("driver_base_radius")
        if module is not None and radius is not None:
            raise SceneError("module", shorten(module), "cannot be given beside driver_base_radius")
        return self
