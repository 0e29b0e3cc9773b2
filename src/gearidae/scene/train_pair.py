"""One mesh of a train as a pair of gears: what estimates are made for, and each mesh is checked by."""

from __future__ import annotations

import re
from collections.abc import Container
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final

from gearidae.errors import SceneError
from gearidae.scene.friction import has_flank_friction
from gearidae.scene.gears import Gears
from gearidae.scene.group import shorten
from gearidae.scene.joints import HUB_KEYS, check_train_joints
from gearidae.scene.pitch_errors import errors_in_train
from gearidae.scene.shafts import FRICTION_KEYS, friction_of
from gearidae.scene.torque import Drive, Load

if TYPE_CHECKING:
    from gearidae.scene.scene import GearScene, TrainScene
    from gearidae.scene.train import TrainMesh

_SIZES: Final = dict.fromkeys(("module", "driver_base_radius", "pressure_angle", "face_width"))


@lru_cache(maxsize=64)
def pair_of(scene: TrainScene, name: str) -> GearScene:
    """Return one mesh of a train as a pair; see `TrainScene.pair`."""
    from gearidae.scene.scene import GearScene

    train, alone = scene.train, len(scene.meshes) == 1
    mesh = train.mesh(name)
    hubs = _hubs(scene, mesh) if alone else {}
    drive, load = Drive(), Load()
    if alone:
        drive, load = _torques(scene, mesh)
    try:
        return GearScene(
            name=scene.name,
            gears=Gears(
                pinion_inertia=train.shafts[mesh.a].inertia,
                gear_inertia=train.shafts[mesh.b].inertia,
                pinion_base_radius=mesh.geometry.base_radius_pinion,
                pinion_teeth=mesh.geometry.pinion_teeth,
                gear_teeth=mesh.geometry.gear_teeth,
                pressure_angle=mesh.geometry.pressure_angle,
                face_width=mesh.face_width,
                **hubs,
            ),
            mesh=mesh.mesh.model_copy(update=_SIZES | ({} if alone else _teeth(mesh))),
            drive=drive,
            load=load,
            initial=scene.initial.model_copy(update={"mesh_phase": mesh.phase, "gap": _gap(scene, mesh)}),
            surface=mesh.surface,
            coating=mesh.coating,
            contact=mesh.contact,
            run=scene.run.model_copy(update={"judged": None}),
        )
    except SceneError as error:
        key = _train_key(mesh, error.key, [*scene.shafts], scene.meshes[name].own("contact"))
        value, allowed = error.value, error.allowed
        for word, gear in (("pinion", mesh.driver), ("gear", mesh.driven)):
            allowed = re.sub(rf"\bthe {word}\b", gear, allowed)
        if key == "initial.gap" and mesh.offset != 0.0:
            key, value, allowed = f"meshes.{name}.offset", mesh.offset, f"with it initial.gap {allowed}"
        raise SceneError(key, value, allowed) from error


def _teeth(mesh: TrainMesh) -> dict[str, Any]:
    """Errors of the teeth of a mesh, where they are drawn: one set for each gear of the train, whatever its meshes."""
    if mesh.mesh.pitch_error_rms == 0.0 or mesh.mesh.pinion_pitch_error or mesh.mesh.gear_pitch_error:
        return {}
    driver, driven = errors_in_train(mesh)
    return {
        "pitch_error_rms": 0.0,
        "pinion_pitch_error": tuple(driver.tolist()),
        "gear_pitch_error": tuple(driven.tolist()),
    }


def _gap(scene: TrainScene, mesh: TrainMesh) -> float:
    """Gap of a mesh at the start, which an offset opens; that of a mesh which closes a loop follows from the others."""
    if mesh.offset == 0.0 and mesh.surface == scene.surface:
        return scene.initial.gap  # as it is given, perhaps in roughnesses
    return float(scene.initial.gap) + (0.0 if mesh.closes else mesh.offset)


