"""Densities of heights with their derivatives: psi for a parabolic gap, the normal density for planes."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.compiled import compiled
from gearidae.contact.kernels.layout import GAP_LOW, STRETCH_HIGH, Kernel
from gearidae.contact.psi import psi_derivatives


def kernel_at_knots(kernel: Kernel, knots: Floats) -> Floats:
    """Density with three derivatives at a few points, each worked out anew, shape (4, n)."""
    return psi_derivatives(knots, 3) if kernel == "line" else _normal_derivatives(knots)


def kernel_at(kernel: Kernel, y: Floats) -> Floats:
    """Density with three derivatives at many points, shape (4, *y.shape)."""
    return _psi_at(y) if kernel == "line" else _normal_derivatives(y)


def _normal_derivatives(y: Floats) -> Floats:
    """Standard normal density and three derivatives, shape (4, *y.shape)."""
    density = np.exp(-0.5 * y**2) / math.sqrt(2.0 * math.pi)
    return np.stack([density, -y * density, (y**2 - 1.0) * density, (3.0 * y - y**3) * density])


PSI_KNOTS: Final = 16  # per roughness, of the Taylor expansions below
PSI_ORDER: Final = 12


@lru_cache(maxsize=1)
def _psi_knots() -> tuple[float, Floats]:
    """First knot and Taylor coefficients of psi, shape (n, order + 1), wide enough for every surface."""
    low, high = GAP_LOW - STRETCH_HIGH - 2.0, 30.0
    knots = np.arange(round(low * PSI_KNOTS), round(high * PSI_KNOTS) + 1) / PSI_KNOTS
    factorial = np.cumprod(np.maximum(np.arange(PSI_ORDER + 1.0), 1.0))
    return low, np.ascontiguousarray((psi_derivatives(knots, PSI_ORDER) / factorial[:, None]).T)


def _psi_at(y: Floats) -> Floats:
    """psi and three derivatives at y, shape (4, *y.shape), from Taylor expansions about knots; 0 beyond 30."""
    low, table = _psi_knots()
    out = np.zeros((4, y.size))
    _psi_taylor(np.ascontiguousarray(y).ravel(), low, table, out)
    return out.reshape(4, *y.shape)


@compiled
def _psi_taylor(y: Floats, low: float, table: Floats, out: Floats) -> None:
    for i in range(y.size):
        j = math.floor((y[i] - low) * PSI_KNOTS + 0.5)
        if j >= table.shape[0]:
            continue
        d = y[i] - (low + j / PSI_KNOTS)
        f0 = f1 = f2 = f3 = 0.0
        for k in range(PSI_ORDER, -1, -1):
            f3 = f3 * d + f2
            f2 = f2 * d + f1
            f1 = f1 * d + f0
            f0 = f0 * d + table[j, k]
        out[0, i], out[1, i], out[2, i], out[3, i] = f0, f1, 2.0 * f2, 6.0 * f3
