"""The gap at which a population begins to touch, where the gears stand at the start."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gearidae.asperities import law_of
from gearidae.mesh.involute import curvature_radii, flank_arc, separation
from gearidae.populations.flanks import flanks_of
from gearidae.populations.materials import materials_at
from gearidae.scene import MATERIAL_NAMES, GearScene

_BEYOND: Final = 1e-6
"""Roughnesses by which the gap is wider, so that rounding joins nothing."""


def first_touch(scene: GearScene) -> float:
    """Gap of the drive flank at which the first asperity is about to join.

    Parameters
    ----------
    scene : Scene
        Of gears, with a population; the gears stand as ``initial.mesh_phase`` says.

    Returns
    -------
    float
        Largest ``z - x^2 / (2 R) + d_on - s`` of all asperities of the pairs in mesh [m], with the tip relief s of the
        pair; with radii that differ, the joining distance d_on is that of the largest tip of a flank.
    """
    geometry, sigma, flanks = scene.geometry, scene.surface.roughness, flanks_of(scene)
    by_name = {material.name: material for material in scene.materials()}
    whole, phase = divmod(scene.initial.mesh_phase, 1.0)
    widest = -math.inf
    for pair in range(math.floor(phase - geometry.contact_ratio) - 1, 3):
        xi = (phase - pair) * geometry.base_pitch
        tooth = int(pair + whole)
        flank = flanks[2 * (tooth % geometry.pinion_teeth)]
        if not flank.arc.size:
            continue
        reach = {}
        for number in np.unique(material := materials_at(scene, flank, tooth)).tolist():
            surface = by_name[MATERIAL_NAMES[number]]
            largest = surface.surface.model_copy(update={"asperity_radius": float(flank.radius.max())})
            reach[number] = law_of(scene.contact.asperity, largest).join * sigma - surface.gap_offset
        joins = np.array([reach[number] for number in material.tolist()])
        x = flank.arc - float(flank_arc(geometry, xi))
        drop = x**2 / (2.0 * float(curvature_radii(geometry, xi)[2]))
        relief = float(separation(geometry, xi, scene.mesh.tip_relief_radius)[0])
        widest = max(widest, float((flank.height + joins - drop).max()) - relief)
    return widest + _BEYOND * sigma
