r"""How many asperities a rough contact has, and whether they act one by one.

The model adds up asperities that do not know of each other. Three numbers say how far that holds: how many of them a
contact may be expected to have, how densely they stand, and whether the contacts that adhesion opens without any load
grow into each other.

References
----------
J. A. Greenwood, J. B. P. Williamson, Proc. R. Soc. A 295 (1966) 300-319, doi:10.1098/rspa.1966.0242 (N beta sigma).
K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324 (1971) 301-313, doi:10.1098/rspa.1971.0141.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearidae.asperities.tip import Surface, asperity_of
from gearidae.contact.heights import heights_of
from gearidae.contact.psi import psi, psi_derivatives


def expected_asperities(gap: ArrayLike, radius: float, width: float, surface: Surface) -> NDArray[np.float64]:
    r"""Number of asperities that two teeth may be expected to touch with, approaching.

    Parameters
    ----------
    gap : array_like
        Smallest mean gap g between the rigid shapes [m].
    radius : float
        Reduced radius R of the two profiles [m].
    width : float
        Face width L [m].
    surface : Surface
        Asperity density and roughness (SI).

    Returns
    -------
    ndarray
        :math:`N L \sqrt{2 R \sigma} \int_G^\infty \psi(y)\,\mathrm{d}y` [1] with :math:`G = g/\sigma`, the shape of
        `gap`. The integral is :math:`-2 (\psi'(G) + G\,\psi(G))`, since
        :math:`\psi'' = -y\,\psi' - \tfrac12 \psi` and psi vanishes at infinity. To 1e-10 for gaps up to 20
        roughnesses.
    """
    at = np.asarray(gap, dtype=np.float64) / surface.roughness
    density, slope = psi_derivatives(at, 1)
    above = np.maximum(-2.0 * (slope + at * density), 0.0)
    return surface.asperity_density * width * math.sqrt(2.0 * radius * surface.roughness) * above


def mean_square_position(gap: float, radius: float, surface: Surface) -> float:
    r"""Mean square distance from the middle at which the asperities of an approaching contact touch.

    Parameters
    ----------
    gap, radius, surface
        As for `expected_asperities`.

    Returns
    -------
    float
        :math:`\tfrac23 R \sigma (\psi(G)/n_0 - G)` [m^2] with :math:`n_0 = \int_G^\infty \psi`, from the same equation
        of psi; :math:`R\sigma/G` far out.
    """
    at = gap / surface.roughness
    density, slope = psi_derivatives(np.asarray(at), 1)
    above = -2.0 * (slope + at * density)
    return 2.0 / 3.0 * radius * surface.roughness * (float(density / above) - at)


def asperities_for_mean(gap: float, parts: Iterable[tuple[Surface, float, float]], asperity: str) -> float:
    r"""Number of asperities from which on the force of one contact is its mean over many surfaces to a tenth.

    The force of n asperities drawn at random scatters by :math:`\kappa/\sqrt n` of its mean (one standard deviation),

    .. math::

        \kappa^2 = \frac{\int P^2 \psi\,\mathrm{d}\Delta \int \psi\,\mathrm{d}\Delta}
                        {\left(\int P \psi\,\mathrm{d}\Delta\right)^2},

    integrals over the displacements of the asperities that have joined on approach. Loads of both signs nearly cancel
    where adhesion is strong, so that kappa is large there.

    Parameters
    ----------
    gap : float
        Smallest mean gap between the rigid shapes [m].
    parts : iterable of (Surface, float, float)
        Surface, share and gap offset [m] of each material of the interface; all have one roughness and density.
    asperity : str
        Name of the law of one asperity.

    Returns
    -------
    float
        ``(10 kappa)^2``; infinite where the mean force vanishes.
    """
    count = mean = square = 0.0
    for surface, share, offset in parts:
        heights, at = heights_of(surface, asperity), (gap + offset) / surface.roughness
        density, slope = psi_derivatives(np.asarray(at - heights.law.join), 1)
        load, load_square = heights.moments(psi, at)
        count -= share * 2.0 * float(slope + (at - heights.law.join) * density)
        mean += share * heights.unit_load * load
        square += share * heights.unit_load**2 * load_square
    return 100.0 * count * square / mean**2 if mean != 0.0 else math.inf


def density_product(surface: Surface) -> float:
    """Asperity density times tip radius times roughness.

    Parameters
    ----------
    surface : Surface
        Asperity density, tip radius and roughness (SI).

    Returns
    -------
    float
        ``N beta sigma`` [1]; random surfaces have 0.03 to 0.06.
    """
    return surface.asperity_density * surface.asperity_radius * surface.roughness


def zero_load_radius(surface: Surface) -> float:
    """Radius to which adhesion alone opens the contact of one JKR asperity.

    Parameters
    ----------
    surface : Surface
        Elastic constants, energy and tip radius (SI).

    Returns
    -------
    float
        ``(9 pi beta^2 dgamma / (2 E*))**(1/3)`` [m].
    """
    tip = asperity_of(surface)
    return math.cbrt(4.5 * math.pi * tip.radius**2 * tip.work_of_adhesion / tip.modulus)


def half_spacing(surface: Surface) -> float:
    """Half the mean distance between asperities.

    Parameters
    ----------
    surface : Surface
        Asperity density (SI).

    Returns
    -------
    float
        ``1 / (2 sqrt(N))`` [m]: contacts of a larger radius grow into their neighbours.
    """
    return 0.5 / math.sqrt(surface.asperity_density)
