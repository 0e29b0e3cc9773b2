"""Reference solutions: motions and forces that have a formula, in SI units, for tests of scenes and of own code.

The train turns as one body where its teeth stay in contact: `train_inertia` is what turns at the gear.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import quad

from gearidae.arrays import Floats
from gearidae.asperities import law_of
from gearidae.contact.rough import adhesion_loss_per_asperity
from gearidae.errors import SceneError
from gearidae.runs.estimates import steady_speed as steady_speed
from gearidae.scene import Drive, Gears, Roller, Scene

__all__ = [
    "Stop",
    "dry_stop",
    "impact_loss",
    "jkr_curve",
    "run_down",
    "speed_after_impact",
    "static_mesh_force",
    "steady_speed",
    "train_inertia",
]


class Stop(NamedTuple):
    """When and where a body comes to rest: time [s] and angle [rad] from the start."""

    time: float
    angle: float


def train_inertia(scene: Scene) -> float:
    """Moment of inertia of both gears, as the gear's shaft feels it.

    Parameters
    ----------
    scene : Scene
        A gear pair.

    Returns
    -------
    float
        ``I_2 + I_1 (R_2/R_1)^2`` [kg m^2].

    Raises
    ------
    SceneError
        If the scene has no gears.
    """
    gears, _ = _gears(scene)
    return gears.gear_inertia + gears.pinion_inertia * _ratio(gears) ** 2


def run_down(
    time: ArrayLike, speed: float, inertia: float, *, viscous: float = 0.0, drag: float = 0.0
) -> tuple[Floats, Floats]:
    r"""Free run-down of a body under viscous and quadratic drag.

    .. math::

        I \dot\omega = -c\,\omega - k\,\omega^2, \qquad
        \omega = \frac{\omega_0 e^{-s}}{1 + k \omega_0 q / I}, \qquad
        \varphi = \frac{I}{k} \ln\Bigl(1 + \frac{k \omega_0 q}{I}\Bigr), \qquad
        s = \frac{c\,t}{I}, \quad q = \frac{1 - e^{-s}}{s}\,t

    Parameters
    ----------
    time : array_like
        Times from the start [s].
    speed : float
        Speed there, not negative [rad/s].
    inertia : float
        Moment of inertia [kg m^2]: of the gear in free flight, or `train_inertia`.
    viscous, drag : float, optional
        c [N m s/rad] and k [N m s^2/rad^2].

    Returns
    -------
    speed : ndarray
        In the shape of `time` [rad/s].
    angle : ndarray
        Turned since the start [rad].
    """
    t = np.asarray(time, dtype=float)
    reach = t if viscous == 0.0 else -np.expm1(-viscous * t / inertia) * inertia / viscous
    slowed = drag * speed * reach / inertia
    angle = speed * reach if drag == 0.0 else inertia / drag * np.log1p(slowed)
    return speed * np.exp(-viscous * t / inertia) / (1.0 + slowed), np.asarray(angle)


def dry_stop(speed: float, inertia: float, resistance: float, *, drag: float = 0.0) -> Stop:
    r"""Time and angle at which a dry load stops a body, with quadratic drag.

    .. math::

        I \dot\omega = -M - k\,\omega^2, \qquad
        t = \frac{I}{\sqrt{k M}} \arctan\Bigl(\omega_0 \sqrt{k / M}\Bigr), \qquad
        \varphi = \frac{I}{2 k} \ln\Bigl(1 + \frac{k \omega_0^2}{M}\Bigr)

    Parameters
    ----------
    speed : float
        Speed at the start, not negative [rad/s].
    inertia : float
        Moment of inertia [kg m^2].
    resistance : float
        Dry load M, less the drive's torque at the same shaft [N m]; positive.
    drag : float, optional
        k [N m s^2/rad^2]; 0 gives ``I w0/M`` and ``I w0^2/(2 M)``.
    """
    if drag == 0.0:
        return Stop(inertia * speed / resistance, 0.5 * inertia * speed**2 / resistance)
    time = inertia / math.sqrt(drag * resistance) * math.atan(speed * math.sqrt(drag / resistance))
    return Stop(time, 0.5 * inertia / drag * math.log1p(drag * speed**2 / resistance))


def static_mesh_force(scene: Scene) -> float:
    """Force along the line of action of a train at rest without friction of flanks and hubs.

    Parameters
    ----------
    scene : Scene
        A gear pair whose gear is held by its dry load.

    Returns
    -------
    float
        ``M_1/R_1`` of the constant torque of the drive [N].

    Raises
    ------
    SceneError
        If the scene has no gears.
    """
    gears, drive = _gears(scene)
    return drive.torque / gears.pinion_base_radius


def impact_loss(scene: Scene, gap: float) -> float:
    r"""Energy that a roller loses to adhesion in one approach and parting, with rigid bodies and the mean force law.

    Each asperity that has joined loses the same energy, whatever happens in between; for JKR :math:`0.93550\,P_c
    \delta_c`. Joined are those whose height exceeds the gap: :math:`N L \sqrt{2 R \sigma} \int Q(g/\sigma + s^2)\,ds`
    with Q the tail of the standard normal distribution.

    Parameters
    ----------
    scene : Scene
        A roller.
    gap : float
        Smallest gap of the impact [m], ``smallest_separation`` of a run with rigid bodies.

    Returns
    -------
    float
        Energy [J].

    Raises
    ------
    SceneError
        If the scene has no roller.

    References
    ----------
    Teodorescu et al., Tribology International 42 (2009) 197-205, Eqs. 7-13, doi:10.1016/j.triboint.2008.05.019.
    """
    roller, sigma = _roller(scene), scene.surface.roughness
    width = roller.width * math.sqrt(2.0 * roller.radius * sigma)
    lost = 0.0
    for part in scene.materials():
        law = law_of(scene.contact.asperity, part.surface)
        nearest = (gap + part.gap_offset) / sigma - law.join
        joined = scene.surface.asperity_density * width * _tail_along_parabola(nearest)
        lost += part.share * joined * adhesion_loss_per_asperity(part.surface, scene.contact.asperity)
    return lost


def _tail_along_parabola(nearest: float) -> float:
    """Integral of ``Q(nearest + s^2)`` over all s; beyond the square of 40 the tail is zero in floating point."""
    far = math.sqrt(40.0 + max(-nearest, 0.0))
    half, _ = quad(
        lambda s: 0.5 * math.erfc((nearest + s * s) / math.sqrt(2.0)), 0.0, far, epsrel=1e-11, limit=200
    )
    return 2.0 * float(half)


def speed_after_impact(scene: Scene, gap: float) -> float:
    """Speed of a roller that has come free again after one impact.

    Parameters
    ----------
    scene, gap
        As for `impact_loss`.

    Returns
    -------
    float
        ``sqrt(v^2 - 2 E/m)`` [m/s] with the loss E; NaN if the roller does not come free.

    Raises
    ------
    SceneError
        If the scene has no roller.
    """
    roller = _roller(scene)
    squared = roller.speed**2 - 2.0 * impact_loss(scene, gap) / roller.mass
    return math.sqrt(squared) if squared >= 0.0 else math.nan


def jkr_curve(contact_radius: ArrayLike) -> tuple[Floats, Floats]:
    r"""Load and displacement of one adhering asperity over its contact radius (Johnson, Kendall and Roberts).

    .. math::

        \frac{\delta}{\delta_c} = 12^{1/3} a^2 \Bigl(1 - \tfrac{2\sqrt2}{3} a^{-3/2}\Bigr), \qquad
        \frac{P}{P_c} = 2 \bigl(a^3 - \sqrt{2 a^3}\bigr)

    Parameters
    ----------
    contact_radius : array_like
        a, scaled; from ``(1/18)^(1/3)`` on, where the asperity detaches under given displacement.

    Returns
    -------
    displacement : ndarray
        Over the stretch limit, in the shape of `contact_radius`; -1 at detachment.
    load : ndarray
        Over the pull-off load; -1 at ``a^3 = 1/2``.

    References
    ----------
    Proc. R. Soc. A 324 (1971) 301-313, doi:10.1098/rspa.1971.0141.
    """
    a = np.asarray(contact_radius, dtype=float)
    displacement = np.cbrt(12.0) * a**2 * (1.0 - 2.0 * math.sqrt(2.0) / 3.0 * a**-1.5)
    return displacement, 2.0 * (a**3 - np.sqrt(2.0 * a**3))


def _ratio(gears: Gears) -> float:
    return gears.gear_teeth / gears.pinion_teeth


def _gears(scene: Scene) -> tuple[Gears, Drive]:
    if scene.gears is None or scene.drive is None:
        raise SceneError("gears", "(missing)", "must be in the scene: the solution is of a gear pair")
    return scene.gears, scene.drive


def _roller(scene: Scene) -> Roller:
    if scene.roller is None:
        raise SceneError("roller", "(missing)", "must be in the scene: the solution is of a roller")
    return scene.roller
