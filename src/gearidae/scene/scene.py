"""The scene: everything a run is made of, checked as a whole."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Final, Self, TypeGuard

from pydantic import BeforeValidator, ConfigDict, Field, model_validator

from gearidae.errors import SceneError
from gearidae.mesh.involute import Geometry, GeometryError, mesh_geometry
from gearidae.scene.asperity_list import check_asperities
from gearidae.scene.coating import Coating, Material, materials_of
from gearidae.scene.coating_table import check_tables
from gearidae.scene.combinations import check_combinations
from gearidae.scene.display import as_html, as_line
from gearidae.scene.friction import check_friction, check_no_friction
from gearidae.scene.gears import Gears, Mesh
from gearidae.scene.group import Group, shorten
from gearidae.scene.joints import check_joints
from gearidae.scene.judged import judged_shaft, refuse_judged
from gearidae.scene.keys import INSTEAD, KeyInfo, find_key, keys_of, put
from gearidae.scene.limits import (
    check_gaps,
    check_reach,
    check_stretch,
    check_thickness,
)
from gearidae.scene.named_tables import NAME, NamedTables
from gearidae.scene.orbit import check_orbit, play_at_start
from gearidae.scene.pitch_errors import check_pitch_errors, error_on_path
from gearidae.scene.roughnesses import InRoughnesses
from gearidae.scene.run import Initial, Roller, Run
from gearidae.scene.schema import json_schema
from gearidae.scene.shafts import Meshing, Shaft
from gearidae.scene.strip import check_population
from gearidae.scene.surface import LAW_KEYS, Contact, Surface
from gearidae.scene.surface_library import library_changes, with_library
from gearidae.scene.torque import Drive, Load
from gearidae.scene.train import Train, pair_meshes, pair_shafts, train_of
from gearidae.scene.train_pair import check_train, pair_of

_GEAR_TABLES = ("gears", "shafts", "meshes", "mesh", "drive", "load", "initial")
_OF_A_TRAIN = ("module", "driver_base_radius", "pressure_angle", "face_width")
_MOST_PLACES = 20_000  # on all teeth of the pinion: exposures are part of every checkpoint
_NOTHING_IF_EMPTY = (
    ("drive", "schedule"),
    ("load", "schedule"),
    ("run", "checkpoints"),
    ("coating", "pinion_table"),
    ("coating", "gear_table"),
    ("contact", "asperities"),
    ("mesh", "pinion_pitch_error"),
    ("mesh", "gear_pitch_error"),
)
_DEEPEST_OVERLAP = 8.0  # rms roughnesses that the mean planes may overlap at the start


def _named(value: object) -> str:
    if isinstance(value, str) and value.isprintable() and 0 < len(value.strip()) <= 200:
        return value
    raise ValueError("must be a printable line of 1..200 characters")


class Scene(Group):
    """A gear pair, a train or a roller: a `GearScene`, a `TrainScene` or a `RollerScene`. All quantities are SI floats.

    Give ``gears``, ``mesh``, ``drive`` and ``initial`` (``load`` if there is one), for a train ``shafts`` and
    ``meshes`` in place of ``gears``, or ``roller`` in place of all; ``surface`` and ``run`` always. Numbers are SI;
    texts carry their unit ("34.715 um").

    Attributes
    ----------
    name : str
        What the scene is called in titles.
    gears, mesh, drive, load, initial : Gears, Mesh, Drive, Load, Initial or None
        The gear pair; None in a scene with a roller. In a train ``gears`` is None, and ``mesh`` has the keys that all
        its meshes share.
    shafts, meshes : mapping of str to Shaft, of str to Meshing, or None
        The train, by the names of its shafts and meshes; a pair has the shafts ``pinion`` and ``gear`` and the mesh
        ``mesh``. None in a scene with a roller.
    roller : Roller or None
        The roller; None in a scene with gears.
    surface, coating, contact : Surface, Coating, Contact
        The flanks. Without a table ``coating`` they are bare.
    run : Run

    Raises
    ------
    SceneError
        On construction, naming the first key that is wrong.

    Examples
    --------
    >>> from gearidae import preset
    >>> worn = preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.5})
    >>> worn.coating.sam_fraction
    0.5
    """

    model_config = ConfigDict(title="Scene")

    name: Annotated[str, BeforeValidator(_named)] = Field(
        default="scene", description="what the scene is called"
    )
    gears: Gears | None = Field(default=None, description="the two gears")
    shafts: NamedTables[Shaft] | None = Field(
        default=None, description="the shafts of a train, in place of gears"
    )
    meshes: NamedTables[Meshing] | None = Field(default=None, description="the meshes of a train")
    mesh: Mesh | None = Field(default=None, description="how their teeth meet")
    drive: Drive | None = Field(default=None, description="torque on the pinion, or on a shaft of a train")
    load: Load | None = Field(default=None, description="torque that resists the gear, or a shaft of a train")
    initial: Initial | None = Field(default=None, description="how the gears start")
    roller: Roller | None = Field(default=None, description="a roller in place of the gears")
    surface: Surface = Field(description="the rough flanks")
    coating: Coating = Field(default=Coating(sam_fraction=0.0), description="the monolayer on them")
    contact: Contact = Field(default=Contact(), description="laws of contact")
    run: Run = Field(description="how long and how accurate")

    def __new__(cls, **data: Any) -> Self:
        """Make a scene of the kind that its tables say."""
        if cls is not Scene:
            return super().__new__(cls)
        kind: type[Scene] = GearScene if data.get("roller") is None else RollerScene
        if data.get("gears") is None and any(data.get(table) is not None for table in ("shafts", "meshes")):
            kind = TrainScene
        return super().__new__(kind)  # type: ignore[return-value]

    @model_validator(mode="before")
    @classmethod
    def _no_load(cls, data: Any) -> Any:
        """Let gears run free where no load is given."""
        turns = isinstance(data, dict) and (data.get("gears") is not None or data.get("shafts") is not None)
        if turns and data.get("load") is None:
            return {**data, "load": Load()}
        return data

    @model_validator(mode="before")
    @classmethod
    def _named_surface(cls, data: Any) -> Any:
        """Write out a surface that is named, ``surface = "polysilicon, OTS"``."""
        return with_library(data) if isinstance(data, dict) else data

    @model_validator(mode="after")
    def _whole(self) -> Self:
        """Check what no table can check alone."""
        self._set_gap()
        check_stretch(self)
        check_thickness(self)
        check_tables(self)
        check_asperities(self)
        check_combinations(self)
        self._check_schedules()
        self._check_bodies()
        return self

    def _check_schedules(self) -> None:
        """Let what schedules repeat be no more than a run can do."""
        drive, load = self.drive or Drive(), self.load or Load()
        for key, schedule in (
            ("drive.schedule", drive.schedule),
            ("drive.speed", drive.speed_knots()),
            ("load.schedule", load.schedule),
        ):
            schedule.during(0.0, self.run.duration, key)

    def _check_bodies(self) -> None:
        """Check the tables of the bodies that meet."""

    def _set_gap(self) -> None:
        """Let a gap that is given in roughnesses follow this scene's roughness."""
        gap = None if self.initial is None else self.initial.gap
        if self.initial is None or not isinstance(gap, InRoughnesses):
            return
        length = InRoughnesses(gap.number, self.surface.roughness)
        if length != gap:  # a table of its own then: scenes share those that do not change
            object.__setattr__(self, "initial", self.initial.model_copy(update={"gap": length}))

    @property
    def geometry(self) -> Geometry:
        """The gears' mesh geometry.

        Raises
        ------
        SceneError
            If such gears cannot mesh, or the scene has none.
        """
        if self.gears is None:
            where = "has no mesh geometry" if self.roller else "or a train has none: see scene.train.meshes"
            raise SceneError("gears", "(missing)", f"a scene with a roller {where}")
        gears = self.gears
        try:
            return mesh_geometry(
                gears.pinion_base_radius, gears.pinion_teeth, gears.gear_teeth, gears.pressure_angle
            )
        except GeometryError as error:
            key = error.parameter
            raise SceneError(f"gears.{key}", getattr(gears, key), error.reason) from error

    @property
    def train(self) -> Train:
        """Shafts and meshes where they stand: senses, ratios, centres, phases, loops; of a pair, too.

        Raises
        ------
        SceneError
            If the scene has none.
        """
        if self.shafts is None or self.meshes is None:
            raise SceneError("shafts", "(missing)", "a scene with a roller has no train")
        return train_of(self)

    @property
    def coated_surface(self) -> Surface:
        """The surface where the monolayer covers it: with the coating's energy, Hamaker constant and contact angle."""
        own = ("energy", "hamaker", *(key.name for key in LAW_KEYS if key.coated is not None))
        return self.surface.model_copy(update={key: getattr(self.coating, key) for key in own})

    @property
    def attracts(self) -> bool:
        """Whether flanks attract each other across the gap: a material that they have has a Hamaker constant."""
        return any(material.share > 0.0 and material.surface.hamaker > 0.0 for material in self.materials())

    def materials(self) -> tuple[Material, ...]:
        """List the materials that share the interface of two flanks, see `gearidae.scene.coating`.

        Returns
        -------
        tuple of Material
            Surface, share [1], gap offset [m] and name of each: bare, coated, and with independent sides mixed. The
            shares add up to 1; a material that the flanks do not have has the share 0.
        """
        return materials_of(self.coating, self.surface)

    def replace(self, changes: Mapping[str, Any]) -> Self:
        """Return a scene with some keys changed, checked anew.

        Parameters
        ----------
        changes : mapping of str to object
            Dotted keys (``"coating.sam_fraction"``, ``"drive.harmonic.0.amplitude"``) or names of whole
            tables (None takes a table away) and what to put there, as in a case file. None or an empty list takes
            a schedule, harmonics or static errors away. A named surface
            (``{"surface": "polysilicon, OTS"}``) brings energy and thickness of its monolayer; the coverage stays.

        Returns
        -------
        Scene

        Raises
        ------
        SceneError
            If a key is unknown or what it is to hold is not allowed.
        """
        if not isinstance(changes, Mapping):
            raise SceneError("replace", shorten(changes), "must be a mapping from dotted keys to values")
        if isinstance(name := changes.get("surface"), str):
            changes = library_changes(name) | {key: changes[key] for key in changes if key != "surface"}
        for key, others in INSTEAD.items():
            for other in others:
                if changes.get(key) is not None and other in changes:
                    raise SceneError(
                        key, shorten(changes[key]), f"cannot be given beside {other}: choose one of the two"
                    )
        touched = {key.partition(".")[0] for key in changes if isinstance(key, str)}
        # tables that stay are shared: they have been checked, and a scene of an ensemble takes few kilobytes
        data: dict[str, Any] = {
            name: table for name, table in self if name not in touched and table is not None
        }
        data |= self._plain(touched)
        for key, value in changes.items():
            put(Scene, data, key, value)
        return Scene.from_dict(data)  # type: ignore[return-value]  # another kind only where its tables change

    def to_dict(self) -> dict[str, Any]:
        """Return the scene as plain tables, lists, texts and SI numbers, ready for JSON.

        Returns
        -------
        dict
            ``Scene.from_dict`` makes an equal scene of it, to the last bit.
        """
        return self._plain(None)

    def _plain(self, tables: set[str] | None) -> dict[str, Any]:
        """Return some tables, or all, as `to_dict` does."""
        data = self.plain_tables(exclude_none=True, include=tables)
        for table, key in _NOTHING_IF_EMPTY:
            if table in data and not data[table][key]:
                del data[table][key]
        return data

    def __repr__(self) -> str:
        """Return a line that says what the scene is, and how it differs from the nearest preset."""
        return as_line(self)

    __str__ = __repr__

    def _repr_html_(self) -> str:
        """Return a table of all keys with units, those that differ from the nearest preset marked."""
        return as_html(self)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """Make a scene from tables, as a case file or `to_dict` gives them.

        Parameters
        ----------
        data : mapping
            Tables by name; quantities are SI numbers or texts with a unit.

        Returns
        -------
        Scene

        Raises
        ------
        SceneError
            If anything in it is wrong.
        """
        if not isinstance(data, Mapping):
            raise SceneError("scene", shorten(data), "must be a mapping of tables")
        for key in data:
            if not isinstance(key, str):
                raise SceneError(str(shorten(key)), "(key)", "keys must be texts")
        return cls(**data)

    @classmethod
    def json_schema(cls) -> dict[str, Any]:
        """Describe what a case file may hold, for editors; see `gearidae.scene.schema.json_schema`.

        Returns
        -------
        dict
            A JSON Schema (draft 2020-12), ready for JSON.
        """
        return json_schema(cls)

    @classmethod
    def _elsewhere(cls, name: str) -> list[str]:
        """Return the keys of this name in all tables."""
        keys = [info.key for info in describe_keys() if NAME not in info.key]
        return [key for key in keys if key.rpartition(".")[2] == name]


