"""What friction of the flanks and the hubs takes, estimated in closed form for a scene."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearidae.mesh.friction import hub_share, loss_fraction
from gearidae.mesh.pair_contact import pair_contact
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
        more; by their shares where no gap carries the load. Of the law ``shear``, strength times area over the force
        there; NaN where no gap carries the load.
    """
    if not has_flank_friction(scene):
        return 0.0
    values, contact = friction_values(scene), pair_contact(scene)
    shear, there = scene.contact.friction_law == "shear", [values[part.name] for part in contact.parts]
    if not shear and len(set(there)) == 1:
        return there[0]
    gap = contact.resting_gap(load)
    if math.isnan(gap):
        return math.nan if shear else sum(values[part.name] * part.share for part in contact.parts)
    counted = contact.part_areas(gap) if shear else contact.part_forces(gap)
    return max(sum(value * one for value, one in zip(there, counted, strict=True)) / load, 0.0)


def flank_loss(scene: Scene, load: float) -> float:
    """Share of the drive's work that friction of the flanks takes at a constant force [N]; NaN if nothing is known."""
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
        friction where no gap carries the force.
    """
    assert scene.gears is not None
    loss = flank_loss(scene, load)
    left = 1.0 if math.isnan(loss) else max(1.0 - loss, 0.0)
    return left * hub_share(scene.geometry, scene.gears.hub_friction, hub_radii(scene))
