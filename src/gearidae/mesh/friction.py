r"""Friction between the flanks and in the hubs of a gear pair, in closed form.

The flanks of a pair that touches at the distance D from the pitch point slide over each other with
:math:`v = r_1 \omega_1 - r_2 \omega_2 = (1 + R_2/R_1) D \omega_2` (without normal motion), which turns round at the
pitch point. A friction force f along the flanks has the arms r1 and r2 about the two axes, so that

.. math::

    M_1 = \sum W_i R_1 + \sum f_i r_{1i}, \qquad M_2 = \sum W_i R_2 + \sum f_i r_{2i}, \qquad
    f_i = \operatorname{sgn}(D_i)\, \mu W_i

for a pinion that drives forward. Pairs in mesh share the force W equally, or as one law of force at one gap shares it,
in proportion to :math:`\sqrt{R_i}` of their reduced radii (Teodorescu et al. 2009, Eq. 15,
doi:10.1016/j.triboint.2008.05.019). The formulas follow from these lines.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from gearidae.arrays import Floats
from gearidae.mesh.involute import Geometry, curvature_radii

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(16)


def sliding_integral(geometry: Geometry, *, equal_shares: bool = False) -> float:
    r"""Mean distance of the loaded pairs from the pitch point, times the base pitch.

    Parameters
    ----------
    geometry : Geometry
        Of the gear pair.
    equal_shares : bool, optional
        Whether all pairs in mesh carry the same force, or forces in proportion to :math:`\sqrt{R_i}`.

    Returns
    -------
    float
        :math:`\int_0^{p_b} \sum s_i |D_i| \,\mathrm{d}\xi` [m^2] with the shares s of the pairs in mesh. Equal shares
        of one or two pairs give :math:`p_b^2/2\,(1 - \varepsilon + \varepsilon_a^2 + \varepsilon_r^2)` if the second
        pair never is in mesh on the same side of the pitch point.
    """

    def distance(share: Floats, beyond: Floats, _: tuple[Floats, Floats]) -> Floats:
        return np.asarray((share * np.abs(beyond)).sum(axis=0))

    return _over_pitch(geometry, distance, equal_shares=equal_shares)


def loss_per_pitch(
    geometry: Geometry, coefficient: float, force: float, *, equal_shares: bool = False
) -> float:
    """Energy that friction takes while the gears turn by one tooth under a constant force.

    Parameters
    ----------
    geometry : Geometry
        Of the gear pair.
    coefficient : float
        Coefficient of friction mu.
    force : float
        Sum W of the forces of all pairs [N].
    equal_shares : bool, optional
        See `sliding_integral`.

    Returns
    -------
    float
        ``mu W (1/R1 + 1/R2) I`` [J], with I of `sliding_integral`.
    """
    arms = 1.0 / geometry.base_radius_pinion + 1.0 / geometry.base_radius_gear
    return coefficient * force * arms * sliding_integral(geometry, equal_shares=equal_shares)


def loss_fraction(geometry: Geometry, coefficient: float, *, equal_shares: bool = False) -> float:
    r"""Share of the drive's work that friction of the flanks takes under a constant force.

    Returns
    -------
    float
        `loss_per_pitch` over ``W pb``. Equal shares give
        :math:`\mu\pi (1/z_1 + 1/z_2)(1 - \varepsilon + \varepsilon_a^2 + \varepsilon_r^2)`.

    Notes
    -----
    It is linear in the coefficient. `efficiency` is the same with a constant torque of the pinion, and not linear.
    """
    return loss_per_pitch(geometry, coefficient, 1.0, equal_shares=equal_shares) / geometry.base_pitch


def efficiency(geometry: Geometry, coefficient: float, *, equal_shares: bool = False) -> float:
    """Work at the gear over work of the pinion under a constant torque of the pinion, at constant speed.

    Returns
    -------
    float
        Mean over a base pitch of ``(R1/R2) sum s_i (R2 + sigma_i mu r2_i) / sum s_i (R1 + sigma_i mu r1_i)`` with
        ``sigma_i = sgn(D_i)``.
    """

    def transmitted(share: Floats, beyond: Floats, radii: tuple[Floats, Floats]) -> Floats:
        rubbed = coefficient * np.sign(beyond)
        gear = (share * (geometry.base_radius_gear + rubbed * radii[1])).sum(axis=0)
        pinion = (share * (geometry.base_radius_pinion + rubbed * radii[0])).sum(axis=0)
        return np.asarray(gear / pinion)

    mean = _over_pitch(geometry, transmitted, equal_shares=equal_shares) / geometry.base_pitch
    return mean * geometry.base_radius_pinion / geometry.base_radius_gear


def torque_ratio(geometry: Geometry, xi: ArrayLike, coefficient: float) -> Floats:
    """Torque of the pinion over that of the gear, one pair, at constant forward speed.

    Parameters
    ----------
    geometry : Geometry
        Of the gear pair.
    xi : array_like, any shape
        Position along the path of contact [m].
    coefficient : float
        Coefficient of friction mu.

    Returns
    -------
    ndarray, shape of `xi`
        ``(R1 + sigma mu r1) / (R2 + sigma mu r2)`` with ``sigma = sgn(D)``; R1/R2 at the pitch point.
    """
    pinion, gear, _ = curvature_radii(geometry, xi)
    rubbed = coefficient * np.sign(np.asarray(xi, dtype=np.float64) - geometry.approach)
    return np.asarray(
        (geometry.base_radius_pinion + rubbed * pinion) / (geometry.base_radius_gear + rubbed * gear)
    )


def locking_coefficients(geometry: Geometry) -> tuple[float, float]:
    """Coefficients of friction below which no position of the teeth locks.

    Returns
    -------
    pinion_drives, gear_drives : float
        ``R2 / r2`` at the beginning of the path of contact and ``R1 / r1`` at its end.
    """
    pinion, gear, _ = curvature_radii(geometry, np.array([0.0, geometry.path_length]))
    return geometry.base_radius_gear / float(gear[0]), geometry.base_radius_pinion / float(pinion[1])


def adhesive_hold(geometry: Geometry, xi: ArrayLike, limits: ArrayLike) -> float:
    """Largest torque of the pinion that friction holds while the gear is free of load.

    Parameters
    ----------
    geometry : Geometry
        Of the gear pair.
    xi : array_like, shape(n)
        Positions along the path of contact of the pairs that touch [m].
    limits : array_like, shape(n)
        Friction limits of these pairs [N]: the largest forces along the flanks.

    Returns
    -------
    float
        ``(1 + R1/R2) sum l_i |D_i|`` [N m]; zero at the pitch point.
    """
    beyond = np.asarray(xi, dtype=np.float64) - geometry.approach
    arm = 1.0 + geometry.base_radius_pinion / geometry.base_radius_gear
    return arm * float((np.asarray(limits, dtype=np.float64) * np.abs(beyond)).sum())


def hub_share(geometry: Geometry, coefficient: float, hub_radii: tuple[float, float]) -> float:
    """Share of the pinion's torque that reaches the gear past friction in the hubs, without that of the flanks.

    Parameters
    ----------
    geometry : Geometry
        Of the gear pair.
    coefficient : float
        Coefficient of friction mu of the hubs.
    hub_radii : tuple of float
        Radii of the hubs of pinion and gear [m].

    Returns
    -------
    float
        ``M2 R1 / (M1 R2) = (1 - mu r_h2/R2) / (1 + mu r_h1/R1)``; 0 where the gear's hub locks.
    """
    pinion = 1.0 + coefficient * hub_radii[0] / geometry.base_radius_pinion
    return max(1.0 - coefficient * hub_radii[1] / geometry.base_radius_gear, 0.0) / pinion


def hub_starting_torque(
    geometry: Geometry,
    resistance: float,
    coefficient: float,
    hub_radii: tuple[float, float],
    constants: tuple[float, float] = (0.0, 0.0),
) -> float:
    """Torque of the pinion that starts the gears against a resistance, with friction in the hubs alone.

    Parameters
    ----------
    geometry : Geometry
        Of the gear pair.
    resistance : float
        Torque that resists the gear [N m].
    coefficient, hub_radii
        As for `hub_share`.
    constants : tuple of float, optional
        Torques C1 and C2 of the hubs of pinion and gear that do not depend on the force of the teeth [N m].

    Returns
    -------
    float
        ``C1 + (M2 + C2) (R1 + mu r_h1) / (R2 - mu r_h2)`` [N m]; infinite where the gear's hub locks,
        ``mu r_h2 >= R2``.
    """
    share = hub_share(geometry, coefficient, hub_radii)
    unrubbed = (resistance + constants[1]) * geometry.base_radius_pinion / geometry.base_radius_gear
    return constants[0] + unrubbed / share if share > 0.0 else math.inf


def starting_ratio(
    geometry: Geometry, coefficient: float, hub_coefficient: float, hub_radii: tuple[float, float]
) -> float:
    """Torque of the pinion over the resistance of the gear that it overcomes from rest, at the worst position.

    Parameters
    ----------
    geometry : Geometry
        Of the gear pair.
    coefficient, hub_coefficient : float
        Of flanks and hubs, below those that lock.
    hub_radii : tuple of float
        Radii of the hubs of pinion and gear [m].

    Returns
    -------
    float
        Largest ``(R1 + sum f r1 + mu_h r_h1 N) / (R2 + sum f r2 - mu_h r_h2 N)`` over a base pitch with
        ``f_i = sgn(D_i) mu s_i`` and the force ``N = sqrt(1 + (sum f)^2)`` in the hubs, to 1e-5; infinite where it
        locks.
    """
    inner = np.linspace(-1.0 + 1e-12, 1.0 - 1e-12, 129)  # forces jump at the ends of a piece
    _, share, beyond, radii = _laid_out(geometry, inner, equal_shares=False)
    rubbed = coefficient * np.sign(beyond) * share
    carried = np.hypot(1.0, rubbed.sum(axis=0))
    pinion = geometry.base_radius_pinion + (rubbed * radii[0]).sum(axis=0)
    gear = geometry.base_radius_gear + (rubbed * radii[1]).sum(axis=0)
    pinion = pinion + hub_coefficient * hub_radii[0] * carried
    gear = gear - hub_coefficient * hub_radii[1] * carried
    return float((pinion / gear).max()) if (gear > 0.0).all() else math.inf


def _over_pitch(
    geometry: Geometry,
    value: Callable[[Floats, Floats, tuple[Floats, Floats]], Floats],
    *,
    equal_shares: bool,
) -> float:
    """Integrate over the newest pair's position in a base pitch a value of shares, distances and radii of all pairs."""
    half, share, beyond, radii = _laid_out(geometry, _POINTS, equal_shares=equal_shares)
    return float((half * _WEIGHTS).ravel() @ value(share, beyond, radii))


