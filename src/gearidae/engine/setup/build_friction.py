"""From a scene's friction to the numbers of its limits."""

from __future__ import annotations

import math

import numpy as np

from gearidae.asperities import AsperityLaw
from gearidae.asperities.area import ContactArea
from gearidae.asperities.tip import asperity_of
from gearidae.contact.kernels.energy import loading_pieces
from gearidae.contact.kernels.law import N_LOADING, Kernel, law_table
from gearidae.engine.model.state import DRIVE, LOAD, MATERIALS, Record
from gearidae.engine.setup.tables import Tables
from gearidae.laws.frictions import bits_of, friction_laws_of
from gearidae.laws.joints import JOINTS, PIN
from gearidae.mesh.involute import Geometry
from gearidae.records.standing import Holding
from gearidae.scene import MATERIAL_NAMES, GearScene, Scene, Surface
from gearidae.scene.friction import friction_values, has_flank_friction
from gearidae.scene.joints import has_pin, joints


def add_friction(s: Record, scene: GearScene) -> None:
    """Set levers and hubs of a gear pair whose force laws have been laid out, and whether forces of pairs are noted.

    Parameters
    ----------
    s : record
        ``SCENE``; changed.
    """
    friction = s.friction
    friction.joints, friction.flanks = int(bool(joints(scene))), int(has_flank_friction(scene))
    for shaft in (DRIVE, LOAD):
        laws = friction_laws_of(scene, shaft)
        s.torque[shaft].resists = bits_of(laws)
        for holder in (holder for law in laws for holder in law.holders):
            friction.holding |= holder.number
    # a gear that is held by its own laws alone has a short way, through the motion and at events
    resists = s.torque[DRIVE].resists != 0
    friction.any_friction = int(friction.joints != 0 or friction.flanks != 0 or resists)
    friction.may_stick = int(friction.any_friction != 0 or s.torque[LOAD].resists != 0)
    friction.holding |= Holding.FLANK_FRICTION if friction.flanks != 0 else 0
    s.noting = int(scene.run.exposures > 0 or friction.any_friction != 0)
    if friction.any_friction == 0:
        return
    _add_joints(s, scene, scene.geometry)
    friction.pinion_lever = float(s.base_pitch) / float(s.pinion_radius)
    friction.gear_lever = float(s.base_pitch) / float(s.gear_radius)
    friction.radii = 1.0 / float(s.sum_curvature)
    friction.pinion_lever_slope = float(s.length_unit) / float(s.pinion_radius)
    friction.gear_lever_slope = float(s.length_unit) / float(s.gear_radius)
    friction.cosine, friction.sine = (
        math.cos(2.0 * scene.gears.pressure_angle),
        math.sin(2.0 * scene.gears.pressure_angle),
    )
    if friction.flanks == 0:
        return
    friction.shear = int(scene.contact.friction_law == "shear")
    values, shares = friction_values(scene), {material.name: material.share for material in scene.materials()}
    there = {values[name] for name in MATERIAL_NAMES if shares.get(name, 0.0) > 0.0}
    friction.even = there.pop() if len(there) == 1 and friction.shear == 0 else 0.0


def _add_joints(s: Record, scene: GearScene, geometry: Geometry) -> None:
    """Set what friction of the joints depends on."""
    friction, force = s.friction, float(s.force_unit)
    radii, numbers = (geometry.base_radius_pinion, geometry.base_radius_gear), [one.name for one in JOINTS]
    for joint in joints(scene):
        number = numbers.index(joint.name)
        shaft = JOINTS[number].shaft
        base, record = radii[shaft], friction.joint[number]
        record.by_load, record.arm = joint.arm / base, joint.radius / base
        record.constant = joint.torque(0.0) / force / base
        record.hold = joint.holding_torque / force / base
        record.coefficient, record.rise = joint.coefficient, joint.rise
        if joint.rise > 0.0:
            friction.ages, record.ageing_rate = 1, float(s.time_unit) / joint.ageing_time
            record.forgetting = float(s.length_unit) * joint.sliding_radius / base / joint.memory_length
        friction.holding |= int(joint.holding)
        rubs = int(joint.largest > 0.0)
        friction.hubs |= int(number != PIN and rubs != 0 and joint.radius > 0.0)
        friction.rubs[shaft] |= rubs
    if friction.joints != 0 and has_pin(scene):
        angle = geometry.pressure_angle + scene.drive.orientation
        friction.forced, friction.pin_cosine, friction.pin_sine = (
            1,
            math.cos(angle) / force,
            math.sin(angle) / force,
        )


class Limits:
    """Laws of the limits of a mean law's materials, laid out beside those of the forces.

    Parameters
    ----------
    scene : Scene
    kernel : {"line", "plane"}
        As for `gearidae.contact.kernels.law.law_table`.
    """

    def __init__(self, scene: Scene, kernel: Kernel) -> None:
        self._kernel, self._values = kernel, friction_values(scene)
        self._shear = scene.contact.friction_law == "shear"
        self._needed = has_flank_friction(scene)
        self._loading = np.zeros((MATERIALS, 8 * N_LOADING))

    def add(self, s: Record, tables: Tables, material: int, surface: Surface, law: AsperityLaw) -> None:
        """Add the limits of a material that the flanks have, whose force law has been laid out."""
        friction, force = s.friction, s.material[material]
        value = self._values[MATERIAL_NAMES[material]]
        if not self._needed or value == 0.0:
            return
        friction.table_at[material], friction.scale[material] = (
            force.table_at,
            value * float(force.force_scale),
        )
        if self._shear:
            law = ContactArea(law)
            # the unit of force of the law is that of a compression of sigma; that of the area is pi beta sigma
            area = value * math.pi * surface.asperity_radius * surface.roughness
            friction.scale[material] = area * float(force.force_scale) / hertz_unit(surface)
            friction.table_at[material] = tables.add(law_table(law, self._kernel))
        loading = loading_pieces(law, self._kernel, float(force.gap_offset))[0]
        self._loading[material] = friction.scale[material] * loading

    def finish(self, s: Record, tables: Tables) -> None:
        """Lay out the loading branch, of all materials together where their shares do not change."""
        if self._needed:
            mixed = self._loading.sum(axis=0) if s.covered_by_position == 0 else self._loading
            s.friction.loading_at = tables.add(mixed.ravel())


def hertz_unit(surface: Surface) -> float:
    """Load of an asperity without adhesion at a compression of the roughness [N]."""
    return asperity_of(surface).hertz_factor * surface.roughness**1.5
