"""What can be said of a gear pair on paper, before anything is simulated."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from gearidae.contact.line import line_force
from gearidae.errors import SceneError
from gearidae.mesh.involute import curvature_radii
from gearidae.scene import Drive, Gears, Load, Scene

__all__ = ["effective_mass", "natural_frequency", "resting_gap", "steady_speed"]

_OUTERMOST, _INNERMOST = 9.0, -8.0  # gaps to look at, in roughnesses


def effective_mass(scene: Scene) -> float:
    """Mass that the transmission error moves.

    Parameters
    ----------
    scene : Scene
        A gear pair.

    Returns
    -------
    float
        ``1 / (R1^2/I1 + R2^2/I2)`` [kg].

    Raises
    ------
    SceneError
        If the scene has no gears.
    """
    gears, _, _ = _tables(scene)
    geometry = scene.geometry
    pinion = geometry.base_radius_pinion**2 / gears.pinion_inertia
    return 1.0 / (pinion + geometry.base_radius_gear**2 / gears.gear_inertia)


def steady_speed(scene: Scene) -> float:
    """Mean speed of the gear at which the constant torques balance, if nothing sticks.

    Parameters
    ----------
    scene : Scene
        A gear pair.

    Returns
    -------
    float
        w2 of ``M10 R2/R1 = M20 + alpha w2^2`` [rad/s]; 0 if the drive does not overcome the dry resistance,
        infinite if there is no drag. (Teodorescu et al. 2009, Eq. 3, prints the ratio upside down.)

    Raises
    ------
    SceneError
        If the scene has no gears.
    """
    gears, drive, load = _tables(scene)
    surplus = drive.torque * gears.gear_teeth / gears.pinion_teeth - load.torque
    if surplus <= 0.0:
        return 0.0
    return math.sqrt(surplus / load.drag) if load.drag > 0.0 else math.inf


def resting_gap(scene: Scene) -> float:
    """Mean gap at which a single pair, met at the pitch point, carries the constant drive torque.

    Approaching surfaces, no bulk deflection (Teodorescu et al. 2009, Eqs. 12-15).

    Parameters
    ----------
    scene : Scene
        A gear pair.

    Returns
    -------
    float
        Gap [m], the outermost if adhesion allows several; NaN if there is no drive torque to carry or it
        presses the teeth deeper than eight roughnesses.

    Raises
    ------
    SceneError
        If the scene has no gears.
    """
    gears, drive, _ = _tables(scene)
    wanted = drive.torque / gears.pinion_base_radius
    gaps = np.linspace(_OUTERMOST, _INNERMOST, 1701) * scene.surface.roughness
    carried = np.flatnonzero(_force(scene, gaps) >= wanted)
    if wanted <= 0.0 or not carried.size or carried[0] == 0:
        return math.nan
    inner, outer = gaps[carried[0]], gaps[carried[0] - 1]
    return float(brentq(lambda gap: float(_force(scene, gap)) - wanted, inner, outer, xtol=1e-18))


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
        `gearidae.studies.contact_resonance` of a pair that was pressed by the drive torque alone [Hz]; NaN where there
        is no resting gap.

    Raises
    ------
    SceneError
        If the scene has no gears.
    """
    if math.isnan(resting_gap(scene)):
        return math.nan
    # the tables of the force law are loaded only here: the other estimates do without
    from gearidae.studies.equilibrium import contact_resonance

    return contact_resonance(scene)


def _tables(scene: Scene) -> tuple[Gears, Drive, Load]:
    """Return the tables that every gear pair has."""
    if scene.gears is None or scene.drive is None or scene.load is None:
        raise SceneError("gears", "(missing)", "a scene with a roller has no gears")
    return scene.gears, scene.drive, scene.load


def _force(scene: Scene, gap: ArrayLike) -> NDArray[np.float64]:
    """Force of one pair at the pitch point, while it is being pressed [N]."""
    gears, _, _ = _tables(scene)
    geometry = scene.geometry
    radius = float(curvature_radii(geometry, geometry.approach)[2])
    force = np.zeros(np.shape(gap))
    for surface, share in scene.materials():
        if share > 0.0:
            law = scene.contact.asperity
            force = force + share * line_force(gap, 0.0, radius, gears.face_width, surface, law)
    return force
