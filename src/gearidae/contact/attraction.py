r"""Attraction of two flanks across the gap between them, by the forces of van der Waals.

Two parallel half-spaces with the Hamaker constant A attract each other at a gap h with the pressure

.. math:: p(h) = -\frac{A}{6 \pi h^3}

(J. N. Israelachvili, Intermolecular and Surface Forces, Academic Press 2011, chapter 13). Here h is the gap between the
mean planes of rough surfaces. Added up along a gap that opens as :math:`g + x^2/(2R)` across a width L,

.. math:: W(g) = -\frac{A L \sqrt{2R}}{16} g^{-5/2}, \qquad U(g) = -\frac{A L \sqrt{2R}}{24} g^{-3/2},
          \qquad W = -\frac{\mathrm{d}U}{\mathrm{d}g} .

Atoms come no closer than their equilibrium spacing, `FLOOR`: below it pressure and force stay what they are there, and
the energy falls in proportion to the gap, so that force and energy are continuous. Nothing is lost on the way.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from gearidae.arrays import Floats
from gearidae.asperities.tip import INTERACTION_RANGE
from gearidae.errors import SceneError

FLOOR: Final = INTERACTION_RANGE
"""Gap below which attraction grows no further [m]."""


def attraction_pressure(gap: ArrayLike, hamaker: float) -> Floats:
    """Pressure with which parallel planes attract each other.

    Parameters
    ----------
    gap : array_like
        Gap h between the mean planes [m].
    hamaker : float
        Hamaker constant A [J].

    Returns
    -------
    ndarray
        ``-A / (6 pi h^3)`` [Pa], negative, of the shape of `gap`; below `FLOOR` that at `FLOOR`.

    Raises
    ------
    SceneError
        If a gap is not finite or the constant is negative.
    """
    h = np.maximum(_checked(gap, hamaker=hamaker), FLOOR)
    return np.asarray(-hamaker / (6.0 * math.pi * h**3))


def attraction_force(gap: ArrayLike, radius: float, width: float, hamaker: float) -> Floats:
    """Force with which two teeth attract each other across their gap.

    Parameters
    ----------
    gap : array_like
        Smallest gap g between the mean surfaces [m].
    radius : float
        Reduced radius R of the two profiles [m].
    width : float
        Face width L [m].
    hamaker : float
        Hamaker constant A [J].

    Returns
    -------
    ndarray
        ``-A L sqrt(2 R) / 16 g^(-5/2)`` [N], negative, of the shape of `gap`; below `FLOOR` that at `FLOOR`.

    Raises
    ------
    SceneError
        If a gap is not finite, a length is not positive or the constant is negative.
    """
    g = np.maximum(_checked(gap, radius=radius, width=width, hamaker=hamaker), FLOOR)
    return np.asarray(-hamaker * width * math.sqrt(2.0 * radius) / 16.0 * g**-2.5)


def attraction_energy(gap: ArrayLike, radius: float, width: float, hamaker: float) -> Floats:
    """Energy of two teeth that attract each other across their gap, zero far apart.

    Parameters
    ----------
    gap, radius, width, hamaker
        As for `attraction_force`.

    Returns
    -------
    ndarray
        ``-A L sqrt(2 R) / 24 g^(-3/2)`` [J], of the shape of `gap`; below `FLOOR` it goes on along its tangent.

    Raises
    ------
    SceneError
        As `attraction_force`.
    """
    g = _checked(gap, radius=radius, width=width, hamaker=hamaker)
    near = np.maximum(g, FLOOR)
    force = attraction_force(near, radius, width, hamaker)
    return np.asarray(force * (2.0 / 3.0 * near - np.minimum(g - FLOOR, 0.0)))


def _checked(gap: ArrayLike, *, hamaker: float, **lengths: float) -> Floats:
    """Return gaps as an array."""
    for key, value in lengths.items():
        if not 0.0 < value < math.inf:
            raise SceneError(key, value, "must be a positive number of metres")
    if not 0.0 <= hamaker < math.inf:
        raise SceneError("hamaker", hamaker, "must be 0 or a positive number of joules")
    gaps = np.asarray(gap, dtype=np.float64)
    if not np.all(np.isfinite(gaps)):
        raise SceneError("gap", "(not finite)", "must be finite numbers of metres")
    return gaps
