r"""The asperities' load added up over their heights.

With lengths in units of the roughness and loads in units of ``4/3 E* sqrt(beta) sigma^1.5`` (the Hertz load at a
compression of one roughness), a law of `gearidae.asperities` gives the load P of an asperity at its
displacement, and heights add it up to

.. math::

    \int_{-S}^\infty P(\Delta)\,K(H + \Delta)\,\mathrm{d}\Delta ,

with K the density of heights, and S the extension of the asperity that is stretched most. An approaching contact has
S = `join`; one that parts stretches its asperities up to S = `detach`. The law lays the quadrature out, so that the
square root at the end of its stable branch does no harm.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearidae.asperities import AsperityLaw, law_of
from gearidae.asperities.tip import Surface, asperity_of
from gearidae.errors import SceneError

Array: TypeAlias = NDArray[np.float64]
Kernel: TypeAlias = Callable[[Array], Array]

# Nothing counts beyond 9.5 standard deviations, nor 45 e-foldings past the first asperity that joins.
_DEEP, _EFOLDINGS = -9.5, 45.0
_X, _W = np.polynomial.legendre.leggauss(80)
# Crowded quadratically to the right: for panels with the kernel's bend at 0 near their end.
_X_RIGHT, _W_RIGHT = 0.5 * (1.0 + _X) * (3.0 - _X) - 1.0, _W * (1.0 - _X)
_CHUNK = 4096


@dataclass(frozen=True, slots=True)
class Heights:
    """Gaussian asperities of one surface under one asperity law, in units of the roughness.

    Attributes
    ----------
    roughness : float
        Unit of length [m].
    unit_load : float
        Unit of load, ``4/3 E* sqrt(beta) sigma^1.5`` [N].
    law : AsperityLaw
        The asperity law in these units.
    """

    roughness: float
    unit_load: float
    law: AsperityLaw

    def integral(self, kernel: Kernel, gap: Array, stretch: Array, *, decays_left: bool) -> Array:
        r"""Integrate load times kernel, :math:`\int_{-S}^\infty P(\Delta)\,K(H + \Delta)\,\mathrm{d}\Delta`.

        Parameters
        ----------
        kernel : callable
            K, elementwise; decays like ``exp(-z**2/2)`` to the right.
        gap, stretch : ndarray, one shape
            H and S in roughnesses, S from the joining to the detachment of an asperity.
        decays_left : bool
            Whether K decays the same way to the left (if not: algebraically).

        Returns
        -------
        ndarray
            In units of `unit_load`, the shape of `gap`; relative error below 1e-12 (of the integral of the absolute
            value, where loads of both signs cancel).
        """
        flat_gap, flat_stretch = gap.ravel(), stretch.ravel()
        total = np.empty(flat_gap.size)
        for start in range(0, total.size, _CHUNK):
            part = slice(start, start + _CHUNK)
            total[part] = self._integral(kernel, flat_gap[part], flat_stretch[part], decays_left)
        return total.reshape(gap.shape)

    def moments(self, kernel: Kernel, gap: float) -> tuple[float, float]:
        """Integrate load times kernel, and its square times kernel, over the asperities of an approaching contact.

        Parameters
        ----------
        kernel : callable
            As for `integral`.
        gap : float
            In roughnesses.

        Returns
        -------
        load, square : float
            In units of `unit_load` and its square. To 1e-6 for gaps down to -20 roughnesses, where one panel of the
            quadrature spans the kernel; each of the integral of the absolute value.
        """
        lower = -self.law.join
        upper = math.sqrt(max(gap + lower, 0.0) ** 2 + 2.0 * _EFOLDINGS) - gap
        displacement, load = self.law.nodes(lower, upper, _X, _W)
        weighted = load * kernel(gap + displacement)
        return float(weighted.sum()), float((weighted * self.law.load(displacement)).sum())

    def edge_load(self, stretch: Array) -> Array:
        """Load of the asperity that is stretched most, in units of `unit_load`."""
        return self.law.load(-stretch)

    def _integral(self, kernel: Kernel, gap: Array, stretch: Array, decays_left: bool) -> Array:
        first = gap - stretch
        deep = first < _DEEP
        last = np.sqrt(np.maximum(first, 0.0) ** 2 + 2.0 * _EFOLDINGS)
        # Where the window starts at the first joined asperity take its displacement from the stretch: the gap has been
        # rounded into the difference.
        lower = np.where(deep, _DEEP - gap, -stretch)
        total = self._panel(kernel, gap, lower, last - gap, _X, _W)
        if not decays_left and deep.any():
            total[deep] += self._panel(kernel, gap[deep], -stretch[deep], lower[deep], _X_RIGHT, _W_RIGHT)
        return total

    def _panel(
        self, kernel: Kernel, gap: Array, lower: Array, upper: Array, nodes: Array, weights: Array
    ) -> Array:
        displacement, load = self.law.nodes(lower, upper, nodes, weights)
        return np.asarray((load * kernel(gap[:, None] + displacement)).sum(axis=-1))


def heights_of(surface: Surface, law: str) -> Heights:
    """Return the asperities of a surface under a law, checked and in units of the roughness.

    Raises
    ------
    SceneError
        If the law is unknown, or a property of the surface is not a positive number (the energy may be zero).
    """
    for key in ("youngs_modulus", "asperity_density", "asperity_radius", "roughness"):
        value = getattr(surface, key)
        if not 0.0 < value < math.inf:
            raise SceneError(f"surface.{key}", value, "must be a positive number")
    if not 0.0 <= surface.energy < math.inf:
        raise SceneError("surface.energy", surface.energy, "must be zero or a positive number")
    unit_load = asperity_of(surface).hertz_factor * surface.roughness**1.5
    return Heights(surface.roughness, unit_load, law_of(law, surface))


def checked_gap_and_stretch(gap: ArrayLike, stretch: ArrayLike, heights: Heights) -> tuple[Array, Array]:
    """Broadcast gap and stretch [m] to one shape and return them in roughnesses.

    A stretch below the distance of joining counts as that, one above the distance of detachment as that.

    Raises
    ------
    SceneError
        If a gap is not finite, or a stretch is negative or not a number.
    """
    h, s = np.broadcast_arrays(np.asarray(gap, dtype=np.float64), np.asarray(stretch, dtype=np.float64))
    if not np.all(np.isfinite(h)):
        raise SceneError("gap", h[~np.isfinite(h)].flat[0], "must be a finite number of metres")
    if not np.all(s >= 0.0):
        raise SceneError("stretch", s[~(s >= 0.0)].flat[0], "must be zero or more metres")
    return h / heights.roughness, np.clip(s / heights.roughness, heights.law.join, heights.law.detach)


def normal_density(z: Array) -> Array:
    """Density of heights between two planes, the kernel of the pressure."""
    return np.exp(-0.5 * z**2) / math.sqrt(2.0 * math.pi)


def normal_density_slope(z: Array) -> Array:
    """Derivative of `normal_density`, the kernel of the pressure's slope."""
    return -z * normal_density(z)
