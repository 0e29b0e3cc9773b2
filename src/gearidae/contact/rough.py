r"""Two rough planes: Fuller and Tabor's adhesion of Gaussian asperities, with a stretch history.

.. math::

    p(h, S) = N \int_{-S}^{\infty} P(\delta)\, \frac{1}{\sigma} \varphi\!\left(\frac{h + \delta}{\sigma}\right)
              \mathrm{d}\delta

for asperities of density N and heights of standard deviation sigma at a mean gap h, each with the load P at its
displacement delta. S is how far the most stretched asperity still in contact is extended: to the distance of joining
while the surfaces approach (0 for laws whose asperities join when they touch), up to the distance of detachment while
they part (dc for JKR).

References
----------
K. N. G. Fuller, D. Tabor, Proc. R. Soc. A 345 (1975) 327-342, doi:10.1098/rspa.1975.0138.
M. Teodorescu, S. Theodossiades, H. Rahnejat, Tribology International 42 (2009) 197-205, Eqs. 9-12,
doi:10.1016/j.triboint.2008.05.019.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from gearidae.asperities import law_of_tip
from gearidae.asperities.tip import Surface, asperity_of
from gearidae.contact.heights import (
    checked_gap_and_stretch,
    heights_of,
    normal_density,
    normal_density_slope,
)


class MaximumTension(NamedTuple):
    """Where two rough planes pull together hardest."""

    tension: float
    """Largest tension [Pa], positive; 0 if they never pull (or with less than floating point can hold)."""
    gap: float
    """Gap at which it occurs [m]; nan if they never pull."""


def rough_pressure(
    gap: ArrayLike, stretch: ArrayLike, surface: Surface, asperity: str = "jkr"
) -> NDArray[np.float64]:
    """Pressure between two rough planes (Teodorescu et al. 2009, Eqs. 9-12).

    Parameters
    ----------
    gap : array_like
        Mean gap h [m].
    stretch : array_like
        Extension S of the most stretched asperity still in contact [m]; broadcasts against `gap`. Less than the
        distance at which an asperity joins counts as that, more than that of detachment as that (so that 0 is the
        curve of approach and ``numpy.inf`` that of parting); "dmt" and "hertz" asperities ignore it.
    surface : Surface
        Elastic constants, energy and roughness (SI).
    asperity : str, optional
        Name of the law of one asperity: ``jkr``, ``dmt``, ``hertz`` or another that is registered.

    Returns
    -------
    ndarray
        Pressure p [Pa], positive pushes apart, of the broadcast shape; relative error below 1e-12, in the far tail too
        (of the integral of the absolute value, where pressure and tension cancel).

    Raises
    ------
    SceneError
        If a gap is not finite, a stretch is negative, or the surface or the law is not valid.
    """
    heights = heights_of(surface, asperity)
    h, s = checked_gap_and_stretch(gap, stretch, heights)
    unit = surface.asperity_density * heights.unit_load
    return unit * heights.integral(normal_density, h, s, decays_left=True)


def rough_pressure_slopes(
    gap: ArrayLike, stretch: ArrayLike, surface: Surface, asperity: str = "jkr"
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Partial derivatives of `rough_pressure` with respect to gap and stretch.

    A gap that opens by dh without letting an asperity go stretches by dh too: the slope of that motion is the sum.

    Parameters
    ----------
    gap, stretch, surface, asperity
        As in `rough_pressure`.

    Returns
    -------
    gap_slope, stretch_slope : ndarray
        dp/dh and dp/dS [Pa/m], of the broadcast shape. Where S is at its limit the second holds towards smaller S;
        for asperities that do not stretch it is zero.

    Raises
    ------
    SceneError
        As `rough_pressure`.
    """
    heights = heights_of(surface, asperity)
    h, s = checked_gap_and_stretch(gap, stretch, heights)
    unit = surface.asperity_density * heights.unit_load / surface.roughness
    gap_slope = unit * heights.integral(normal_density_slope, h, s, decays_left=True)
    if heights.law.detach == heights.law.join:
        return gap_slope, np.zeros_like(gap_slope)
    return gap_slope, unit * heights.edge_load(s) * normal_density(h - s)


def maximum_tension(
    surface: Surface, asperity: str = "jkr", *, motion: Literal["parting", "approaching"] = "parting"
) -> MaximumTension:
    """Largest tension two rough planes can carry, and the gap at which they do.

    Parameters
    ----------
    surface : Surface
        Elastic constants, energy and roughness (SI).
    asperity : str, optional
        Name of the law of one asperity: ``jkr``, ``dmt``, ``hertz`` or another that is registered.
    motion : {"parting", "approaching"}, optional
        Asperities stretched to their limit, or not stretched at all.

    Returns
    -------
    MaximumTension
        Tension [Pa] and gap [m].

    Raises
    ------
    SceneError
        If the surface or the law is not valid.
    """
    heights = heights_of(surface, asperity)
    if heights.law.pull_off == 0.0:
        return MaximumTension(0.0, math.nan)
    stretch = heights.law.detach if motion == "parting" else heights.law.join

    def pressure(gap: NDArray[np.float64]) -> NDArray[np.float64]:
        return heights.integral(normal_density, gap, np.full_like(gap, stretch), decays_left=True)

    # One valley between compression and the far tail: scan for it, then close in. Beyond 38 the density underflows.
    grid = np.linspace(-8.0, 38.0 + stretch, 400)
    k = int(np.argmin(pressure(grid)))
    if not 0 < k < grid.size - 1:
        return MaximumTension(0.0, math.nan)
    minimum = scipy.optimize.minimize_scalar(
        lambda gap: float(pressure(np.array([gap]))[0]),
        bounds=(grid[k - 1], grid[k + 1]),
        options={"xatol": 1e-9},
    )
    unit = surface.asperity_density * heights.unit_load
    return MaximumTension(-unit * float(minimum.fun), surface.roughness * float(minimum.x))


def adhesion_loss_per_asperity(surface: Surface, asperity: str = "jkr") -> float:
    """Energy lost each time one asperity joins and detaches again.

    Parameters
    ----------
    surface : Surface
        Elastic constants, energy and tip radius (SI).
    asperity : str, optional
        Name of the law of one asperity.

    Returns
    -------
    float
        Minus the integral of the load from detachment to joining [J]; for JKR ``4/45 (1 + 6 * 4^(1/3)) P_c dc``.

    Raises
    ------
    SceneError
        If there is no such law.
    """
    tip = asperity_of(surface)
    return tip.hertz_factor * law_of_tip(asperity, tip, 1.0).loss
