"""From a scene's friction to the numbers of its limits."""

from __future__ import annotations

import math

import numpy as np

from gearidae.asperities import AsperityLaw
from gearidae.asperities.area import ContactArea
from gearidae.asperities.tip import asperity_of
from gearidae.contact.kernels.energy import loading_pieces
from gearidae.contact.kernels.law import N_LOADING, Kernel, law_table
from gearidae.engine.model.state import MATERIALS, Record
from gearidae.engine.setup.tables import Tables
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
    own = s.friction
    own.joints, own.flanks = int(bool(joints(scene))), int(has_flank_friction(scene))
    own.rubs = int(own.joints != 0 or own.flanks != 0)
    own.on = int(own.rubs != 0 or s.dry != 0)
    own.holding = Holding.DRY_RESISTANCE if s.dry != 0 else 0
    own.holding |= Holding.FLANK_FRICTION if own.flanks != 0 else 0
    s.noting = int(scene.run.exposures > 0 or own.rubs != 0)
    if own.rubs == 0:
        return
    _add_joints(s, scene, scene.geometry)
    own.pinion_lever = float(s.base_pitch) / float(s.pinion_radius)
    own.gear_lever = float(s.base_pitch) / float(s.gear_radius)
    own.radii = 1.0 / float(s.sum_curvature)
    own.pinion_bend = float(s.length_unit) / float(s.pinion_radius)
    own.gear_bend = float(s.length_unit) / float(s.gear_radius)
    own.cosine, own.sine = (
        math.cos(2.0 * scene.gears.pressure_angle),
        math.sin(2.0 * scene.gears.pressure_angle),
    )
    if own.flanks == 0:
        return
    own.shear = int(scene.contact.friction_law == "shear")
    values, shares = friction_values(scene), {one.name: one.share for one in scene.materials()}
    there = {values[name] for name in MATERIAL_NAMES if shares.get(name, 0.0) > 0.0}
    own.even = there.pop() if len(there) == 1 and own.shear == 0 else 0.0


def _add_joints(s: Record, scene: GearScene, geometry: Geometry) -> None:
    """Set what friction of the joints depends on."""
    own = s.friction
    pinion, gear, force = geometry.base_radius_pinion, geometry.base_radius_gear, float(s.force_unit)
    for joint in joints(scene):
        constant = joint.torque(0.0) / force
        if joint.name == "pin":
            own.pin, own.pin_arm = joint.arm / pinion, joint.radius / pinion
        elif joint.name == "gear hub":
            own.gear_hub, own.gear_arm = joint.arm / gear, joint.radius / gear
            own.gear_constant = constant / gear
        else:
            own.pinion_hub, own.pinion_arm = joint.arm / pinion, joint.radius / pinion
            own.pinion_constant = constant / pinion
        own.holding |= int(joint.holding)
    own.pinion_rubs = int(own.pinion_hub > 0.0 or own.pinion_constant > 0.0 or own.pin > 0.0)
    own.gear_rubs = int(own.gear_hub > 0.0 or own.gear_constant > 0.0)
    if own.joints != 0 and has_pin(scene):
        angle = geometry.pressure_angle + scene.drive.orientation
        own.forced, own.pin_cosine, own.pin_sine = 1, math.cos(angle) / force, math.sin(angle) / force


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
        """Add those of a material that the flanks have, whose force law has been laid out."""
        own, force = s.friction, s.material[material]
        value = self._values[MATERIAL_NAMES[material]]
        if not self._needed or value == 0.0:
            return
        own.table_at[material], own.scale[material] = force.table_at, value * float(force.force_scale)
        if self._shear:
            law = ContactArea(law)
            # the unit of force of the law is that of a compression of sigma; that of the area is pi beta sigma
            area = value * math.pi * surface.asperity_radius * surface.roughness
            own.scale[material] = area * float(force.force_scale) / hertz_unit(surface)
            own.table_at[material] = tables.add(law_table(law, self._kernel))
        loading = loading_pieces(law, self._kernel, float(force.gap_offset))[0]
        self._loading[material] = own.scale[material] * loading

    def finish(self, s: Record, tables: Tables) -> None:
        """Lay out the loading branch, of all materials together where their shares do not change."""
        if self._needed:
            mixed = self._loading.sum(axis=0) if s.by_place == 0 else self._loading
            s.friction.loading_at = tables.add(mixed.ravel())


def hertz_unit(surface: Surface) -> float:
    """Load of an asperity without adhesion at a compression of the roughness [N]."""
    return asperity_of(surface).hertz_factor * surface.roughness**1.5