class GearScene(Scene):
    """A scene with gears: it has all of their tables."""

    if TYPE_CHECKING:
        gears: Gears
        mesh: Mesh
        drive: Drive
        load: Load
        initial: Initial

    def _check_bodies(self) -> None:
        """Refuse gears that lack a table or cannot mesh, and starts from within the teeth."""
        for table in ("gears", "mesh", "drive", "initial"):
            if getattr(self, table) is None:
                raise SceneError(table, "(missing)", "is required in a scene without a roller")
        for table, value in self:
            if table in ("shafts", "meshes") and value is not None:
                raise SceneError(table, "(given)", "a scene has gears or shafts and meshes, not both")
        for key in _OF_A_TRAIN:
            if getattr(self.mesh, key) is not None:
                raise SceneError(
                    f"mesh.{key}", getattr(self.mesh, key), "is of a train; of a pair it stands in gears"
                )
        for key, name in (("drive", self.drive.shaft), ("load", self.load.shaft)):
            if name is not None:
                raise SceneError(f"{key}.shaft", name, "is of a train: pinion and gear have drive and load")
        refuse_judged(self)
        gears, mesh, geometry = self.gears, self.mesh, self.geometry
        if mesh.backlash >= geometry.base_pitch / 2:
            allowed = f"must be below half a base pitch, {geometry.base_pitch / 2:.4g} m"
            raise SceneError("mesh.backlash", mesh.backlash, allowed)
        self._check_errors()
        overlap = _DEEPEST_OVERLAP * self.surface.roughness
        room = mesh.backlash + sum(error_on_path(self, coast=coast) for coast in (False, True))
        room += play_at_start(self)
        most = room + overlap
        if not -overlap <= self.initial.gap <= most:
            raise SceneError(
                "initial.gap",
                self.initial.gap,
                f"must lie in {-overlap:.4g}..{most:.4g} m, or flanks would overlap",
            )
        if gears.pinion_teeth * self.run.exposures > _MOST_PLACES:
            raise SceneError(
                "run.exposures",
                self.run.exposures,
                f"must be {_MOST_PLACES // gears.pinion_teeth} at most for {gears.pinion_teeth} teeth of the pinion",
            )
        check_gaps(self)
        check_reach(self)
        check_population(self)
        check_friction(self)
        check_joints(self)

    def _check_errors(self) -> None:
        """Refuse errors of the mesh that would turn a shaft back, or jam the teeth."""
        mesh, geometry = self.mesh, self.geometry
        slope = sum(abs(harmonic.order * harmonic.amplitude) for harmonic in mesh.static_error)
        for key, runout, radius, name in (
            ("mesh.pinion_runout", mesh.pinion_runout, geometry.base_radius_pinion, "R1"),
            ("mesh.gear_runout", mesh.gear_runout, geometry.base_radius_gear, "R2"),
        ):
            if runout is not None and abs(runout.amplitude) >= radius:
                raise SceneError(
                    f"{key}.amplitude", runout.amplitude, f"must be below {name}, {radius:g} m, in size"
                )
        slope += 0.0 if mesh.pinion_runout is None else abs(mesh.pinion_runout.amplitude)
        if slope >= geometry.base_radius_pinion:
            raise SceneError(
                "mesh.static_error",
                f"(slope {slope:.4g} m/rad)",
                f"orders times amplitudes must add up to less than R1, {geometry.base_radius_pinion:g} m, with the"
                " pinion's runout",
            )
        check_pitch_errors(self)
        check_orbit(self)


