"""What friction of the flanks and the hubs takes, estimated in closed form for a scene."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearidae.mesh.friction import hub_share, loss_fraction
from gearidae.runs.pair_contact import pair_contact
from gearidae.scene.friction import friction_values, has_flank_friction

if TYPE_CHECKING:
    from gearidae.scene import Scene


def flank_coefficient(scene: Scene, load: float) -> float:
    """Friction of a pair of flanks over the force that presses them together.

    Parameters
    ----------
    scene : Scene
        A gear pair.
    load : float
        Force of the pair [N].

    Returns
    -------
    float
        Of materials with different coefficients, the mean by the forces that they carry at the pair's resting gap, 0 or
        more; by their shares where no gap carries the load. NaN for the law ``shear``, whose limit is no multiple
        of the force.
    """
    if not has_flank_friction(scene):
        return 0.0
    if scene.contact.friction_law != "net":
        return math.nan
    values, contact = friction_values(scene), pair_contact(scene)
    there = {values[part.name] for part in contact.parts}
    if len(there) == 1:
        return there.pop()
    gap = contact.resting_gap(load)
    if math.isnan(gap):
        return sum(values[part.name] * part.share for part in contact.parts)
    carried = contact.part_forces(gap)
    rubbed = sum(values[part.name] * force for part, force in zip(contact.parts, carried, strict=True))
    return max(rubbed / sum(carried), 0.0)


def flank_loss(scene: Scene, load: float) -> float:
    """Share of the drive's work that friction of the flanks takes at a constant force [N]; NaN for the law ``shear``."""
    coefficient = flank_coefficient(scene, load)
    return loss_fraction(scene.geometry, coefficient) if coefficient != 0.0 else 0.0


def hub_radii(scene: Scene) -> tuple[float, float]:
    """Radii of the hubs of pinion and gear [m]."""
    assert scene.gears is not None
    return scene.gears.pinion_hub_radius, scene.gears.gear_hub_radius


def transmitted_share(scene: Scene, load: float) -> float:
    """Share of the drive's work that friction leaves, at a constant force of the teeth.

    Returns
    -------
    float
        What the flanks leave times what the hubs leave, 0 or more; flanks of the law ``shear`` count as without
        friction.
    """
    assert scene.gears is not None
    loss = flank_loss(scene, load)
    left = 1.0 if math.isnan(loss) else max(1.0 - loss, 0.0)
    return left * hub_share(scene.geometry, scene.gears.hub_friction, hub_radii(scene))
