r"""A height map without the waves shorter than a cut-off, with its slopes and curvature, on a grid that resolves them.

The map is a sum of cosines (DCT-II), which continues it as a mirror image beyond its edges: unlike a Fourier series, no
step arises there for which the spectrum would pay with a tail. Waves with wavenumbers above
:math:`q_c = 2\pi/\lambda_c` are left out; what remains is evaluated, with its derivatives, at eight points for each
shortest wavelength, however coarse or fine the map is.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy import fft

from gearidae.arrays import Floats

POINTS_PER_WAVE = 8
"""Points of the grid along one cut-off wavelength."""


class Field(NamedTuple):
    """A band-limited surface on a grid.

    Attributes
    ----------
    heights : ndarray, shape (rows, columns)
        [m].
    slopes : tuple of ndarray, each of shape (rows, columns)
        Derivatives along both indices [1].
    curvature : ndarray, shape (rows, columns)
        Laplacian of the heights [1/m].
    spacing : tuple of float
        Distance of the points along both indices [m].
    """

    heights: Floats
    slopes: tuple[Floats, Floats]
    curvature: Floats
    spacing: tuple[float, float]


def cosine_sum(heights: Floats) -> Floats:
    """Amplitudes of the cosines that add up to the heights, shape (rows, columns) [m]."""
    amplitudes: Floats = fft.dctn(heights, type=2, norm="forward", workers=-1)
    return amplitudes


def grid_points(size: tuple[float, float], cutoff: float) -> tuple[int, int]:
    """Return the points along both sides of the grid on which `band_limited` evaluates a map."""
    rows, columns = (math.ceil(POINTS_PER_WAVE * length / cutoff) for length in size)
    return rows, columns


def band_limited(amplitudes: Floats, size: tuple[float, float], cutoff: float) -> Field:
    """Evaluate a sum of cosines without the short waves.

    Parameters
    ----------
    amplitudes : ndarray, shape (rows, columns)
        From `cosine_sum`.
    size : tuple of float
        Extent of the map [m].
    cutoff : float
        Shortest wavelength that is kept [m].
    """
    shape = grid_points(size, cutoff)
    kept = tuple(slice(min(whole, other)) for whole, other in zip(amplitudes.shape, shape, strict=True))
    waves = np.zeros(shape)
    waves[kept] = amplitudes[kept]
    rows, columns = (
        np.pi * np.arange(count, dtype=np.float64) / length for count, length in zip(shape, size, strict=True)
    )
    squared = rows[:, None] ** 2 + columns[None, :] ** 2
    waves[squared > (2.0 * np.pi / cutoff) ** 2] = 0.0
    return Field(
        _summed(waves),
        (_derived(waves, rows, 0), _derived(waves, columns, 1)),
        _summed(-squared * waves),
        (size[0] / shape[0], size[1] / shape[1]),
    )


def _summed(waves: Floats) -> Floats:
    heights: Floats = fft.idctn(waves, type=2, norm="forward", workers=-1)
    return heights


def _derived(waves: Floats, wavenumbers: Floats, axis: int) -> Floats:
    """Sum the derivatives of the cosines: sines along one axis, the first of which belongs to the second cosine."""
    shape = [1, 1]
    shape[axis] = -1
    sines = np.roll(-wavenumbers.reshape(shape) * waves, -1, axis=axis)  # that of the constant, 0, comes last
    part = fft.idst(sines, type=2, norm="forward", axis=axis, workers=-1)
    slopes: Floats = fft.idct(part, type=2, norm="forward", axis=1 - axis, workers=-1)
    return slopes
