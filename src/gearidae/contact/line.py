r"""Two teeth of which only the asperities deform: a rough roller on a rough plane.

The gap opens as :math:`g + x^2/(2R)` along the contact, and with no bulk deflection every point moves in parallel, so
that one stretch serves all of them. Adding the pressure up over x before the heights leaves one integral,

.. math::

    W(g, S) = L N \sqrt{2 R / \sigma} \int_{-S}^{\infty} P(\delta)\,
              \psi\!\left(\frac{g + \delta}{\sigma}\right) \mathrm{d}\delta,

with the universal kernel psi of `gearidae.contact.psi`.

References
----------
M. Teodorescu, S. Theodossiades, H. Rahnejat, Tribology International 42 (2009) 197-205, Eqs. 13-15,
doi:10.1016/j.triboint.2008.05.019.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearidae.asperities.area import ContactArea
from gearidae.asperities.tip import Surface
from gearidae.contact.heights import Heights, checked_gap_and_stretch, heights_of
from gearidae.contact.psi import psi
from gearidae.errors import SceneError


def line_force(
    gap: ArrayLike,
    stretch: ArrayLike,
    radius: float,
    width: float,
    surface: Surface,
    asperity: str = "jkr",
) -> NDArray[np.float64]:
    """Force between two rough teeth without bulk deflection (Teodorescu et al. 2009, Eq. 15).

    Parameters
    ----------
    gap : array_like
        Smallest mean gap g between the rigid shapes [m]; negative in compression.
    stretch : array_like
        Extension S of the most stretched asperity still in contact [m]; broadcasts against `gap`. Less than the
        distance at which an asperity joins counts as that, more than that of detachment as that; "dmt" and
        "hertz" asperities ignore it.
    radius : float
        Reduced radius R of the two profiles, ``r1 r2/(r1 + r2)`` [m].
    width : float
        Face width L [m].
    surface : Surface
        Elastic constants, energy and roughness (SI).
    asperity : str, optional
        Name of the law of one asperity: ``jkr``, ``dmt``, ``hertz`` or another that is registered.

    Returns
    -------
    ndarray
        Force W [N], positive pushes apart, of the broadcast shape; relative error below 1e-12, in the far tail too (of
        the integral of the absolute value, where pressure and tension cancel), for gaps down to -1000 roughnesses.

    Raises
    ------
    SceneError
        If a gap is not finite, a stretch is negative, a length is not positive, or the surface or the law is not valid.
    """
    heights = heights_of(surface, asperity)
    return heights.unit_load * _added_up(heights, gap, stretch, radius, width, surface)


def line_area(
    gap: ArrayLike,
    stretch: ArrayLike,
    radius: float,
    width: float,
    surface: Surface,
    asperity: str = "jkr",
) -> NDArray[np.float64]:
    """Area of all asperities in contact between two rough teeth without bulk deflection.

    Parameters
    ----------
    gap, stretch, radius, width, surface
        As for `line_force`.
    asperity : str, optional
        Name of a law that has an area, see `gearidae.asperities.AsperityLaw.has_area`.

    Returns
    -------
    ndarray
        Sum of ``pi a^2`` [m^2], of the broadcast shape; relative error below 1e-12.

    Raises
    ------
    SceneError
        As `line_force`.
    """
    heights = heights_of(surface, asperity)
    areas = replace(heights, law=ContactArea(heights.law))
    unit = math.pi * surface.asperity_radius * surface.roughness
    return unit * _added_up(areas, gap, stretch, radius, width, surface)


def _added_up(
    heights: Heights, gap: ArrayLike, stretch: ArrayLike, radius: float, width: float, surface: Surface
) -> NDArray[np.float64]:
    """Add a law up over the heights and along the contact, in its own unit."""
    for key, value in (("radius", radius), ("width", width)):
        if not 0.0 < value < math.inf:
            raise SceneError(key, value, "must be a positive number of metres")
    g, s = checked_gap_and_stretch(gap, stretch, heights)
    count = width * math.sqrt(2.0 * radius * surface.roughness) * surface.asperity_density
    return count * heights.integral(psi, g, s, decays_left=False)
