"""The strip of a flank on which a population's asperities stand, and how many there may be."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from gearidae.asperities import law_of
from gearidae.errors import SceneError
from gearidae.mesh.involute import curvature_radii, flank_arc

if TYPE_CHECKING:
    from gearidae.scene.scene import Scene

BEYOND: Final = 1e-6
"""Length of the strip beyond both ends of the path of contact [m], or to either side of a roller's middle; more where
asperities that stand so high and so far away touch all the same."""
HIGHEST: Final = 5.0
"""Roughnesses that an asperity is taken to be high at most, where the mean planes touch."""
MOST: Final = 5_000_000
"""Asperities of a scene at most, in the mean of what is drawn; they take half a gigabyte."""


def flank_strip(scene: Scene) -> tuple[float, float]:
    """Return both ends of the strip, which no coverage, torque or seed changes.

    Returns
    -------
    low, high : float
        Arc from the base circle of the pinion, or distance from the middle of a roller [m].
    """
    stretch = max(
        law_of(scene.contact.asperity, material.surface).detach for material in scene.materials()
    )  # roughnesses; of all materials, whether the scene has them or not
    reach = (HIGHEST + stretch) * scene.surface.roughness
    if scene.roller is not None:
        beyond = max(BEYOND, math.sqrt(2.0 * scene.roller.radius * reach))
        return -beyond, beyond
    geometry = scene.geometry
    ends = (0.0, geometry.path_length)
    beyond = max(BEYOND, math.sqrt(2.0 * float(curvature_radii(geometry, ends)[2].max()) * reach))
    low, high = flank_arc(geometry, ends).tolist()
    return low - beyond, high + beyond


def check_population(scene: Scene) -> None:
    """Refuse more asperities than can be kept.

    Raises
    ------
    SceneError
        Naming ``surface.asperity_density``.
    """
    if not scene.contact.is_discrete:
        return
    if scene.contact.asperities:
        return
    low, high = flank_strip(scene)
    width, flanks = (scene.roller.width, 1) if scene.roller else (0.0, 0)
    if scene.gears is not None:
        width, flanks = scene.gears.face_width, 2 * scene.gears.pinion_teeth
    mean = scene.surface.asperity_density * width * (high - low) * flanks
    if mean > MOST:
        raise SceneError(
            "surface.asperity_density",
            scene.surface.asperity_density,
            f"gives {mean:.3g} asperities on {flanks} flanks; a population has {MOST:g} at most",
        )
