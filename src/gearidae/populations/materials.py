"""Which material meets at each asperity: its coverage numbers compared with the fractions at its position."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.mesh.involute import position_of_arc
from gearidae.populations.flanks import FlankAsperities
from gearidae.scene import MATERIAL_NAMES, Scene
from gearidae.scene.coating_table import fraction_at

Bools = NDArray[np.bool_]
_BARE, _COATED, _MIXED = (MATERIAL_NAMES.index(name) for name in ("bare", "coated", "mixed"))
MATERIAL_OF_SIDES: Final = np.array([[_BARE, _MIXED], [_MIXED, _COATED]])
"""Index of the material by whether the pinion's side and the gear's are covered."""


def along_path(scene: Scene, flank: FlankAsperities) -> NDArray[np.float64]:
    """Return the positions of a flank's asperities as shares of the path of contact; 0 of a roller."""
    if scene.gears is None:
        return np.zeros_like(flank.arc)
    geometry = scene.geometry
    return np.clip(position_of_arc(geometry, flank.arc) / geometry.path_length, 0.0, 1.0)


def covered_sides(scene: Scene, flank: FlankAsperities, gear_tooth: int) -> tuple[Bools, Bools]:
    """Say at which asperities the monolayer covers the pinion's side, and the gear's.

    Parameters
    ----------
    gear_tooth : int
        Of the gear that it meets.

    Returns
    -------
    pinion, gear : ndarray of bool, shape (n,)
        Which asperities lie on a covered part of each flank; alike for patches, which cover both sides.
    """
    positions = along_path(scene, flank)
    pinion, gear = scene.coating.tables
    first = flank.q < fraction_at(pinion, flank.tooth, positions)
    if scene.coating.pairing == "patches":
        return first, first
    return first, flank.q2 < fraction_at(gear, gear_tooth, positions)


def by_gear_tooth(scene: Scene) -> bool:
    """Whether the material at an asperity depends on the tooth of the gear that it meets."""
    return len(scene.coating.gear_table) > 1


def materials_met(scene: Scene, flank: FlankAsperities) -> NDArray[np.int64]:
    """Return the index of the material at each asperity, for all teeth of the gear.

    Returns
    -------
    ndarray, shape (1, n) or (2, n)
        One row where all teeth of the gear are alike; else one for where the gear's side is covered, and one for where
        it is bare.
    """
    if not by_gear_tooth(scene):
        return materials_at(scene, flank, 0)[None]
    first = covered_sides(scene, flank, 0)[0].astype(np.int64)
    return MATERIAL_OF_SIDES[first, 1 - np.arange(2)[:, None]]


def materials_at(scene: Scene, flank: FlankAsperities, gear_tooth: int) -> NDArray[np.int64]:
    """Return the index of the material at each asperity, among `gearidae.scene.MATERIAL_NAMES`; shape (n,)."""
    first, second = covered_sides(scene, flank, gear_tooth)
    return MATERIAL_OF_SIDES[first.astype(np.int64), second.astype(np.int64)]
