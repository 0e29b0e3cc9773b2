"""What samples and events of any run must satisfy, whatever its scene.

Gaps are worked out again from the angles. Forces of the asperity model must lie between those of a contact that has
just been made and of one stretched to its limit, by quadrature and not by the engine's tables; with bodies that give
way the force has no such bounds, as deflection can take a contact to either side of them.

What flanks are exposed to must add up to what the energy balance has lost by adhesion.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearidae.asperities.tip import asperity_of
from gearidae.contact.line import line_force
from gearidae.mesh.involute import curvature_radii, separation
from gearidae.records import EVENT, EnergyBalance, EventKind, ExposureRows, Extremes
from gearidae.scene import MATERIAL_NAMES, Scene
from gearidae.scene.combinations import may_deflect
from gearidae.scene.friction import has_flank_friction

Floats = NDArray[np.float64]

_WITH_FORCE = [EventKind.ONSET, EventKind.SEPARATION]
_CHECKED_SAMPLES = 24
_GAP_TOLERANCE = 1e-7  # of the roughness: rounding of angles and radii
_FAR = 10.0  # lengths of adhesion, by which every law's asperities have let go
_FORCE_TOLERANCE = 1e-5  # of what pushes and pulls: e^6 of the gap's tolerance per roughness, and the tables
_NEGLECTED = (
    1e-11  # of the scene's reference force: beyond the cut-off the engine takes less than 1e-13 as nothing
)

_ADHESION_TOLERANCE = 1e-6  # of the adhesion loss: both take how lengths change from the same integral
_ELASTIC_TOLERANCE = 1e-2  # the same with elastic bodies, where each has its own
_ADHESION_NEGLECTED = 1e-10  # of the energy exchanged: of contacts so light, tails decide
_ROUNDING = 8.0 * float(np.finfo(float).eps)  # of sampled speeds, which have been scaled


def complaint_about(scene: Scene, rows: Floats, events: Floats, unit: float, *, rigid: bool) -> str:
    """Name the first thing that is wrong, if anything is.

    Parameters
    ----------
    scene : Scene
    rows : ndarray
        Samples, as the engine's blocks have them.
    events : ndarray, shape (m, n)
        In the columns `gearidae.records.EVENT`.
    unit : float
        The engine's reference force of the scene [N].
    rigid : bool
        Whether all of it is by the asperity model, so that forces have their bounds.

    Returns
    -------
    str
        Empty if nothing is wrong.
    """
    with_force = np.isin(events[:, EVENT.kind], _WITH_FORCE)
    known = np.isfinite(events)
    if not np.isfinite(rows).all() or not np.delete(known, EVENT.force, axis=1).all():
        return "not finite"
    if np.any(known[:, EVENT.force] != with_force):
        return "events with a force are not the onsets and separations"
    if len(events) and (np.any(np.diff(events[:, 0]) < 0) or events[0, 0] < 0):
        return "events out of order"
    chosen = rows[np.unique(np.linspace(0, len(rows) - 1, _CHECKED_SAMPLES).astype(int))]
    for row in chosen:
        check = _check_roller if scene.roller else _check_gears
        complaint = check(scene, row, unit, rigid)
        if complaint:
            return complaint
    return ""


def complaint_about_exposures(
    scene: Scene, balance: EnergyBalance, extremes: Extremes, exchanged: float
) -> str:
    """Name what is wrong with the exposures of a run, if anything is.

    Every place's adhesion work is the loss of the contacts made there, so that over all places it is the adhesion loss
    of the energy balance: but for shares that change with tooth and place, and for contacts that have been carried from
    rigid to elastic bodies or back.

    Parameters
    ----------
    scene : Scene
    balance : EnergyBalance
    extremes : Extremes
        Of the same time.
    exchanged : float
        Energy exchanged in the whole run [J].

    Returns
    -------
    str
        Empty if nothing is wrong, or if the scene asks for no exposures.
    """
    if not extremes.exposures or scene.gears is None:
        return ""
    rows = ExposureRows.of(len(MATERIAL_NAMES))
    sums = np.array(extremes.exposures).reshape(
        -1, rows.per_tooth(rubs=has_flank_friction(scene)), scene.run.exposures
    )
    if not np.isfinite(sums).all() or (sums < 0.0).any():
        return "exposures that are negative or not finite"
    if scene.coating.by_place or balance.model_change != 0.0:
        return ""
    work, loss = float(sums[:, rows.adhesion : rows.sliding].sum()), balance.adhesion_loss
    # a gap may widen by an error of the motion before it is taken to turn: then the balance has lost less than joined
    tolerance = max(_ADHESION_TOLERANCE, scene.run.rtol)
    if may_deflect(scene):
        tolerance = max(tolerance, _ELASTIC_TOLERANCE)
    if abs(work - loss) > tolerance * abs(loss) + _ADHESION_NEGLECTED * exchanged:
        return f"the adhesion work of all places is {work:.3e} J, the adhesion loss {loss:.3e} J"
    return ""


def _check_roller(scene: Scene, row: Floats, unit: float, rigid: bool) -> str:
    assert scene.roller
    if not rigid:
        return ""
    height, _, force = row
    low, high, size = _limits(scene, np.array([height]), np.array([scene.roller.radius]), scene.roller.width)
    return _within("force", force, float(low.sum()), float(high.sum()), float(size.sum()), unit)


def _check_gears(scene: Scene, row: Floats, unit: float, rigid: bool) -> str:
    assert scene.gears
    assert scene.mesh
    sigma = scene.surface.roughness
    angle, u, force, torque, drive_gap, coast_gap = row[2:8]
    signs, gaps, slopes, radii = _pairs(scene, u, angle)
    for name, sign, gap in (("drive_gap", 1.0, drive_gap), ("coast_gap", -1.0, coast_gap)):
        nearest = float(gaps[signs == sign].min())
        if abs(gap - nearest) > _GAP_TOLERANCE * sigma + 1e-9 * abs(nearest):
            return f"{name} is {gap:.6g} m where the geometry has {nearest:.6g} m"
    if not rigid:
        return ""
    low, high, size = _limits(scene, gaps, radii, scene.gears.face_width)
    low, high = np.where(signs > 0, low, -high), np.where(signs > 0, high, -low)
    total = float(size.sum())
    gear = torque / scene.geometry.base_radius_gear
    damping, unknown = _damping(scene, row)
    contact = _within(
        "mesh_force less its damping",
        force - damping,
        float(low.sum()) - unknown,
        float(high.sum()) + unknown,
        total + abs(damping),
        unit,
    )
    if contact or scene.mesh.radius_force:  # of which the samples do not tell how large it is
        return contact
    return _within(
        "gear_contact_torque / R2 less its damping",
        gear - damping,
        float((low * (1.0 + slopes)).sum()) - unknown,
        float((high * (1.0 + slopes)).sum()) + unknown,
        total + abs(damping),
        unit,
    )


def _damping(scene: Scene, row: Floats) -> tuple[float, float]:
    """Damping force of the mesh, and how far it may be out [N].

    The rate of the static error is not sampled, and the speeds, of which the mesh takes the difference, are rounded.
    """
    assert scene.gears
    assert scene.mesh
    gear_speed, pinion_speed = float(row[0]), float(row[1])
    radius = scene.geometry.base_radius_gear
    rate = scene.gears.pinion_base_radius * pinion_speed - radius * gear_speed
    slope = sum(
        harmonic.amplitude * harmonic.order * scene.gears.pinion_teeth for harmonic in scene.mesh.static_error
    )
    rounding = _ROUNDING * scene.gears.pinion_base_radius * abs(pinion_speed)
    return scene.mesh.damping * rate, scene.mesh.damping * (slope * abs(pinion_speed) + rounding)


def _pairs(scene: Scene, u: float, angle: float) -> tuple[Floats, Floats, Floats, Floats]:
    """Flank (1 drive, -1 coast), gap, slope of the tip relief and reduced radius of every pair near the mesh."""
    assert scene.mesh
    assert scene.initial
    geometry, relief = scene.geometry, scene.mesh.tip_relief_radius
    pitch = geometry.base_pitch
    travel = geometry.base_radius_gear * angle + scene.initial.mesh_phase * pitch
    middle = round(travel / pitch)
    number = np.arange(middle - 40, middle + 41)
    drive = travel - number * pitch
    coast = 2.0 * geometry.approach - (travel - (number + 0.5) * pitch)
    along = np.concatenate([drive, coast])
    signs = np.repeat([1.0, -1.0], number.size)
    opened, slopes = separation(geometry, along, relief)
    gaps = 0.5 * scene.mesh.backlash - signs * u + opened
    return signs, gaps, slopes, curvature_radii(geometry, along)[2]


def _limits(scene: Scene, gaps: Floats, radii: Floats, width: float) -> tuple[Floats, Floats, Floats]:
    """Least and largest force at these gaps, and the size of what pushes and pulls [N]."""
    low, high, size = np.zeros_like(gaps), np.zeros_like(gaps), np.zeros_like(gaps)
    near = gaps < 14.0 * scene.surface.roughness
    law = scene.contact.asperity
    if not near.any():
        return low, high, size
    anywhere = scene.coating.by_place  # where coverage is a table, any share of each material
    bounds = []
    for surface, share, offset, _ in scene.materials():
        unit, own_gaps = (1.0 if anywhere else share) * np.sqrt(radii[near]), gaps[near] + offset
        loading = unit * line_force(own_gaps, 0.0, 1.0, width, surface, law)
        stretch = _FAR * (asperity_of(surface).stretch_limit + surface.interaction_range)
        parting = unit * line_force(own_gaps, stretch, 1.0, width, surface, law)
        pushing = unit * line_force(own_gaps, 0.0, 1.0, width, surface, "hertz")
        sizes = np.abs(pushing) + np.abs(parting) + np.abs(loading)
        bounds.append((np.minimum(parting, loading), np.maximum(parting, loading), sizes))
    lows, highs, sizes = (np.array(column) for column in zip(*bounds, strict=True))
    low[near] = lows.min(axis=0) if anywhere else lows.sum(axis=0)
    high[near] = highs.max(axis=0) if anywhere else highs.sum(axis=0)
    size[near] = sizes.max(axis=0) if anywhere else sizes.sum(axis=0)
    return low, high, size


def _within(name: str, force: float, low: float, high: float, size: float, unit: float) -> str:
    slack = _FORCE_TOLERANCE * size + _NEGLECTED * unit
    if low - slack <= force <= high + slack:
        return ""
    return f"{name} is {force:.6g} N where the contact has {low:.6g} .. {high:.6g} N"
