"""What in a scene is allowed but can hardly be meant: words before a run, which stop nothing."""

from __future__ import annotations

import logging
import math
from typing import TYPE_CHECKING, Final

from gearidae.laws.pairs import MESH_LAWS, has_mesh_law, number_of_mesh
from gearidae.scene import TrainScene
from gearidae.scene.gears import DISC_FACTOR, SILICON, disc_inertia
from gearidae.scene.joints import HubFriction, joints
from gearidae.scene.prefixes import with_prefix
from gearidae.torques import torque_law

if TYPE_CHECKING:
    from gearidae.scene import Scene

log = logging.getLogger(__name__)

_KEPT: Final = (("pinion", 1.5263e-20, 19), ("gear", 6.1052e-20, 76))
"""Inertias [kg m^2] and teeth of the presets' gears,"""
_KEPT_SIZE: Final = (34.715e-6, 2e-6)
"""their pinion's base radius and their face width [m]."""
_MEMORY: Final = (20e-9, 100e-9)
"""Usual memory lengths of rubbing surfaces [m]: the size of their contacts."""
_PEAKS: Final = 6.0
"""Height of a rough surface from valley to peak, in rms roughnesses."""


def doubts(scene: Scene) -> list[str]:
    """Say what in a scene can hardly be meant.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    list of str
        Sentences, each with the key and the numbers; empty for most scenes.
    """
    if isinstance(scene, TrainScene):
        lines = [f"mesh {name}: {line}" for name in scene.meshes for line in _sizes(scene.pair(name))]
        return lines + _idle_ageing(scene) + _laws(scene)
    parts = (_sizes, _resistance, _bodies, _path_force, _idle, _inertias, _laws)
    return [line for part in parts for line in part(scene)]


def log_doubts(scene: Scene) -> None:
    """Log each of the `doubts` about a scene as a warning."""
    for doubt in doubts(scene):
        log.warning("%s: %s", scene.name, doubt)


def _laws(scene: Scene) -> list[str]:
    """Name registered laws that jump in time or with the angle and do not say so."""
    lines = []
    for key, shaft in (("drive.law", scene.drive), ("load.law", scene.load)):
        if shaft is None or shaft.law is None or torque_law(shaft.law.name).is_declared:
            continue
        # with numba, and few scenes need it
        from gearidae.laws.shaft.own import JUMP_LOOKS, found_angles, law_knots

        name, numbers, end = shaft.law.name, shaft.law.numbers(), scene.run.duration
        looks = f"as {JUMP_LOOKS} looks at it show"
        times = law_knots(name, numbers, 0.0, end)
        if times:
            more = f" and {len(times) - 1} times later" if len(times) > 1 else ""
            lines.append(
                f"{key} = {name} jumps at {times[0]:.6g} s{more}, {looks}; shorter "
                f"pulses than {with_prefix(end / JUMP_LOOKS, 's')} may be missed: register it with "
                "knots=, the times at which it jumps, or switch=, a function whose zeros are where it does"
            )
        angles = max(found_angles(name, numbers, 0.0, end), key=len, default=())
        if angles:
            more = f" and {len(angles) - 1} more in a turn" if len(angles) > 1 else ""
            lines.append(
                f"{key} = {name} jumps at an angle of {angles[0]:.6g} rad{more}, {looks}; shorter sectors than "
                f"{with_prefix(2.0 * math.pi / JUMP_LOOKS, 'rad')} may be missed: register it with switch=, a function "
                "whose zeros are where it jumps"
            )
    return lines


def _sizes(scene: Scene) -> list[str]:
    """Compare the roughness and the asperities with the bodies that carry them."""
    sigma = scene.surface.roughness
    rough = f"surface.roughness = {with_prefix(sigma, 'm')}"
    lines = []
    if scene.mesh is not None and scene.gears is not None:
        module, width = scene.geometry.module, scene.gears.face_width
        if sigma > scene.mesh.backlash:
            lines.append(
                f"{rough} is larger than mesh.backlash = {with_prefix(scene.mesh.backlash, 'm')}: "
                "both flanks are pressed together all the time"
            )
        if _PEAKS * sigma > module:
            lines.append(
                f"{rough}: peaks of {_PEAKS:g} roughnesses are higher than the addendum of the teeth, "
                f"{with_prefix(module, 'm')}"
            )
    else:
        assert scene.roller is not None
        module, width = scene.roller.radius, scene.roller.width
        if _PEAKS * sigma > module:
            lines.append(
                f"{rough}: peaks of {_PEAKS:g} roughnesses are higher than roller.radius = "
                f"{with_prefix(module, 'm')}"
            )
    tip, spacing = scene.surface.asperity_radius, 1.0 / math.sqrt(scene.surface.asperity_density)
    if tip > module:
        lines.append(
            f"surface.asperity_radius = {with_prefix(tip, 'm')} is larger than the tooth or the roller that "
            f"carries it, {with_prefix(module, 'm')}"
        )
    if spacing > width:
        lines.append(
            f"surface.asperity_density: asperities stand {with_prefix(spacing, 'm')} apart, more than the "
            f"face width of {with_prefix(width, 'm')}"
        )
    return lines


def _bodies(scene: Scene) -> list[str]:
    """Say that bodies stay rigid where flanks attract each other."""
    if scene.contact.bodies != "auto" or not scene.attracts:
        return []
    words = 'contact.bodies = "auto" keeps the teeth rigid where flanks attract each other (hamaker), however hard they'
    return [f'{words} are pressed; "rigid" is the same without this warning']


