"""The asperities of a pinion's flank, as they meet the gear's."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearidae.arrays import Floats
from gearidae.mesh.involute import curvature_radii, flank_arc
from gearidae.populations.flanks import flanks_of
from gearidae.populations.materials import materials_at
from gearidae.records import Flank
from gearidae.scene import MATERIAL_NAMES, GearScene
from gearidae.scene.coating_table import met_teeth

Integers = NDArray[np.int64]


class MetFlank(NamedTuple):
    """The asperities of a pinion's flank, with the materials that they meet on the gear's.

    Attributes
    ----------
    arc : ndarray, shape (n,)
        Positions from the base circle [m].
    height : ndarray, shape (n,)
        Over the mean plane, less the recess where the monolayer is lost [m].
    radius : ndarray, shape (n,)
        Of the tips [m].
    material : ndarray of int, shape (n,)
        Among `gearidae.scene.MATERIAL_NAMES`.
    """

    arc: Floats
    height: Floats
    radius: Floats
    material: Integers

    def some(self, which: Integers | NDArray[np.bool_]) -> MetFlank:
        """Return some of them, by their numbers or by a mask."""
        return MetFlank(self.arc[which], self.height[which], self.radius[which], self.material[which])

    def overlaps(self, scene: GearScene, position: float, gap: float) -> Floats:
        """Overlap of each with the gear's flank [m], where the pair touches at a position on its path, at a gap [m]."""
        x = self.arc - contact_arc(scene, position)
        return np.asarray(self.height - gap - x**2 / (2.0 * _radius(scene, position)))


def met_flank(scene: GearScene, pair: int, flank: Flank) -> MetFlank:
    """Return the asperities of the pinion's flank in a pair of teeth.

    Parameters
    ----------
    scene : Scene
        With ``contact.roughness = "discrete"``.
    """
    coast = flank == Flank.COAST
    tooth, gear_tooth = (int(number) for number in met_teeth(pair, coast=coast))
    which = tooth % scene.gears.pinion_teeth, int(coast)
    asperities = next(drawn for drawn in flanks_of(scene) if (drawn.tooth, drawn.flank) == which)
    material = materials_at(scene, asperities, gear_tooth)
    recess = {surface.name: surface.gap_offset for surface in scene.materials()}
    recesses = np.array([recess.get(name, 0.0) for name in MATERIAL_NAMES])
    return MetFlank(asperities.arc, asperities.height - recesses[material], asperities.radius, material)


def contact_arc(scene: GearScene, position: float) -> float:
    """Arc on the pinion's flank at which a pair touches [m]: outside its path at its end."""
    return float(flank_arc(scene.geometry, min(max(position, 0.0), scene.geometry.path_length)))


def _radius(scene: GearScene, position: float) -> float:
    """Reduced radius of curvature where a pair touches [m]."""
    return float(curvature_radii(scene.geometry, position)[2])
