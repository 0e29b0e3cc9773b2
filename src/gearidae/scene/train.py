"""A train laid out: the graph of its shafts and meshes, senses, ratios, centres, and how its loops close.

Shafts are joined by meshes, each from a driver to a driven gear. A spanning tree of the graph, walked from the drive,
determines the turning senses (``s_b = -s_a`` across a mesh), the ratios, the centres

    O_b = O_a + (R_a + R_b) / cos(alpha) (cos theta, sin theta)

and every angle of the shafts; each mesh besides closes a loop, which can turn only if it has an even number of meshes
and the same ratio either way. Phases of the meshes follow in `gearidae.scene.phases`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gearidae.errors import SceneError
from gearidae.mesh.involute import Geometry, GeometryError, mesh_geometry
from gearidae.scene.coating import Coating
from gearidae.scene.gears import LAW_KEYS, Mesh, disc_inertia
from gearidae.scene.group import did_you_mean
from gearidae.scene.joints import HUB_KEYS
from gearidae.scene.named_tables import NamedTables
from gearidae.scene.phases import Mount, with_phases
from gearidae.scene.shafts import Meshing, Shaft, friction_of
from gearidae.scene.surface import Contact, Surface

if TYPE_CHECKING:
    from gearidae.scene.gears import Gears
    from gearidae.scene.scene import Scene

MOST_SHAFTS: Final = 16
MOST_MESHES: Final = 24
_SAME_SIZE: Final = 1e-9
"""Relative difference of two base radii that come from products in another order."""
_SEED_BITS: Final = 53
"""Of the largest seed that a scene has."""
_SAME_PLACE: Final = 1e-6
"""Relative error of a distance, and error of an angle [rad], with which a loop may close."""


@dataclass(frozen=True, slots=True)
class TrainShaft:
    """A shaft where it stands.

    Attributes
    ----------
    name : str
    gears : tuple of str
        Names of its gears, as meshes use them.
    inertia : float
        [kg m^2].
    sense : int
        1 counter-clockwise, -1 clockwise, where the drive's shaft turns counter-clockwise.
    ratio : fractions.Fraction
        Its speed over that of the drive's shaft, each in its own forward sense.
    centre : tuple of float
        x and y, from the centre of the drive's shaft [m].
    """

    name: str
    gears: tuple[str, ...]
    inertia: float
    sense: int
    ratio: Fraction
    centre: tuple[float, float]


@dataclass(frozen=True, slots=True)
class TrainMesh:
    """A mesh where it stands, with all of its keys.

    Attributes
    ----------
    name : str
    driver, driven : str
        Names of its gears.
    a, b : int
        Numbers of their shafts.
    geometry : Geometry
        The driver for the pinion, the driven for the gear.
    mesh : Mesh
    coating : Coating
    surface : Surface
    contact : Contact
        With the seed of its own discrete asperities.
    face_width : float
        [m].
    angle : float
        Of the line of centres from driver to driven, counter-clockwise from the frame's x axis [rad].
    phase : float
        Position of pair 0 on the path of contact at the start, in base pitches.
    offset : float
        By how much the driven gear stands back [m], with what is left over where a loop closes.
    closes : bool
        Whether it closes a loop; the others are a spanning tree.
    residual : float
        Pitches by which its loop does not close, -1/2 to 1/2.
    mounts : tuple of Mount
        Of its driver and of its driven gear.
    """

    name: str
    driver: str
    driven: str
    a: int
    b: int
    geometry: Geometry
    mesh: Mesh
    coating: Coating
    surface: Surface
    contact: Contact
    face_width: float
    angle: float
    phase: float
    offset: float
    closes: bool
    residual: float
    mounts: tuple[Mount, Mount] = (Mount(0), Mount(1))

    @property
    def ratio(self) -> Fraction:
        """Speed of the driver over that of the driven gear."""
        return Fraction(self.geometry.gear_teeth, self.geometry.pinion_teeth)


@dataclass(frozen=True, slots=True)
class Train:
    """Shafts and meshes of a scene, in the order of its tables.

    Attributes
    ----------
    shafts : tuple of TrainShaft
    meshes : tuple of TrainMesh
    drive, load : int
        Numbers of the shafts that are driven and loaded.
    loops : tuple of tuple of str
        Names of the meshes of each loop, the one that closes it last.
    """

    shafts: tuple[TrainShaft, ...]
    meshes: tuple[TrainMesh, ...]
    drive: int
    load: int
    loops: tuple[tuple[str, ...], ...]

    def shaft(self, name: str) -> TrainShaft:
        """Return the shaft of a name."""
        return next(shaft for shaft in self.shafts if shaft.name == name)

    def mesh(self, name: str) -> TrainMesh:
        """Return the mesh of a name.

        Raises
        ------
        SceneError
            If there is none.
        """
        for mesh in self.meshes:
            if mesh.name == name:
                return mesh
        names = [mesh.name for mesh in self.meshes]
        raise SceneError("mesh", name, f"must be one of {', '.join(names)}")


def pair_shafts(gears: Gears) -> NamedTables[Shaft]:
    """Write a pair of gears as two shafts, ``pinion`` and ``gear``.

    Raises
    ------
    SceneError
        If the pair has what the shafts of a train have no keys for.
    """
    for key in LAW_KEYS:
        if (value := getattr(gears, key)) > 0.0:
            reason = "must be 0 where a pair is to be a train, whose shafts have no such key"
            raise SceneError(f"gears.{key}", value, reason)
    shafts = {
        name: Shaft(
            inertia=getattr(gears, f"{name}_inertia"),
            teeth=getattr(gears, f"{name}_teeth"),
            **(friction_of(gears) if _has_joint(gears, name) else {}),
            **{key: getattr(gears, f"{name}_{key}") for key in HUB_KEYS.values()},
        )
        for name in ("pinion", "gear")
    }
    return NamedTables(shafts)


def pair_meshes(gears: Gears, mesh: Mesh) -> NamedTables[Meshing]:
    """Write the mesh of a pair of gears as that of a train, ``mesh``."""
    sizes = {
        "driver_base_radius": gears.pinion_base_radius,
        "pressure_angle": gears.pressure_angle,
        "face_width": gears.face_width,
    }
    own: dict[str, Any] = {key: value for key, value in mesh if value is not None} | sizes
    return NamedTables({"mesh": Meshing(driver="pinion", driven="gear", **own)})


def _has_joint(gears: Gears, shaft: str) -> bool:
    return bool(getattr(gears, f"{shaft}_hub_radius") or getattr(gears, f"{shaft}_dimple_radius"))


# Scenes are frozen: all that ask for the same scene's train get the same one.
@lru_cache(maxsize=64)
def train_of(scene: Scene) -> Train:
    """Lay out the train of a scene.

    Parameters
    ----------
    scene : Scene
        With shafts and meshes, or with a pair of gears.

    Returns
    -------
    Train

    Raises
    ------
    SceneError
        If such shafts and meshes make no train that turns, naming the key.
    """
    shafts, meshes, initial = scene.shafts, scene.meshes, scene.initial
    assert shafts is not None
    assert meshes is not None
    assert initial is not None
    for key, tables, most in (("shafts", shafts, MOST_SHAFTS), ("meshes", meshes, MOST_MESHES)):
        if len(tables) > most:
            raise SceneError(key, f"({len(tables)} tables)", f"there may be {most} at most")
    teeth = {gear: z for name, shaft in shafts.items() for gear, z in shaft.gear_teeth(name).items()}
    home = {
        gear: number for number, (name, shaft) in enumerate(shafts.items()) for gear in shaft.gear_teeth(name)
    }
    drive, load = _named_shafts(scene, list(shafts))
    bare = [_mesh(scene, number, name, teeth, home) for number, name in enumerate(meshes)]
    _check_direction(list(shafts), bare, drive)
    _check_sizes(bare)
    placements, tree = _walk(bare, [meshes[mesh.name].angle is None for mesh in bare], drive)
    loops = _check_loops(list(shafts), bare, placements, tree, drive)
    placed = _with_angles(bare, meshes, placements, tree)
    placed = with_phases(
        placed,
        [meshes[mesh.name].phase for mesh in placed],
        [placements[number][0] for number in range(len(shafts))],
        initial.mesh_phase,
        initial.gap,
        drive,
    )
    return Train(
        shafts=tuple(
            TrainShaft(
                name,
                tuple(shaft.gear_teeth(name)),
                _inertia(name, shaft, placed),
                placements[number][0],
                placements[number][1],
                placements[number][2],
            )
            for number, (name, shaft) in enumerate(shafts.items())
        ),
        meshes=tuple(placed),
        drive=drive,
        load=load,
        loops=loops,
    )


def _named_shafts(scene: Scene, names: list[str]) -> tuple[int, int]:
    """Numbers of the shafts that drive and load name: the first and the last by default."""
    numbers = []
    for key, table, default in (("drive", scene.drive, 0), ("load", scene.load, len(names) - 1)):
        name = None if table is None else table.shaft
        if name is not None and name not in names:
            meant = did_you_mean(name, names)
            raise SceneError(f"{key}.shaft", name, meant or f"must be one of {', '.join(names)}")
        numbers.append(default if name is None else names.index(name))
    return numbers[0], numbers[1]


def _mesh(
    scene: Scene, number: int, name: str, teeth: Mapping[str, int], home: Mapping[str, int]
) -> TrainMesh:
    """Put the tables of a mesh together, and lay its two gears out."""
    assert scene.meshes is not None
    entry = scene.meshes[name]
    for side in ("driver", "driven"):
        gear = getattr(entry, side)
        if gear not in teeth:
            meant = did_you_mean(gear, teeth) or f"must be one of {', '.join(teeth)}"
            raise SceneError(f"meshes.{name}.{side}", gear, meant)
    if home[entry.driver] == home[entry.driven]:
        raise SceneError(f"meshes.{name}.driven", entry.driven, "must be a gear of another shaft")
    mesh = _merged(f"meshes.{name}", Mesh, scene.mesh, entry.own("mesh"))
    coating = _merged(f"meshes.{name}.coating", Coating, scene.coating, entry.own("coating"))
    surface = _merged(f"meshes.{name}.surface", Surface, scene.surface, entry.own("surface"))
    contact = _merged(f"meshes.{name}.contact", Contact, scene.contact, _own_asperities(scene, number, name))
    angle = _required(name, mesh, "pressure_angle")
    if mesh.driver_base_radius is None:
        module = _required(name, mesh, "module")
        radius = 0.5 * module * teeth[entry.driver] * math.cos(angle)
    else:
        radius = mesh.driver_base_radius
    try:
        geometry = mesh_geometry(radius, teeth[entry.driver], teeth[entry.driven], angle)
    except GeometryError as error:
        side = {"pinion_teeth": "driver", "gear_teeth": "driven"}.get(error.parameter, error.parameter)
        value = angle if side == "pressure_angle" else getattr(entry, side)
        raise SceneError(f"meshes.{name}.{side}", value, error.reason) from error
    return TrainMesh(
        name=name,
        driver=entry.driver,
        driven=entry.driven,
        a=home[entry.driver],
        b=home[entry.driven],
        geometry=geometry,
        mesh=mesh,
        coating=coating,
        surface=surface,
        contact=contact,
        face_width=_required(name, mesh, "face_width"),
        angle=0.0 if entry.angle is None else entry.angle,
        phase=0.0,
        offset=entry.offset,
        closes=False,
        residual=0.0,
    )


def _own_asperities(scene: Scene, number: int, name: str) -> dict[str, Any]:
    """Keys of the contact that a mesh has of its own; surfaces of a seed of the scene differ from mesh to mesh.

    The first mesh has that of the seed itself, as a pair does.
    """
    assert scene.meshes is not None
    own = scene.meshes[name].own("contact")
    if number > 0 and scene.contact.is_discrete and "seed" not in own:
        drawn = np.random.SeedSequence([scene.contact.seed, number]).generate_state(1, np.uint64)
        own["seed"] = int(drawn[0]) >> (64 - _SEED_BITS)
    return own


def _merged(key: str, table: Any, common: Any, own: dict[str, Any]) -> Any:
    """Table of a mesh: that of the scene with the keys that the mesh has of its own."""
    if common is not None and not own:
        return common
    given = {} if common is None else {name: value for name, value in common if value is not None}
    if own.get("driver_base_radius") is not None:
        given.pop("module", None)
    elif own.get("module") is not None:
        given.pop("driver_base_radius", None)
    try:
        return table(**{**given, **own})
    except SceneError as error:
        raise SceneError(f"{key}.{error.key}", error.value, error.allowed) from error


def _required(name: str, mesh: Mesh, key: str) -> float:
    value: float | None = getattr(mesh, key)
    if value is None:
        other = ", or driver_base_radius in its place" if key == "module" else ""
        raise SceneError(f"meshes.{name}.{key}", "(missing)", f"is required, here or in mesh{other}")
    return value


def _check_direction(names: Sequence[str], meshes: Sequence[TrainMesh], drive: int) -> None:
    """Refuse a shaft that no mesh drives, and one that is driven through itself."""
    for mesh in meshes:
        if mesh.b == drive:
            reason = f"is on {names[drive]}, the shaft of the drive: driver and driven are in the wrong order"
            raise SceneError(f"meshes.{mesh.name}.driven", mesh.driven, reason)
    reached, left = {drive}, list(meshes)
    for number, name in enumerate(names):
        if number != drive and all(mesh.b != number for mesh in meshes):
            raise SceneError("shafts", name, "must be driven: no mesh has a gear of this shaft as driven")
    while left:
        # a shaft is reached where all that drive it are
        ready = [mesh for mesh in left if mesh.a in reached]
        left = [mesh for mesh in left if mesh.a not in reached]
        reached |= {mesh.b for mesh in ready if all(other.b != mesh.b for other in left)}
        if not ready:
            around = ", ".join(mesh.name for mesh in left)
            reason = (
                f"is driven through itself, or not from the drive: driver is the gear nearer to it ({around})"
            )
            raise SceneError(f"meshes.{left[0].name}.driver", left[0].driver, reason)


def _check_sizes(meshes: Sequence[TrainMesh]) -> None:
    """Let every gear have one base radius and one pressure angle in all of its meshes, and meet another once."""
    for number, mesh in enumerate(meshes):
        for other in meshes[:number]:
            if (other.driver, other.driven) == (mesh.driver, mesh.driven):
                reason = f"meets {mesh.driver} in meshes.{other.name} already: two gears have one mesh"
                raise SceneError(f"meshes.{mesh.name}.driven", mesh.driven, reason)
    sizes: dict[str, tuple[str, float, float]] = {}
    for mesh in meshes:
        geometry = mesh.geometry
        for gear, radius in (
            (mesh.driver, geometry.base_radius_pinion),
            (mesh.driven, geometry.base_radius_gear),
        ):
            first, known, angle = sizes.setdefault(gear, (mesh.name, radius, geometry.pressure_angle))
            if not math.isclose(radius, known, rel_tol=_SAME_SIZE):
                what = f"gives {gear} the base radius {radius:.6g} m, and meshes.{first} {known:.6g} m"
            elif geometry.pressure_angle != angle:
                what = f"gives {gear} another pressure angle than meshes.{first}"
            else:
                continue
            raise SceneError(f"meshes.{mesh.name}", f"({gear})", f"{what}: a gear has one size")


Placements = dict[int, tuple[int, Fraction, tuple[float, float]]]


def _walk(
    meshes: Sequence[TrainMesh], without_angle: Sequence[bool], drive: int
) -> tuple[Placements, dict[int, int]]:
    """Walk a spanning tree from the drive.

    A mesh without an angle of its own is the last that is taken, so that it closes its loop wherever it is listed.

    Returns
    -------
    places : dict
        Sense, speed over that of the drive, and centre of each shaft.
    tree : dict of int to int
        Number of the mesh through which each shaft but the drive's is reached.
    """
    placements: Placements = {drive: (1, Fraction(1), (0.0, 0.0))}
    tree: dict[int, int] = {}
    while True:
        order = list(placements)
        ahead = [k for k, mesh in enumerate(meshes) if mesh.a in placements and mesh.b not in placements]
        if not ahead:
            return placements, tree
        number = min(ahead, key=lambda k: (without_angle[k], order.index(meshes[k].a), k))
        mesh = meshes[number]
        sense, ratio, centre = placements[mesh.a]
        away = _distance(mesh)
        there = (centre[0] + away * math.cos(mesh.angle), centre[1] + away * math.sin(mesh.angle))
        placements[mesh.b] = (-sense, ratio / mesh.ratio, there)
        tree[mesh.b] = number


def _distance(mesh: TrainMesh) -> float:
    """Distance of the centres of two gears [m]."""
    geometry = mesh.geometry
    return (geometry.base_radius_pinion + geometry.base_radius_gear) / math.cos(geometry.pressure_angle)


def _check_loops(
    names: Sequence[str],
    meshes: Sequence[TrainMesh],
    placements: Placements,
    tree: Mapping[int, int],
    drive: int,
) -> tuple[tuple[str, ...], ...]:
    """Refuse loops that cannot turn; return the names of the meshes of each."""
    loops = []
    for number, mesh in enumerate(meshes):
        if number in tree.values():
            continue
        ways = [_way(shaft, meshes, tree, drive) for shaft in (mesh.a, mesh.b)]
        loop = [name for name in ways[0] if name not in ways[1]]
        loop += [name for name in reversed(ways[1]) if name not in ways[0]]
        loops.append((*loop, mesh.name))
        around = f"the loop {', '.join(loops[-1])}"
        if placements[mesh.a][0] == placements[mesh.b][0]:
            raise SceneError(
                f"meshes.{mesh.name}",
                f"({names[mesh.a]} and {names[mesh.b]} turn the same way)",
                f"{around} has an odd number of meshes ({len(loops[-1])}), and cannot turn",
            )
        closed = placements[mesh.a][1] / mesh.ratio
        if closed != placements[mesh.b][1]:
            raise SceneError(
                f"meshes.{mesh.name}",
                f"({names[mesh.b]} at {placements[mesh.b][1]} and at {closed} of the drive's speed)",
                f"{around} has two ratios, and cannot turn",
            )
    return tuple(loops)


def _way(shaft: int, meshes: Sequence[TrainMesh], tree: Mapping[int, int], drive: int) -> list[str]:
    """Names of the meshes from a shaft back to the drive."""
    way = []
    while shaft != drive:
        mesh = meshes[tree[shaft]]
        way.append(mesh.name)
        shaft = mesh.a
    return way


def _with_angles(
    meshes: Sequence[TrainMesh], given: Mapping[str, Meshing], placements: Placements, tree: Mapping[int, int]
) -> list[TrainMesh]:
    """Take the angles of meshes that close loops from the centres, which have to fit."""
    placed = []
    for number, mesh in enumerate(meshes):
        if number in tree.values():
            placed.append(mesh)
            continue
        begin, end = placements[mesh.a][2], placements[mesh.b][2]
        across = (end[0] - begin[0], end[1] - begin[1])
        wanted, there = _distance(mesh), math.hypot(*across)
        if abs(there - wanted) > _SAME_PLACE * wanted:
            reason = (
                f"the loop does not close: the centres are {there:.9g} m apart, and must be {wanted:.9g} m"
            )
            raise SceneError(f"meshes.{mesh.name}", f"({(there / wanted - 1.0):.3g} of the distance)", reason)
        angle, said = math.atan2(across[1], across[0]), given[mesh.name].angle
        if said is not None and abs(math.remainder(said - angle, 2.0 * math.pi)) > _SAME_PLACE:
            reason = f"must be {angle:.12g} rad, as the centres have it, or left out: this mesh closes a loop"
            raise SceneError(f"meshes.{mesh.name}.angle", said, reason)
        placed.append(replace(mesh, angle=angle, closes=True))
    return placed


def _inertia(name: str, shaft: Shaft, meshes: Sequence[TrainMesh]) -> float:
    """Moment of inertia of a shaft: its own, or that of the discs of all its gears."""
    if shaft.inertia is not None:
        return shaft.inertia
    assert shaft.density is not None
    total = 0.0
    for gear in shaft.gear_teeth(name):
        met = [mesh for mesh in meshes if gear in (mesh.driver, mesh.driven)]
        if not met:
            raise SceneError(
                f"shafts.{name}.density", shaft.density, f"needs a size of {gear}, which is in no mesh"
            )
        mesh = met[0]
        geometry = mesh.geometry
        radius = geometry.base_radius_pinion if gear == mesh.driver else geometry.base_radius_gear
        width = max(mesh.face_width for mesh in met)
        total += disc_inertia(shaft.density, width, radius, geometry.pressure_angle)
    return total
