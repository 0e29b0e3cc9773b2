r"""The contact at rest: the force law of a scene's teeth, the gap they settle at, the frequency they would ring at.

One pair in mesh, pressed once to the depth ``joined``, is a spring of stiffness :math:`k = -\partial W/\partial g`
between the gears' effective mass, and rings with small amplitude at

.. math::

    f = \frac{1}{2\pi}\sqrt{\frac{k}{m_e}}, \qquad \frac{1}{m_e} = \frac{R_1^2}{I_1} + \frac{R_2^2}{I_2} .

Where asperities stay joined (the partly stretched branch) k is larger than on loading, the more so the deeper the
contact was pressed. Teodorescu et al. 2009 (doi:10.1016/j.triboint.2008.05.019), Eqs. 1-15.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearidae.asperities import law_of
from gearidae.asperities.tip import asperity_of
from gearidae.contact.attraction import attraction_force
from gearidae.contact.kernels.law import GAP_HIGH, force_scale, law_table, law_value
from gearidae.errors import SceneError
from gearidae.mesh.involute import curvature_radii
from gearidae.runs.estimates import mean_drive_torque, resting_gap
from gearidae.scene import require_gears

if TYPE_CHECKING:
    from gearidae.scene import GearScene, Scene

PairLaw = Callable[..., float]


class MaterialLaw(NamedTuple):
    """Force law of one material of the flanks, see `material_laws`."""

    scale: float
    limit: float
    table: NDArray[np.float64]
    offset: float
    hamaker: float

    def attraction(self, gap: ArrayLike, radius: ArrayLike, scene: GearScene) -> NDArray[np.float64]:
        """Attraction [N] of the material across gaps between flanks with reduced radii [m]."""
        own_gap = np.asarray(gap) + self.offset * scene.surface.roughness
        unit = attraction_force(own_gap, 1.0, scene.gears.face_width, self.hamaker)
        return np.asarray(unit * np.sqrt(np.asarray(radius)))


_DEEPEST, _WIDEST = -30.0, GAP_HIGH - 0.1
"""Gaps between which a balance is sought, in roughnesses."""
_AFTER = 0.1
"""Where a pair rings: so far, in pitches, beyond where the pair before it left the mesh."""
_GAP_STEP = 1e-4
"""Change of the gap over which a stiffness is taken, in roughnesses."""
_GAP_ERROR = 1e-7
"""Of the gaps found, in roughnesses; forces change by e^6 in one."""


def natural_frequency(scene: Scene) -> float:
    """Frequency of small oscillations of the gears against each other about the resting gap.

    The asperities that touch at that gap stay joined and stretch. Those that a past impact has joined besides
    make real teeth ring faster: by a few per cent where the coating is whole, up to twice as fast where it is
    worn.

    Parameters
    ----------
    scene : Scene
        A gear pair.

    Returns
    -------
    float
        ``sqrt(k / m_e) / (2 pi)`` [Hz] with ``k = -dW/dg`` of one pair at the pitch point; NaN where there is
        no resting gap.

    Raises
    ------
    SceneError
        If the scene has no gears.
    """
    return math.nan if math.isnan(resting_gap(scene)) else contact_resonance(scene)


def contact_resonance(scene: Scene, joined: float | None = None) -> float:
    """Frequency of small oscillations of one pair in mesh under the scene's mean drive torque.

    Parameters
    ----------
    scene : Scene
        With gears.
    joined : float, optional
        Gap to which the pair has been pressed [m]; asperities that touched there stay joined as far as they stretch. By
        default the pair has been pressed by the drive torque alone.

    Returns
    -------
    float
        Frequency [Hz]; NaN if the pair does not hold the torque in a stable state.

    Raises
    ------
    SceneError
        If the scene has no gears or no drive torque that presses them together.
    """
    scene = require_gears(scene)
    if joined is not None and not math.isfinite(joined):
        raise SceneError("joined", joined, "must be a finite number of metres")
    torque = mean_drive_torque(scene)
    if not torque > 0.0:
        raise SceneError("drive.torque", torque, "must not be 0, or nothing presses the teeth together")
    geometry, gears = scene.geometry, scene.gears
    pinion, gear = geometry.base_radius_pinion, geometry.base_radius_gear
    law, force = pair_law(scene), torque / pinion
    position = geometry.path_length - (1.0 - _AFTER) * geometry.base_pitch
    radius = float(curvature_radii(geometry, position)[2])
    gap = settled_gap(scene, lambda at: law(at, at, radius) - force)
    if joined is not None:
        gap = nearest_gap(scene, lambda at: law(at, joined, radius) - force, min(gap, joined))
    pressed = gap if joined is None else min(gap, joined)
    step = _GAP_STEP * scene.surface.roughness
    here = law(gap, pressed, radius)
    # a pair that swings stays on the branch on which nothing joins or detaches: the stiffer way of the two
    opening = here - law(gap + step, pressed, radius)
    closing = law(gap - step, pressed, radius, gap) - here
    stiffness = max(opening, closing) / step
    inverse_mass = pinion**2 / gears.pinion_inertia + gear**2 / gears.gear_inertia
    return math.sqrt(stiffness * inverse_mass) / (2.0 * math.pi) if stiffness > 0.0 else math.nan


def pair_law(scene: Scene) -> PairLaw:
    """Force law of a pair of the scene's teeth.

    Parameters
    ----------
    scene : Scene
        With gears.

    Returns
    -------
    callable
        ``law(gap, joined, radius, opened)`` [m] gives the force [N], positive pushes apart. `joined` is the gap to
        which the pair has been pressed, `opened` (optional) the widest to which it has come since.
    """
    scene = require_gears(scene)
    roughness, parts, attracts = scene.surface.roughness, material_laws(scene), scene.attracts

    def law(gap: float, joined: float, radius: float, opened: float = -math.inf) -> float:
        at, low, high = gap / roughness, joined / roughness, opened / roughness
        total = 0.0
        for scale, limit, table, offset, _ in parts.values():
            height = min(max(low, high - limit), at)
            total += scale * law_value(table, at + offset, height + offset)[0]
        force = math.sqrt(2.0 * radius * roughness) * float(total)
        if attracts:
            force += sum(float(part.attraction(gap, radius, scene)) for part in parts.values())
        return force

    return law


def material_laws(scene: GearScene) -> dict[str, MaterialLaw]:
    """Force laws of the materials of a scene's teeth, as far as they have a share.

    Parameters
    ----------
    scene : Scene
        With gears.

    Returns
    -------
    dict
        By ``bare``, ``coated`` and ``mixed``: force of unit value and unit ``sqrt(2 R sigma)`` [N/m] times the
        material's share, its stretch limit over the roughness, its table (see `gearidae.contact.kernels.law`), its
        gap offset over the roughness, and its Hamaker constant times the share [J].
    """
    roughness, width = scene.surface.roughness, scene.gears.face_width
    laws = {}
    for surface, share, offset, name in scene.materials():
        if share > 0.0:
            asperity = asperity_of(surface)
            hertz = 4.0 / 3.0 * asperity.modulus * math.sqrt(surface.asperity_radius)
            scale = share * force_scale(roughness, hertz, surface.asperity_density, width)
            law = law_of(scene.contact.asperity, surface)
            limit, pull = law.detach - law.join, share * surface.hamaker
            laws[name] = MaterialLaw(scale, limit, law_table(law), offset / roughness, pull)
    return laws


def leaving_radii(scene: GearScene) -> tuple[float, list[float]]:
    """Reduced radii of the pair at the end of its path of contact, and of those behind it [m].

    Returns
    -------
    leaving : float
    staying : list of float
    """
    geometry = scene.geometry
    behind = np.arange(1, math.floor(geometry.contact_ratio) + 1) * geometry.base_pitch
    reduced = curvature_radii(geometry, geometry.path_length - np.concatenate([[0.0], behind]))[2]
    return float(reduced[0]), [float(radius) for radius in reduced[1:]]


def settled_gap(scene: GearScene, balance: Callable[[float], float]) -> float:
    """Widest gap at which a force balance holds: where teeth that approach come to rest.

    Parameters
    ----------
    balance : callable
        Force less load [N] of a gap [m].

    Returns
    -------
    float
        Gap [m].
    """
    sigma = scene.surface.roughness
    gaps = np.arange(_WIDEST, _DEEPEST, -0.25) * sigma
    for outer, inner in pairwise(gaps):
        if balance(float(inner)) > 0.0:
            return _between(balance, float(inner), float(outer), _GAP_ERROR * sigma)
    return _DEEPEST * sigma


def nearest_gap(scene: GearScene, balance: Callable[[float], float], gap: float) -> float:
    """Gap at which a force balance holds, next to one where it nearly does.

    Parameters
    ----------
    balance : callable
        Force less load [N] of a gap [m].
    gap : float
        Where to begin [m].

    Returns
    -------
    float
        Gap [m].
    """
    sigma = scene.surface.roughness
    way = 1.0 if balance(gap) > 0.0 else -1.0
    near, step = gap, 0.02 * sigma
    while _DEEPEST * sigma < near < _WIDEST * sigma:
        far = min(max(near + way * step, _DEEPEST * sigma), _WIDEST * sigma)
        if (balance(far) > 0.0) != (way > 0.0):
            return _between(balance, min(near, far), max(near, far), _GAP_ERROR * sigma)
        near, step = far, 1.6 * step
    return near


def _between(balance: Callable[[float], float], inner: float, outer: float, error: float) -> float:
    """Gap between two at which the force balance changes its sign, by bisection: SciPy's roots take long to load."""
    carries = balance(inner) > 0.0
    while outer - inner > error:
        middle = 0.5 * (inner + outer)
        inner, outer = (middle, outer) if (balance(middle) > 0.0) == carries else (inner, middle)
    return 0.5 * (inner + outer)
