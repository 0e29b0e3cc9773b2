r"""The asperities' load added up over their heights.

With lengths in units of the roughness and loads in units of ``4/3 E* sqrt(beta) sigma^1.5`` (the Hertz load at a
compression of one roughness), the three asperity laws read

.. math::

    P_\mathrm{JKR} = \tau^3(\tau^3 - 6k), \quad \Delta = \tau^4 - 4k\tau \ge -D_c; \qquad
    P_\mathrm{DMT} = \tau^6 - 12k^2, \quad P_\mathrm{Hertz} = \tau^6, \quad \Delta = \tau^4 \ge 0,

with :math:`k = (D_c/3)^{3/4}`. Integrated over :math:`\tau` the square-root singularity at the JKR fold
:math:`\tau^3 = k` is gone, and no adhesion at all is just k = 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearidae.contact.jkr import ASPERITY_LAWS, S_FOLD, AsperityLaw, Surface, asperity_of, jkr_root
from gearidae.errors import SceneError

__all__ = ["Heights", "checked_gap_and_stretch", "heights_of", "normal_density", "normal_density_slope"]

Array: TypeAlias = NDArray[np.float64]
Kernel: TypeAlias = Callable[[Array], Array]

# Nothing counts beyond 9.5 standard deviations, nor 45 e-foldings past the first asperity that joins.
_DEEP, _EFOLDINGS = -9.5, 45.0
_X, _W = np.polynomial.legendre.leggauss(80)
_X, _W = 0.5 * (1.0 + _X), 0.5 * _W
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
    adhesion : float
        The k of the asperity law; 0 without adhesion.
    stretch_limit : float
        How far an asperity stretches before it lets go, in roughnesses: ``dc/sigma`` for JKR, else 0.
    law : {"jkr", "dmt", "hertz"}
        The asperity law.
    """

    roughness: float
    unit_load: float
    adhesion: float
    stretch_limit: float
    law: AsperityLaw

    def integral(self, kernel: Kernel, gap: Array, stretch: Array, *, decays_left: bool) -> Array:
        r"""Integrate load times kernel, :math:`\int_{-S}^\infty P(\Delta)\,K(H + \Delta)\,\mathrm{d}\Delta`.

        Parameters
        ----------
        kernel : callable
            K, elementwise; decays like ``exp(-z**2/2)`` to the right.
        gap, stretch : ndarray, one shape
            H and S in roughnesses, 0 <= S <= `stretch_limit`.
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

    def edge_load(self, stretch: Array) -> Array:
        """Load of the asperity that is stretched most, in units of `unit_load`."""
        return self._load(self._root(-stretch))

    def _integral(self, kernel: Kernel, gap: Array, stretch: Array, decays_left: bool) -> Array:
        first = gap - stretch
        middle = np.maximum(first, _DEEP)
        last = np.sqrt(np.maximum(middle, 0.0) ** 2 + 2.0 * _EFOLDINGS)
        upper = self._root(last - gap)
        # Where the window starts at the first joined asperity take its root from the stretch: the gap has been
        # rounded into the difference.
        lower = self._root(np.where(first < _DEEP, _DEEP - gap, -stretch))
        total = self._panel(kernel, gap, lower, upper, _X, _W)
        deep = first < _DEEP
        if not decays_left and deep.any():
            # Crowded quadratically to the right, where the kernel's bend at 0 is near the end of this panel.
            total[deep] += self._panel(
                kernel,
                gap[deep],
                self._root(-stretch[deep]),
                lower[deep],
                _X * (2.0 - _X),
                2.0 * _W * (1.0 - _X),
            )
        return total

    def _panel(
        self, kernel: Kernel, gap: Array, lower: Array, upper: Array, nodes: Array, weights: Array
    ) -> Array:
        root = lower[:, None] + (upper - lower)[:, None] * nodes
        if self.law == "jkr":
            displacement = root * (root**3 - 4.0 * self.adhesion)
            rate = 4.0 * (root**3 - self.adhesion)
        else:
            displacement = root**4
            rate = 4.0 * root**3
        integrand = self._load(root) * rate * kernel(gap[:, None] + displacement)
        return np.asarray((upper - lower) * (integrand @ weights))

    def _load(self, root: Array) -> Array:
        cube = root**3
        if self.law == "jkr":
            return cube * (cube - 6.0 * self.adhesion)
        return cube**2 - 12.0 * self.adhesion**2

    def _root(self, displacement: Array) -> Array:
        if self.stretch_limit > 0.0:
            return jkr_root(displacement / self.stretch_limit) * (math.cbrt(self.adhesion) / S_FOLD)
        return np.maximum(displacement, 0.0) ** 0.25


def heights_of(surface: Surface, law: AsperityLaw) -> Heights:
    """Return the asperities of a surface under a law, checked and in units of the roughness.

    Raises
    ------
    SceneError
        If the law is unknown, or a property of the surface is not a positive number (the energy may be zero).
    """
    if law not in ASPERITY_LAWS:
        raise SceneError("contact.asperity", law, "must be one of " + ", ".join(ASPERITY_LAWS))
    for key in ("youngs_modulus", "asperity_density", "asperity_radius", "roughness"):
        value = getattr(surface, key)
        if not 0.0 < value < math.inf:
            raise SceneError(f"surface.{key}", value, "must be a positive number")
    if not 0.0 <= surface.energy < math.inf:
        raise SceneError("surface.energy", surface.energy, "must be zero or a positive number")
    tip = asperity_of(surface)
    reach = tip.stretch_limit / surface.roughness
    return Heights(
        roughness=surface.roughness,
        unit_load=tip.hertz_factor * surface.roughness**1.5,
        adhesion=0.0 if law == "hertz" else (reach / 3.0) ** 0.75,
        stretch_limit=reach if law == "jkr" else 0.0,
        law=law,
    )


def checked_gap_and_stretch(gap: ArrayLike, stretch: ArrayLike, heights: Heights) -> tuple[Array, Array]:
    """Broadcast gap and stretch [m] to one shape and return them in roughnesses, the stretch within its limit.

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
    return h / heights.roughness, np.minimum(s / heights.roughness, heights.stretch_limit)


def normal_density(z: Array) -> Array:
    """Density of heights between two planes, the kernel of the pressure."""
    return np.exp(-0.5 * z**2) / math.sqrt(2.0 * math.pi)


def normal_density_slope(z: Array) -> Array:
    """Derivative of `normal_density`, the kernel of the pressure's slope."""
    return -z * normal_density(z)
