"""Coefficients of friction beside those at which teeth or hubs lock: rows of the validity of a scene."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from gearidae.mesh.friction import locking_coefficients
from gearidae.scene.friction import friction_values, has_flank_friction
from gearidae.scene.joints import joints
from gearidae.scene.validity_row import ValidityRow

if TYPE_CHECKING:
    from gearidae.scene import GearScene

_NEAR_LOCKING: Final = 0.5
"""Share of the coefficient that locks teeth or hubs, up to which friction changes forces by less than double."""


def locking_rows(scene: GearScene) -> Iterator[ValidityRow]:
    """Compare coefficients of friction with those that lock the teeth or a hub; nothing where they are zero."""
    gears, geometry, values = scene.gears, scene.geometry, friction_values(scene)
    where = max((values[one.name] for one in scene.materials() if one.share > 0.0), default=0.0)
    if has_flank_friction(scene) and scene.contact.friction_law == "coulomb":
        locks = min(locking_coefficients(geometry))
        yield _near_locking("locking_teeth", "coefficient of friction of the flanks", where, locks, "teeth")
    bases = {"pinion hub": geometry.base_radius_pinion, "gear hub": geometry.base_radius_gear}
    ratios = [joint.radius / bases[joint.name] for joint in joints(scene) if joint.name in bases]
    if gears.hub_friction > 0.0 and any(ratios):
        quantity, coefficient = "coefficient of friction of the hubs", gears.hub_friction
        yield _near_locking("locking_hubs", quantity, coefficient, 1.0 / max(ratios), "hubs")


def _near_locking(name: str, quantity: str, coefficient: float, locks: float, what: str) -> ValidityRow:
    holds = coefficient <= _NEAR_LOCKING * locks
    verdict = (
        f"the {what} are far from locking"
        if holds
        else f"near self-locking: the {what} can carry {1.0 / (1.0 - coefficient / locks):.2g} times their load"
    )
    limit = f"{_NEAR_LOCKING * locks:.3g}, half of that which can lock the {what}"
    bound = _NEAR_LOCKING * locks
    return ValidityRow(name, quantity, f"{coefficient:g}", limit, verdict, holds, coefficient, bound, "1")
