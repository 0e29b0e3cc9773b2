"""From a scene's friction to the numbers of its limits."""

from __future__ import annotations

import math

from gearidae.engine.model.state import MATERIALS, Record
from gearidae.errors import SceneError
from gearidae.mesh.involute import Geometry
from gearidae.scene import MATERIAL_NAMES, Gears, Scene
from gearidae.scene.friction import friction_values, has_flank_friction, has_hub_friction


def rubs(scene: Scene) -> bool:
    """Whether anything in a scene has friction."""
    return has_flank_friction(scene) or has_hub_friction(scene)


def add_friction(s: Record, scene: Scene, gears: Gears, geometry: Geometry) -> None:
    """Set levers, limits and hubs of a gear pair, whose force laws have been laid out.

    Parameters
    ----------
    s : record
        ``SCENE``; changed.
    """
    own = s.friction
    if not rubs(scene):
        return
    own.on, own.flanks = 1, int(has_flank_friction(scene))
    own.pinion_lever = float(s.base_pitch) / float(s.pinion_radius)
    own.gear_lever = float(s.base_pitch) / float(s.gear_radius)
    own.radii = 1.0 / float(s.sum_curvature)
    own.pinion_bend = float(s.length_unit) / float(s.pinion_radius)
    own.gear_bend = float(s.length_unit) / float(s.gear_radius)
    own.pinion_hub = gears.hub_friction * gears.pinion_hub_radius / geometry.base_radius_pinion
    own.gear_hub = gears.hub_friction * gears.gear_hub_radius / geometry.base_radius_gear
    own.cosine, own.sine = math.cos(2.0 * gears.pressure_angle), math.sin(2.0 * gears.pressure_angle)
    if own.flanks == 0:
        return
    if scene.contact.friction_law == "shear":
        raise SceneError("contact.friction_law", "shear", "is not available yet: must be net")
    values, shares = friction_values(scene), {one.name: one.share for one in scene.materials()}
    there = {values[name] for name in MATERIAL_NAMES if shares.get(name, 0.0) > 0.0}
    own.even = there.pop() if len(there) == 1 else 0.0
    for material in range(MATERIALS):
        own.scale[material] = values[MATERIAL_NAMES[material]] * float(s.material[material].force_scale)
        own.table_at[material] = s.material[material].table_at
