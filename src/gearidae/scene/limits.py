"""Limits that no key has alone: what the engine can keep, tabulate and resolve, checked before anything is computed."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, Final

from gearidae.asperities import law_class, law_names, law_of
from gearidae.asperities.ranges import GAP_LOW
from gearidae.asperities.ranges import check_reach as check_asperity_reach
from gearidae.errors import SceneError
from gearidae.scene.coating import THICKEST
from gearidae.scene.pitch_errors import errors_range

if TYPE_CHECKING:
    from gearidae.scene.scene import GearScene, Scene

MOST_PAIRS: Final = 32
"""Tooth pairs of one flank whose history the engine keeps at a time."""
WIDEST_BACKLASH: Final = 1e9
"""Backlash over roughness up to which a double holds a gap to 1e-7 roughnesses."""


def check_stretch(scene: Scene) -> None:
    """Refuse asperities that stretch farther, or join from farther, than the force law is tabulated.

    Keys that one law alone needs are required with it, and refused without, where they would have no effect.

    Raises
    ------
    SceneError
        Naming ``surface.roughness``, or the key.
    """
    name = scene.contact.asperity
    for key in sorted({key for law in law_names() for key in law_class(law).needs}):
        value, needed = getattr(scene.surface, key, None), key in law_class(name).needs
        if value is None and needed:
            raise SceneError(f"surface.{key}", "(missing)", f'is required with contact.asperity = "{name}"')
        if value is not None and not needed:
            raise SceneError(f"surface.{key}", value, f'has no effect with contact.asperity = "{name}"')
    for material in scene.materials():
        if material.share > 0.0:
            surface = material.surface
            check_asperity_reach(law_of(scene.contact.asperity, surface), surface.roughness)


def check_thickness(scene: Scene) -> None:
    """Refuse a monolayer so thick that bare places lie beyond the reach of the asperities.

    Raises
    ------
    SceneError
        Naming ``coating.thickness``.
    """
    most = THICKEST * scene.surface.roughness
    if scene.coating.thickness > most:
        raise SceneError(
            "coating.thickness",
            scene.coating.thickness,
            f"must be at most {THICKEST:g} roughnesses, {most:.3g} m",
        )


def pairs_within_reach(scene: GearScene, cutoff: float) -> float:
    """Tooth pairs of one flank that can be in touch at a time, by their tip relief.

    A pair at a distance of d base pitches from the path of contact has its gap opened by ``d^2 pb^2 / (2 rho)``. Where
    the flanks overlap by as much as is tabulated, the pair touches as long as that is less than the cut-off and the
    overlap together: ``d = sqrt(2 (cutoff - gap_low) rho sigma) / pb``, on either side of the path. Pitch errors add by
    how much pairs differ: a tooth that stands out touches before it enters.

    Parameters
    ----------
    scene : Scene
        Of gears.
    cutoff : float
        Gap from which there is no force, in roughnesses.

    Returns
    -------
    float
        Contact ratio, and twice that distance.
    """
    geometry = scene.geometry
    relief = geometry.base_pitch**2 / (scene.mesh.tip_relief_radius * scene.surface.roughness)
    return geometry.contact_ratio + 2.0 * math.sqrt(2.0 * relief_in_reach(scene, cutoff) / relief)


def relief_in_reach(scene: GearScene, cutoff: float) -> float:
    """Tip relief, in roughnesses, by which a pair may be apart more than another that overlaps, and still touch."""
    return max(cutoff - GAP_LOW, 0.0) + errors_range(scene) / scene.surface.roughness


def check_reach(scene: GearScene, cutoff: float = 0.0) -> None:
    """Refuse a tip relief so slight that more pairs are in touch than can be kept.

    Parameters
    ----------
    scene : Scene
        Of gears.
    cutoff : float, optional
        Gap from which there is no force, in roughnesses. Only the tables of the force law tell it; a scene is checked
        with 0 first, before they are made, and with the true one where the engine makes them.

    Raises
    ------
    SceneError
        Naming ``mesh.tip_relief_radius``.
    """
    pairs = pairs_within_reach(scene, cutoff)
    if pairs <= MOST_PAIRS:
        return
    radius, ratio = scene.mesh.tip_relief_radius, scene.geometry.contact_ratio
    most = radius * max((MOST_PAIRS - ratio) / (pairs - ratio), 0.0) ** 2
    raise SceneError(
        "mesh.tip_relief_radius",
        radius,
        f"{pairs:.3g} tooth pairs would be in touch at a time, and {MOST_PAIRS} can be kept:"
        f" must be below {most:.3g} m with this roughness and base pitch",
    )


def check_gaps(scene: GearScene) -> None:
    """Refuse gaps that a double cannot hold beside the backlash, and discrete asperities that fill the backlash.

    Raises
    ------
    SceneError
        Naming ``mesh.backlash``, ``initial.gap`` or ``surface.roughness``.
    """
    mesh, initial, sigma = scene.mesh, scene.initial, scene.surface.roughness
    deepest = mesh.backlash + scene.surface.asperity_radius
    if scene.contact.is_discrete and sigma > deepest:
        raise SceneError(
            "surface.roughness",
            sigma,
            f"must be at most mesh.backlash and surface.asperity_radius together, {deepest:.3g} m, with"
            ' contact.roughness = "discrete": both flanks would be pressed onto thousands of asperities, deeper than'
            " their radius",
        )
    if mesh.backlash > WIDEST_BACKLASH * sigma:
        raise SceneError(
            "mesh.backlash",
            mesh.backlash,
            f"must be below {WIDEST_BACKLASH:g} roughnesses, {WIDEST_BACKLASH * sigma:.3g} m:"
            " gaps cannot be resolved beside it",
        )
    resolved = sys.float_info.epsilon * max(mesh.backlash, sigma)
    if 0.0 < abs(initial.gap) < resolved:
        raise SceneError(
            "initial.gap",
            initial.gap,
            f"must be 0 or at least {resolved:.2g} m in size: less cannot be resolved beside backlash and roughness",
        )
