"""What the flanks have been exposed to: sums of the engine as variables per area, over tooth and place."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from typing import Any

import numpy as np

from gearidae.archive.variables import EXPOSURES, PLACES
from gearidae.arrays import Floats
from gearidae.records import ExposureRows, Solution
from gearidae.scene import MATERIAL_NAMES, GearScene, Scene, require_gears
from gearidae.scene.coating import interface_shares
from gearidae.scene.coating_table import fraction_at
from gearidae.scene.friction import has_flank_friction

FLANKS = ("drive", "coast")
_POINTS = 64  # in each bin, for means over it


def flank_areas(scene: GearScene) -> Floats:
    """Areas of one flank of the pinion that the bins along it stand for.

    Along the path of contact the contact moves on the involute by ``rho / R1`` of its way, rho being the pinion's
    radius of curvature.

    Parameters
    ----------
    scene : Scene
        Of gears, with ``run.exposures`` above 0.

    Returns
    -------
    ndarray, shape (bins,)
        Square metres.
    """
    geometry = scene.geometry
    edges = _edges(scene)
    tangent = geometry.base_radius_pinion * math.tan(scene.gears.pressure_angle)
    radius = tangent - geometry.approach + edges
    return np.asarray(scene.gears.face_width * np.diff(radius**2) / (2.0 * geometry.base_radius_pinion))


def gear_flank_areas(scene: GearScene) -> Floats:
    """Areas of one flank of the gear that the bins along it stand for: what meets `flank_areas` of the pinion.

    Parameters
    ----------
    scene : Scene
        Of gears, with ``run.exposures`` above 0.

    Returns
    -------
    ndarray, shape (bins,)
        Square metres.
    """
    geometry = scene.geometry
    radius = geometry.tangent_gear + geometry.approach - _edges(scene)
    return np.asarray(scene.gears.face_width * -np.diff(radius**2) / (2.0 * geometry.base_radius_gear))


def _edges(scene: Scene) -> Floats:
    """Edges of the bins along the path of contact [m]."""
    geometry = scene.geometry
    return np.linspace(0.0, geometry.contact_ratio * geometry.base_pitch, scene.run.exposures + 1)


def exposure_coordinates(scene: Scene) -> dict[Hashable, Any]:
    """Make the coordinates of the exposures; none if the scene asks for none."""
    if scene.run.exposures == 0 or not isinstance(scene, GearScene):
        return {}
    edges = _edges(scene)
    values: dict[str, Any] = {
        "place": 0.5 * (edges[1:] + edges[:-1]),
        "flank_area": flank_areas(scene),
        "tooth": np.arange(scene.gears.pinion_teeth),
        "material": np.array([material.name for material in scene.materials()]),
        "flank": np.array(FLANKS),
    }
    return {name: (PLACES[name].dims, value, PLACES[name].attributes) for name, value in values.items()}


def exposure_variables(
    scene: Scene,
    scenes: Sequence[Scene],
    solutions: Sequence[Solution],
    dims: tuple[str, ...] = (),
    shape: tuple[int, ...] = (),
) -> dict[Hashable, Any]:
    """Make the variables of the runs' exposures.

    Parameters
    ----------
    scene : Scene
        That the runs were derived from.
    scenes : sequence of Scene
        Of each run.
    solutions : sequence of Solution
        One a run.
    dims, shape : tuple, optional
        Swept dimensions and their lengths.

    Returns
    -------
    dict
        Name to dimensions, values and attributes; NaN where a run produced nothing. Empty if the scene asks for none,
        or the runs do not have the same bins.
    """
    shapes = {
        (member.run.exposures, member.gears and member.gears.pinion_teeth, len(member.materials()))
        for member in (scene, *scenes)
    }
    if (
        scene.run.exposures == 0
        or len(shapes) > 1
        or all(solution.extremes is None for solution in solutions)
    ):
        return {}
    parts = [
        _per_area(require_gears(member), solution) for member, solution in zip(scenes, solutions, strict=True)
    ]
    made: dict[Hashable, Any] = {}
    for name, variable in EXPOSURES.items():
        if name == "friction_work" and not any(has_flank_friction(member) for member in scenes):
            continue
        values = np.stack([part[name] for part in parts])
        made[name] = ((*dims, *variable.dims), values.reshape(*shape, *values.shape[1:]), variable.attributes)
    return made


def _per_area(scene: GearScene, solution: Solution) -> dict[str, Floats]:
    """Exposures of one run, per area of the pinion's flanks."""
    rows = ExposureRows.of(len(MATERIAL_NAMES))
    rubs = has_flank_friction(scene)
    shape = (len(FLANKS), scene.gears.pinion_teeth, rows.per_tooth(rubs=rubs), scene.run.exposures)
    if solution.extremes is None or len(solution.extremes.exposures) != math.prod(shape):
        table = np.full(shape, math.nan)
    else:
        table = np.array(solution.extremes.exposures).reshape(shape)
    area = flank_areas(scene)
    geometry, surface, width = scene.geometry, scene.surface, scene.gears.face_width
    unit = math.sqrt(2.0 * geometry.base_pitch * surface.roughness)  # of a contact of unit length
    materials = scene.materials()
    by_material = table.swapaxes(1, 2)
    contacts = by_material[:, rows.contacts : rows.contacts + len(materials)] / area
    lost = by_material[:, rows.adhesion : rows.adhesion + len(materials)] / area
    shares = np.array([1.0 if scene.coating.by_place else material.share for material in materials])[
        :, None, None
    ]
    if scene.contact.is_discrete:
        # each asperity has been counted, in bins that its material covers
        shares = _shares_by_position(scene)
        contacts = np.divide(contacts, shares, out=np.zeros_like(contacts), where=shares > 0.0)
    else:
        contacts *= surface.asperity_density * width * unit
    return {
        "asperity_contacts": contacts,
        "adhesion_work": np.divide(lost, shares, out=np.zeros_like(lost), where=shares > 0.0),
        "sliding_work": table[:, :, rows.sliding] / area,
        "largest_pressure": table[:, :, rows.pressure] / (width * unit),
        "friction_work": (table[:, :, rows.friction] if rubs else np.zeros(shape[:2] + shape[3:])) / area,
    }


def _shares_by_position(scene: GearScene) -> Floats:
    """Share of each material in each bin of the pinion's teeth, the mean over the gear's teeth that they meet.

    Returns
    -------
    ndarray, shape (flanks, materials, teeth, bins)
    """
    gears, bins = scene.gears, scene.run.exposures
    along = (np.arange(_POINTS * bins) + 0.5) / (_POINTS * bins)
    teeth, flanks = np.arange(gears.pinion_teeth), np.arange(len(FLANKS))
    pinion, gear = scene.coating.tables
    first = fraction_at(pinion, teeth[:, None], along)
    meets = math.gcd(gears.pinion_teeth, len(gear))
    second = (
        fraction_at(gear, np.arange(len(gear))[:, None], along).reshape(-1, meets, along.size).mean(axis=0)
    )
    second = second[(teeth + flanks[:, None]) % meets]
    parts = interface_shares(scene.coating.pairing, np.broadcast_to(first, second.shape), second)
    shares = np.stack([parts[material.name] for material in scene.materials()], axis=1)
    return np.asarray(shares.reshape(*shares.shape[:-1], bins, _POINTS).mean(axis=-1))
