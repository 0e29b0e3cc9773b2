r"""Work to part two rough planes, which experiments call the apparent adhesion energy.

From the gap :math:`h_0` at which the planes carry no load, with every asperity joined that stretches no farther than it
can, the work per nominal area is

.. math::

    \Gamma = -\int_{h_0}^\infty p\,\mathrm{d}h
           = -N \int_{-d}^\infty P(\delta)\, Q\!\left(\frac{h_0 + \delta}{\sigma}\right) \mathrm{d}\delta
             + \frac{A}{12 \pi h_0^2},

Q the normal tail and d the distance at which an asperity detaches: `rough_pressure(h, inf, surface)` added up, and the
attraction of the mean planes across the gap, see `gearidae.contact.attraction`.
"""

from __future__ import annotations

import math
import warnings

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr

from gearidae.arrays import Floats
from gearidae.asperities.tip import Surface
from gearidae.contact.attraction import FLOOR, attraction_pressure
from gearidae.contact.heights import heights_of
from gearidae.contact.rough import rough_pressure
from gearidae.errors import SceneError

_OUTERMOST, _INNERMOST, _GAP_STEP = 38.0, -8.0, 0.05
"""Gaps between which no load is looked for, and their distance, in roughnesses; the density of heights ends at 38."""


def adhesion_energy(surface: Surface, hamaker: float = 0.0, asperity: str = "jkr") -> float:
    """Work per nominal area to part two parallel rough planes from zero load.

    Parameters
    ----------
    surface : Surface
        Elastic constants, energy and roughness (SI).
    hamaker : float, optional
        Hamaker constant A of the attraction across the gap [J].
    asperity : str, optional
        Name of the law of one asperity.

    Returns
    -------
    float
        Energy [J/m^2]; 0 if the planes never pull. Relative error below 1e-10. No more than smooth planes give that
        touch at the closest spacing of their atoms; a warning says so where the asperities would give more.

    Raises
    ------
    SceneError
        If the surface, the law or the constant is not valid, or the attraction closes the gap between the planes.
    """
    gap = zero_load_gap(surface, hamaker, asperity)
    if math.isnan(gap):
        return 0.0
    heights = heights_of(surface, asperity)
    at, stretch = np.array([gap / surface.roughness]), np.array([heights.law.detach])
    unit = surface.asperity_density * heights.unit_load * surface.roughness
    held = -unit * float(heights.integral(_tail, at, stretch, decays_left=False)[0])
    work, smooth = (
        held + attraction_work(gap, hamaker),
        2.0 * surface.energy + attraction_work(FLOOR, hamaker),
    )
    if work > smooth:
        warnings.warn(
            f"at no load the gap is {gap / surface.roughness:.2g} roughnesses: asperities pressed in up to their "
            f"neighbours dominate, and would take {work:.3g} J/m^2 to part; the answer is {smooth:.3g} J/m^2, that of "
            "smooth planes",
            stacklevel=2,
        )
    return min(work, smooth)


def attraction_work(gap: float, hamaker: float) -> float:
    """Work per area [J/m^2] to part planes from a gap h [m] against their attraction, ``A / (12 pi h^2)``."""
    near = max(gap, FLOOR)
    return hamaker / (12.0 * math.pi * near**2) - float(attraction_pressure(near, hamaker)) * (near - gap)


def zero_load_gap(surface: Surface, hamaker: float = 0.0, asperity: str = "jkr") -> float:
    """Gap at which two rough planes that part carry no load, the outermost of several.

    Parameters
    ----------
    surface, hamaker, asperity
        As for `adhesion_energy`.

    Returns
    -------
    float
        Gap between the mean planes [m]; NaN if they never pull.

    Raises
    ------
    SceneError
        As `adhesion_energy`.
    """

    def pressure(gap: Floats | float) -> Floats:
        return rough_pressure(gap, math.inf, surface, asperity) + attraction_pressure(gap, hamaker)

    sigma = surface.roughness
    reach = heights_of(surface, asperity).law.detach
    gaps = np.arange(_OUTERMOST + reach, _INNERMOST, -_GAP_STEP) * sigma
    pressures = pressure(gaps)
    pushes, pulls = np.flatnonzero(pressures > 0.0), np.flatnonzero(pressures < 0.0)
    if not pulls.size:
        return math.nan
    beyond = pushes[pushes > pulls[0]]  # within the outermost gap at which they pull
    if not beyond.size:
        raise SceneError(
            "hamaker", hamaker, "attraction closes the gap between these planes: nothing holds them apart"
        )
    k = int(beyond[0])
    return float(
        brentq(lambda gap: float(pressure(gap)), gaps[k], gaps[k - 1], xtol=1e-15 * sigma, rtol=1e-14)
    )


def _tail(z: Floats) -> Floats:
    """Share of the heights above z."""
    return np.asarray(ndtr(-z))
