r"""Asperities of an isotropic Gaussian surface from its spectral moments.

The moments are those of a profile: with the heights :math:`z` over a straight line,

.. math::

    m_0 = \overline{z^2}, \qquad m_2 = \overline{z'^2}, \qquad m_4 = \overline{z''^2}.

Nayak 1971 (doi:10.1115/1.3451608) gives density, heights and curvatures of the summits; McCool 1986
(doi:10.1016/0043-1648(86)90045-1) the numbers used here.
"""

from __future__ import annotations

import math
from typing import NamedTuple

_HEIGHT_FACTOR = 0.8968
"""Nayak's variance of the summit heights is (1 - 0.8968/alpha) m0."""


class Asperities(NamedTuple):
    """Numbers of a rough surface: three that a scene has, and where the summits lie.

    Attributes
    ----------
    roughness : float
        Rms height of the summits about their own mean, sigma [m].
    density : float
        Summits per area, N [1/m^2].
    radius : float
        Mean tip radius, beta: the inverse of the mean curvature of the summits [m].
    plane : float
        Height of the summits' mean plane above that of the surface [m]. A scene does not have it: its gaps count from
        the summits' mean plane.
    """

    roughness: float
    density: float
    radius: float
    plane: float = math.nan


def from_moments(m0: float, m2: float, m4: float) -> Asperities:
    r"""Asperities of an isotropic Gaussian surface.

    Parameters
    ----------
    m0, m2, m4 : float
        Variance of the heights [m^2], of the slopes [1] and of the curvatures [1/m^2] of a profile.

    Returns
    -------
    Asperities
        NaN where the moments belong to no surface.

    Notes
    -----
    With the bandwidth parameter :math:`\alpha = m_0 m_4 / m_2^2`, at least 1.5 for an isotropic surface,

    .. math::

        N = \frac{m_4}{6\pi\sqrt{3}\,m_2}, \qquad \beta = \frac{3\sqrt{\pi}}{8\sqrt{m_4}}, \qquad
        \sigma^2 = \left(1 - \frac{0.8968}{\alpha}\right) m_0, \qquad
        \bar z_s = 4 \sqrt{\frac{m_0}{\pi\alpha}} .

    Sources: McCool 1986; for the summits' mean height :math:`\bar z_s` Nayak 1971.
    """
    if not (m0 > 0.0 and m2 > 0.0 and m4 > 0.0):
        return Asperities(math.nan, math.nan, math.nan)
    variance = m0 - _HEIGHT_FACTOR * m2**2 / m4
    return Asperities(
        roughness=math.sqrt(variance) if variance > 0.0 else math.nan,
        density=m4 / (6.0 * math.pi * math.sqrt(3.0) * m2),
        radius=3.0 * math.sqrt(math.pi) / (8.0 * math.sqrt(m4)),
        plane=4.0 * m2 / math.sqrt(math.pi * m4),
    )
