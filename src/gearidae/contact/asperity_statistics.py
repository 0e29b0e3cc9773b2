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

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearidae.asperities import law_of
from gearidae.asperities.tip import Surface, asperity_of
from gearidae.contact.psi import psi, psi_derivatives

__all__ = ["density_product", "expected_asperities", "force_scatter", "half_spacing", "zero_load_radius"]

_X, _W = np.polynomial.legendre.leggauss(200)
_REACH = 12.0  # roughnesses above the gap beyond which no asperity stands


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


def force_scatter(gap: float, surface: Surface, asperity: str = "jkr") -> float:
    r"""How much the force of one pair of teeth scatters about the mean of many, approaching.

    Parameters
    ----------
    gap : float
        Smallest mean gap g between the rigid shapes [m].
    surface : Surface
        Elastic constants, energy, tip radius and roughness (SI).
    asperity : str, optional
        Name of the asperity law.

    Returns
    -------
    float
        :math:`\kappa = \sqrt{\int P^2 \psi \int \psi} \,/\, |\int P \psi|`, integrals over the displacement from 0
        on [1]: with n asperities in contact the standard deviation over the mean is :math:`\kappa / \sqrt n`, as places
        and heights are independent and n is Poisson's.
    """
    law = law_of(asperity, surface)
    root = (
        0.5 * math.sqrt(_REACH) * (_X + 1.0)
    )  # in the root of the displacement the load of a tip that touches is smooth
    displacement = root**2
    load = law.load(displacement)
    weight = _W * root * psi(gap / surface.roughness + displacement)
    return math.sqrt(float(weight @ load**2) * float(weight.sum())) / abs(float(weight @ load))


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