def _shafts(scene: Scene) -> NamedTables[Shaft]:
    assert scene.gears is not None
    return pair_shafts(scene.gears)


def _meshes(scene: Scene) -> NamedTables[Meshing]:
    assert scene.gears is not None
    assert scene.mesh is not None
    return pair_meshes(scene.gears, scene.mesh)


# The fields hold what a case file gives, which is nothing for a pair: a pair derives them from its gears.
GearScene.shafts = property(_shafts)  # type: ignore[assignment]
GearScene.meshes = property(_meshes)  # type: ignore[assignment]


class TrainScene(Scene):
    """A scene with shafts and meshes."""

    if TYPE_CHECKING:
        shafts: NamedTables[Shaft]
        meshes: NamedTables[Meshing]
        drive: Drive
        load: Load
        initial: Initial

    def _check_bodies(self) -> None:
        """Refuse trains that lack a table, cannot turn or cannot be computed."""
        for table in ("shafts", "meshes", "drive", "initial"):
            if getattr(self, table) is None:
                raise SceneError(table, "(missing)", "is required in a scene with shafts and meshes")
        if self.roller is not None:
            raise SceneError("shafts", "(given)", "a scene has a roller or shafts, not both")
        check_train(self)
        judged_shaft(self)

    def pair(self, name: str) -> GearScene:
        """Return one mesh as a pair of gears, with its own tables, and what drives and loads the pair's two shafts.

        Parameters
        ----------
        name : str
            Of the mesh.

        Returns
        -------
        Scene
            Of a train with one mesh, its short form, whose runs have the same numbers.

        Raises
        ------
        SceneError
            If there is no such mesh, or what the train has does not stand in a pair.
        """
        return pair_of(self, name)


