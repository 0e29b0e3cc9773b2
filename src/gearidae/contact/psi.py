r"""The universal kernel of a rough line contact.

A gap that opens as :math:`G + s^2` along the contact meets Gaussian asperities with the density

.. math::

    \psi(y) = \int_{-\infty}^{\infty} \varphi(y + s^2)\,\mathrm{d}s
            = \frac{1}{\sqrt2}\, e^{-y^2/4} D_{-1/2}(y), \qquad
    \psi^{(k)}(y) = \frac{(-1)^k}{\sqrt2}\, e^{-y^2/4} D_{k-1/2}(y),

with :math:`\varphi` the standard normal density and D Whittaker's parabolic cylinder function. It rises as
:math:`|y|^{-1/2}` from the left and falls as :math:`e^{-y^2/2}` to the right; the scaled form multiplies by
:math:`e^{\max(y, 0)^2/2}`, so that the far tail keeps its digits.

References
----------
NIST Digital Library of Mathematical Functions, https://dlmf.nist.gov/12: 12.7(iii) (Bessel functions), 12.8
(recurrences), 12.9 (asymptotic series).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special

# Three ways to the same numbers, each where it loses no digits: the asymptotic series left of _LEFT, the trapezoidal
# rule between, Bessel functions with the recurrence upwards in order right of _RIGHT.
_LEFT, _RIGHT = -11.0, 1.0
_SERIES_TERMS = 24
_NODE_SPACING = 1.0 / 12.0
_NODES = np.arange(57) * _NODE_SPACING
_WEIGHTS = np.full(57, 2.0 * _NODE_SPACING / math.sqrt(2.0 * math.pi))
_WEIGHTS[0] *= 0.5


def psi(y: ArrayLike) -> NDArray[np.float64]:
    """Kernel of a rough line contact, ``int phi(y + s^2) ds`` over all s.

    Parameters
    ----------
    y : array_like
        Gap plus displacement in units of the roughness.

    Returns
    -------
    ndarray
        The shape of `y`; relative error below 1e-13.
    """
    return np.asarray(psi_derivatives(y, 0)[0])


def psi_derivatives(y: ArrayLike, order: int, *, scaled: bool = False) -> NDArray[np.float64]:
    """Kernel of a rough line contact with its derivatives.

    Parameters
    ----------
    y : array_like
        Gap plus displacement in units of the roughness.
    order : int
        Highest derivative, 0 to 6.
    scaled : bool, optional
        Multiply each derivative by ``exp(max(y, 0)**2 / 2)`` (the factor itself is not differentiated).

    Returns
    -------
    ndarray, shape (order + 1, *y.shape)
        Row k holds the k-th derivative.
    """
    points = np.asarray(y, dtype=np.float64)
    flat = points.ravel()
    rows = np.full((order + 1, flat.size), np.nan)
    left, right = flat < _LEFT, flat > _RIGHT
    middle = (flat >= _LEFT) & (flat <= _RIGHT)
    for region, method in ((left, _by_series), (middle, _by_trapezoid), (right, _by_bessel)):
        if region.any():
            rows[:, region] = method(flat[region], order)
    if not scaled:
        rows *= gaussian_tail(flat)
    return rows.reshape(order + 1, *points.shape)


def gaussian_tail(y: ArrayLike) -> NDArray[np.float64]:
    """Return ``exp(-max(y, 0)**2 / 2)`` to full relative precision, which rounding the square would spoil."""
    above = np.maximum(np.asarray(y, dtype=np.float64), 0.0)
    coarse = np.round(above * 32.0) / 32.0
    with np.errstate(over="ignore", under="ignore"):
        return np.asarray(np.exp(-0.5 * coarse**2) * np.exp(-0.5 * (above - coarse) * (above + coarse)))


def _by_series(y: NDArray[np.float64], order: int) -> NDArray[np.float64]:
    """Sum ``x^(-k-1/2) (1/2)_(2s+k) / (s! (2 x^2)^s)`` over s, x = -y."""
    x = -y
    small = 0.5 / x / x
    rows = np.empty((order + 1, y.size))
    for k in range(order + 1):
        total = np.zeros_like(x)
        for s in range(_SERIES_TERMS, 0, -1):  # Horner's scheme from the ratio of neighbouring terms
            total = (1.0 + total) * ((2 * s + k - 0.5) * (2 * s + k - 1.5) / s) * small
        rows[k] = special.poch(0.5, k) * (1.0 + total) / np.sqrt(x) / x**k
    return rows


def _by_trapezoid(y: NDArray[np.float64], order: int) -> NDArray[np.float64]:
    """Sum the integral over s itself: entire and fast decaying, so that equal steps converge geometrically."""
    z = y[:, None] + _NODES**2
    above = np.maximum(y, 0.0)[:, None]
    density = np.exp(-0.5 * (z - above) * (z + above)) * _WEIGHTS
    rows = np.empty((order + 1, y.size))
    rows[0] = density.sum(axis=1)
    hermite, previous = np.ones_like(z), np.zeros_like(z)  # (-1)^k He_k(z)
    for k in range(order):
        hermite, previous = -z * hermite - k * previous, hermite
        rows[k + 1] = (hermite * density).sum(axis=1)
    return rows


def _by_bessel(y: NDArray[np.float64], order: int) -> NDArray[np.float64]:
    """Use ``D_(-1/2)(y) = sqrt(y/2pi) K_(1/4)(y^2/4)`` and ``D_(v+1) = y D_v - v D_(v-1)``."""
    quarter = special.kve(0.25, 0.25 * y**2)
    rows = np.empty((max(order, 1) + 1, y.size))
    rows[0] = np.sqrt(y / (4.0 * math.pi)) * quarter
    rows[1] = -0.25 * y * np.sqrt(y / math.pi) * (quarter + special.kve(0.75, 0.25 * y**2))
    for k in range(order - 1):
        rows[k + 2] = -y * rows[k + 1] - (k + 0.5) * rows[k]
    return rows[: order + 1]