def _hubs(scene: TrainScene, mesh: TrainMesh) -> dict[str, Any]:
    """Keys of both hubs; a pair has one friction for both."""
    names = [*scene.shafts]
    keys: dict[str, Any] = {}
    frictions: dict[str, dict[str, Any]] = {}
    for side, number in (("pinion", mesh.a), ("gear", mesh.b)):
        shaft = scene.shafts[names[number]]
        keys |= {f"{side}_{key}": getattr(shaft, key) for key in HUB_KEYS.values()}
        if shaft.hub_of(names[number]) is not None:
            frictions[names[number]] = friction_of(shaft)
    for key in FRICTION_KEYS if len(frictions) > 1 else ():
        first, second = (frictions[names[number]].get(key) for number in (mesh.a, mesh.b))
        if first != second:
            reason = f"must be that of the other shaft, {shorten(first)}, in a train of one mesh"
            raise SceneError(f"shafts.{names[mesh.b]}.{key}", shorten(second), reason)
    return keys | next(iter(frictions.values()), {})


def _torques(scene: TrainScene, mesh: TrainMesh) -> tuple[Drive, Load]:
    """Drive and load of a train with one mesh, as those of its pair."""
    train, names = scene.train, [*scene.shafts]
    if train.load != mesh.b:
        raise SceneError("load.shaft", names[train.load], f"must be {names[mesh.b]} in a train of one mesh")
    for name, shaft in scene.shafts.items():
        for key in ("resistance", "viscous", "drag"):
            if getattr(shaft, key) > 0.0:
                reason = "must be 0 in a train of one mesh, which has the constants of load alone"
                raise SceneError(f"shafts.{name}.{key}", getattr(shaft, key), reason)
    orientation = scene.drive.orientation - mesh.angle if scene.drive.law is not None else 0.0
    return (
        scene.drive.model_copy(update={"shaft": None, "orientation": orientation}),
        scene.load.model_copy(update={"shaft": None}),
    )


def _train_key(mesh: TrainMesh, key: str, names: list[str], own: Container[str]) -> str:
    """Name the key of a train that a key of its pair comes from; `own` are those of the contact that the mesh has."""
    table, _, last = key.partition(".")
    if table in ("coating", "surface") or (table == "contact" and last in own):
        return f"meshes.{mesh.name}.{key}"
    if mesh.mesh.pitch_error_rms > 0.0 and last in ("pinion_pitch_error", "gear_pitch_error"):
        last = "pitch_error_rms"
    if table == "gears":
        side, _, rest = last.partition("_")
        if side in ("pinion", "gear") and rest != "base_radius" and rest != "teeth":
            return f"shafts.{names[mesh.a if side == 'pinion' else mesh.b]}.{rest}"
        ends = {"pinion_teeth": "driver", "gear_teeth": "driven", "pinion_base_radius": "module"}
        last = ends.get(last, last)
    return f"meshes.{mesh.name}.{last}" if table in ("gears", "mesh") else key


def rubbing_mesh(scene: TrainScene) -> str | None:
    """Name of the first mesh of a train whose flanks have friction, None if there is none."""
    names = (mesh.name for mesh in scene.train.meshes)
    return next((name for name in names if has_flank_friction(pair_of(scene, name))), None)


def check_train(scene: TrainScene) -> None:
    """Refuse trains that cannot turn, meshes that could not run as pairs, and what several meshes cannot have.

    Raises
    ------
    SceneError
        Naming the key.
    """
    pairs = [pair_of(scene, mesh.name) for mesh in scene.train.meshes]
    if len(pairs) == 1:
        return
    check_train_joints(scene)
    train, contact, run = scene.train, scene.contact, scene.run
    if all(mesh.b != train.load for mesh in train.meshes):
        raise SceneError("load.shaft", train.shafts[train.load].name, "must be a shaft that a mesh drives")
    refused = (
        (contact.bodies == "elastic", "contact.bodies", "their nodes are laid out for one mesh"),
        (run.exposures > 0, "run.exposures", "exposures are tables of one mesh"),
        (run.stop == "sticks", "run.stop", "each of its shafts may stick"),
        (run.impacts, "run.impacts", "impacts are a table of one mesh"),
        (
            run.method != "auto",
            "run.method",
            "a train has a formula of its own; another driver may be chosen",
        ),
        (
            run.samples == "ringing",
            "run.samples",
            "how its contacts ring is not known before: samples must be a number or a rate",
        ),
    )
    for there, key, reason in refused:
        if there:
            table, name = key.split(".")
            value = getattr(getattr(scene, table), name)
            raise SceneError(key, value, f"cannot be combined with several meshes: {reason}")