def _laid_out(
    geometry: Geometry, nodes: Floats, *, equal_shares: bool
) -> tuple[Floats, Floats, Floats, tuple[Floats, Floats]]:
    """Lay nodes on -1..1 between the positions at which a pair passes the pitch point or leaves the path.

    Returns
    -------
    half : ndarray, shape (pieces, 1)
        Half the length of each piece of the base pitch [m]: what changes with the position is smooth inside.
    share, beyond : ndarray, shape (pairs, pieces * nodes)
        Share of the force of each pair, and its distance from the pitch point [m].
    radii : tuple of ndarray, the same shape
        Radii of curvature of pinion and gear [m].
    """
    pitch, length = geometry.base_pitch, geometry.path_length
    behind = pitch * np.arange(math.ceil(length / pitch))
    ends = np.concatenate([[0.0, pitch], geometry.approach - behind, length - behind])
    ends = np.unique(ends[(ends >= 0.0) & (ends <= pitch)])
    half = 0.5 * np.diff(ends)[:, None]
    newest = (ends[:-1, None] + half * (1.0 + nodes)).ravel()
    positions = newest + behind[:, None]
    pinion, gear, reduced = curvature_radii(geometry, positions)
    share = (positions < length) * (1.0 if equal_shares else np.sqrt(reduced))
    return half, share / share.sum(axis=0), positions - geometry.approach, (pinion, gear)