class RollerScene(Scene):
    """A scene with a roller."""

    if TYPE_CHECKING:
        roller: Roller

    def _check_bodies(self) -> None:
        """Refuse a scene without a roller, and what only gears have."""
        if self.roller is None:
            raise SceneError("roller", "(missing)", "is required in a scene without gears")
        for table in _GEAR_TABLES:
            if getattr(self, table) is not None:
                allowed = f"a scene has a roller or gears, not both; a roller takes no {table}"
                raise SceneError(table, "(given)", allowed)
        if self.run.stop != "time":
            raise SceneError("run.stop", self.run.stop, "must be time in a scene with a roller")
        refuse_judged(self)
        if self.run.exposures != 0:
            raise SceneError("run.exposures", self.run.exposures, "must be 0 in a scene with a roller")
        check_population(self)
        check_no_friction(self)


ONE_STAGE: Final = (
    "scene.pair(NAME) is a stage of the train, gearidae.dump_case(scene.pair(NAME)) its case for commands"
)
"""What there is where a train of several meshes is refused."""


def is_long_train(scene: Scene) -> TypeGuard[TrainScene]:
    """Whether a scene is a train of several meshes; one of one mesh is a pair of gears."""
    return isinstance(scene, TrainScene) and len(scene.meshes) > 1


