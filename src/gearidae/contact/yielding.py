r"""When the tip of an asperity yields, and how hard the highest asperity of a rough contact is pressed.

The model's asperities are elastic. The tip of radius beta yields below its surface at the load

.. math::

    P_Y = \frac{\pi^3 \beta^2 (1.6\,Y)^3}{6 E^{*2}}, \qquad Y = \frac{H}{2.8},

of a Hertz contact whose largest pressure is 1.6 times the yield stress Y, which hardness H gives.

References
----------
K. L. Johnson, Contact Mechanics, Cambridge University Press (1985), sections 6.1 and 6.3,
doi:10.1017/CBO9781139171731.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from scipy.optimize import brentq

from gearidae.asperities.tip import Surface, contact_modulus
from gearidae.contact.asperity_statistics import expected_asperities
from gearidae.contact.heights import heights_of

HARDNESS: Final = 12e9
"""Hardness of silicon [Pa]: an assumption, the usual size of what indentation of silicon gives."""


def yield_load(surface: Surface, hardness: float = HARDNESS) -> float:
    """Load at which the tip of an asperity yields.

    Parameters
    ----------
    surface : Surface
        Elastic constants and tip radius (SI).
    hardness : float, optional
        Hardness H [Pa].

    Returns
    -------
    float
        P_Y [N], adhesion left out.
    """
    modulus = contact_modulus(surface.youngs_modulus, surface.poisson_ratio)
    pressure = 1.6 * hardness / 2.8
    return math.pi**3 * surface.asperity_radius**2 * pressure**3 / (6.0 * modulus**2)


def highest_load(
    gap: float,
    force: float,
    parts: Sequence[tuple[Surface, float, float]],
    shape: tuple[float, float],
    asperity: str,
) -> float:
    r"""Load of the highest asperity of a contact, by the mean law.

    Parameters
    ----------
    gap : float
        Smallest mean gap g between the rigid shapes [m].
    force : float
        Force of the contact there [N].
    parts : sequence of (Surface, float, float)
        Surface, share and gap offset [m] of each material of the interface.
    shape : (float, float)
        Reduced radius R and face width L [m].
    asperity : str
        Name of the law of one asperity.

    Returns
    -------
    float
        Load [N].

    Notes
    -----
    An asperity that is pressed by Delta or more at the gap g is one that is in contact at the gap g + Delta: their
    expected number is :math:`n(g + \Delta)`, with n of `expected_asperities`. The highest is taken to be pressed by the
    Delta at which one asperity is expected, :math:`n(g + \Delta) = 1`, and carries the law's load there, but no less
    than the mean :math:`W/n(g)`. Where fewer than one is expected in contact, a real pair closes until one carries
    the whole force W.
    """
    radius, width = shape

    def count(displacement: float, part: tuple[Surface, float, float]) -> float:
        surface, share, offset = part
        return share * float(expected_asperities(gap + offset + displacement, radius, width, surface))

    load = force / max(sum(count(0.0, part) for part in parts), 1.0)
    for part in parts:
        if count(0.0, part) <= 1.0:
            continue
        surface, _, offset = part
        sigma = surface.roughness
        highest = max(20.0 * sigma - gap - offset, sigma)  # the tail of the heights there is below 1e-87
        pressed = brentq(
            lambda at, part=part: math.log(max(count(at, part), 1e-300)), 0.0, highest, xtol=1e-6 * sigma
        )
        heights = heights_of(surface, asperity)
        load = max(load, heights.unit_load * float(heights.law.load(pressed / sigma)))
    return load
