"""From the Hamaker constants of a scene to what its pairs attract each other with, and how far."""

from __future__ import annotations

from typing import Final

from gearidae.contact.attraction import FLOOR
from gearidae.engine.model.state import Record
from gearidae.engine.setup.build_contact import add_coverage, parts_of
from gearidae.engine.setup.tables import Tables
from gearidae.errors import SceneError
from gearidae.scene import GearScene, Scene
from gearidae.scene.limits import MOST_PAIRS, pairs_within_reach

NEGLIGIBLE: Final = 1e-6
"""Of the reference load: attraction ends where it is as small. It falls with a power of the gap, unlike the force of
asperities, and the farther it reaches the more pairs of gears have a part in it."""
NEGLIGIBLE_ALONE: Final = 1e-20
"""The same for a roller, which is one pair anyway."""


def add_attraction(
    s: Record, tables: Tables, scene: Scene, width: float, unit_length: float, widest: float
) -> None:
    """Set the attraction of each material, and move the cut-off to where it is negligible; nothing without it.

    Parameters
    ----------
    s : record
        ``SCENE`` with its contact; changed.
    width, unit_length : float
        Face width, and ``sqrt(2 R sigma)`` of a contact of unit length [m].
    widest : float
        Largest contact length.

    Raises
    ------
    SceneError
        If it reaches more pairs than can be kept.
    """
    if not scene.attracts:
        return
    if scene.contact.is_discrete:
        add_coverage(s, tables, scene)
    sigma, cutoff = scene.surface.roughness, float(s.cutoff)
    s.attracts, s.attraction_floor = 1, FLOOR / sigma
    least = NEGLIGIBLE if isinstance(scene, GearScene) else NEGLIGIBLE_ALONE
    for own, (surface, share, offset, _) in zip(s.material, parts_of(scene), strict=False):
        force = surface.hamaker * width * unit_length / (16.0 * sigma**3)
        own.gap_offset, own.attraction = offset / sigma, share * force / float(s.force_unit)
        cutoff = max(cutoff, (float(own.attraction) * widest / least) ** 0.4 - float(own.gap_offset))
    s.cutoff = cutoff
    if isinstance(scene, GearScene) and pairs_within_reach(scene, cutoff) > MOST_PAIRS:
        key = "surface.hamaker" if scene.surface.hamaker > 0.0 else "coating.hamaker"
        raise SceneError(
            key,
            max(scene.surface.hamaker, scene.coating.hamaker),
            f"attraction is felt {cutoff * sigma:.3g} m away beside so small a load, by more than the {MOST_PAIRS} "
            "tooth pairs of a flank that can be kept: needs a smaller constant, a larger torque or a smaller "
            "mesh.tip_relief_radius",
        )