def _path_force(scene: Scene) -> list[str]:
    """Say that discrete asperities push along the path of contact in any case."""
    if scene.mesh is None or scene.mesh.radius_force or not scene.contact.is_discrete:
        return []
    words = "mesh.radius_force = false has no effect on discrete asperities"
    return [f"{words}: each pushes where it stands, also along the path"]


def _resistance(scene: Scene) -> list[str]:
    """Compare the harmonics of the dry resistance with its constant part and its schedule."""
    load = scene.load
    if load is None or not load.harmonic:
        return []
    least = load.torque + min((value for _, value in load.schedule), default=0.0)
    swing = sum(abs(harmonic.amplitude) for harmonic in load.harmonic)
    if swing <= least:
        return []
    about = f"{with_prefix(swing, 'N m')} about a dry resistance of {with_prefix(least, 'N m')}"
    return [f"load.harmonic swings by {about}: it is cut off where the sum falls below 0"]


def _inertias(scene: Scene) -> list[str]:
    """Say that gears of another size have kept their inertias: those of the presets, or of smaller discs."""
    gears, lines = scene.gears, []
    if gears is None:
        return []
    radii = scene.geometry.base_radius_pinion, scene.geometry.base_radius_gear
    for (name, kept, teeth), radius in zip(_KEPT, radii, strict=True):
        inertia = getattr(gears, f"{name}_inertia")
        disc = disc_inertia(SILICON, gears.face_width, radius, gears.pressure_angle)
        size = (getattr(gears, f"{name}_teeth"), gears.pinion_base_radius, gears.face_width)
        if inertia == kept and size != (teeth, *_KEPT_SIZE):
            words = f"is still that of the presets, whose {name} has {teeth} teeth and another size"
        elif inertia != kept and disc > DISC_FACTOR * inertia:
            words = f"is {disc / inertia:.2g} times lighter than a solid disc of silicon of its size"
        else:
            continue
        lines.append(
            f"gears.{name}_inertia = {with_prefix(inertia, 'kg m^2')} {words}: give gears.density in place of both"
            " inertias, or that of this gear"
        )
    return lines


def _idle(scene: Scene) -> list[str]:
    """Name loads, films and attraction that do nothing, without their coefficient or their flank."""
    lines = []
    if scene.surface.hamaker > 0.0 and not any(
        part.name == "bare" and part.share > 0.0 for part in scene.materials()
    ):
        words = "has no effect where the coating covers all: coating.hamaker acts there"
        lines.append(f"surface.hamaker = {with_prefix(scene.surface.hamaker, 'J')} {words}")
    if scene.gears is None or scene.mesh is None:
        return lines
    lines += _idle_ageing(scene)
    if scene.gears.hub_friction == 0.0 == scene.gears.hub_friction_rise:
        for key in ("pinion_axial_load", "gear_axial_load", "pinion_hub_adhesion", "gear_hub_adhesion"):
            load = getattr(scene.gears, key)
            if load > 0.0:
                words = "has no effect without gears.hub_friction"
                lines.append(f"gears.{key} = {with_prefix(load, 'N')} {words}")
    return lines + _idle_laws(scene)


def _idle_laws(scene: Scene) -> list[str]:
    """Name keys of laws of the mesh that the scene does not have."""
    return [
        f"mesh.{constant.name} = {with_prefix(number, constant.key.unit)} has no effect without "
        f"mesh.{law.constants[0].name}"
        for law in MESH_LAWS
        if not has_mesh_law(scene, law)
        for constant in law.constants
        if (number := number_of_mesh(scene, constant.name)) > 0.0
    ]


def _idle_ageing(scene: Scene) -> list[str]:
    """Name times that nothing ages by, and memory lengths far from the size of contacts."""
    drive, start, there = scene.drive, scene.initial, joints(scene)
    if drive is None or start is None:
        return []
    lines = [
        f"{joint.name}: a memory length of {with_prefix(joint.memory_length, 'm')} is unusual: measured ones are some"
        " 20 to 100 nm, the size of contacts"
        for joint in there
        if joint.rise > 0.0 and not _MEMORY[0] <= joint.memory_length <= _MEMORY[1]
    ]
    if any(joint.rise > 0.0 for joint in there):
        return lines
    rise = "hub_friction_rise of a shaft" if isinstance(scene, TrainScene) else "gears.hub_friction_rise"
    hubs: dict[str, HubFriction] = {"gears": scene.gears} if scene.gears is not None else {}
    if isinstance(scene, TrainScene):
        hubs = {f"shafts.{name}": shaft for name, shaft in scene.shafts.items()}
    values = {
        f"{table}.hub_{key}": (getattr(keys, f"hub_{key}"), unit)
        for table, keys in hubs.items()
        for key, unit in (("ageing_time", "s"), ("memory_length", "m"))
    }
    values |= {
        "drive.pin_ageing_time": (drive.pin_ageing_time, "s"),
        "drive.pin_memory_length": (drive.pin_memory_length, "m"),
        "initial.rest_time": (start.rest_time, "s"),
    }
    return [
        f"{key} = {with_prefix(value, unit)} has no effect without {rise}"
        for key, (value, unit) in values.items()
        if value
    ]