def require_gears(scene: Scene) -> GearScene:
    """Refuse anything but a scene with a pair of gears, which is returned; of a train with one mesh the short form.

    Raises
    ------
    SceneError
        If it is something else.
    """
    if isinstance(scene, TrainScene):
        if is_long_train(scene):
            raise SceneError(
                "meshes",
                f"({len(scene.meshes)} meshes)",
                f"must be one here: this is of a single pair; {ONE_STAGE}",
            )
        return scene.pair(next(iter(scene.meshes)))
    if not isinstance(scene, GearScene):
        raise SceneError("scene", getattr(scene, "name", type(scene).__name__), "must be a scene with gears")
    return scene


def require_meshes(scene: Scene) -> GearScene | TrainScene:
    """Refuse anything but a scene with gears, a pair or a train, which is returned; of one mesh the short form.

    Raises
    ------
    SceneError
        If it is something else.
    """
    return scene if is_long_train(scene) else require_gears(scene)


def describe_keys() -> tuple[KeyInfo, ...]:
    """List every key of a scene in the order of a case file.

    Returns
    -------
    tuple of KeyInfo
    """
    return keys_of(Scene)


def describe_key(key: str) -> KeyInfo:
    """Look up one key.

    Parameters
    ----------
    key : str
        Dotted name; numbers of list entries are ignored (``drive.harmonic.0.amplitude``).

    Returns
    -------
    KeyInfo

    Raises
    ------
    SceneError
        If there is no such key.
    """
    return find_key(Scene, key)
