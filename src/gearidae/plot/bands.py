"""A spectrum for a logarithmic axis: lines where they stand apart, averages over bands where they crowd."""

from __future__ import annotations

import numpy as np

from gearidae.arrays import Floats

_PER_OCTAVE = 24


def crowded_from(resolution: float) -> float:
    """Return the frequency above which a band of 1/24 octave is wider than the resolution [Hz]."""
    return float(resolution / (2.0 ** (1.0 / _PER_OCTAVE) - 1.0))


def banded(frequency: Floats, density: Floats, resolution: float) -> tuple[Floats, Floats]:
    """Average a spectrum over bands of 1/24 octave, where these are wider than its resolution.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        In equal steps [Hz].
    density : ndarray, shape (n,)
        Power spectral density.
    resolution : float
        Inverse of the record's length [Hz].

    Returns
    -------
    frequency, density : ndarray, shape (m,)
        The values below about 35 times the resolution, then the mean density of each band at its middle: the power in
        a band stays what it is.
    """
    from_here = crowded_from(resolution)
    crowded = frequency >= from_here
    if not crowded.any():
        return frequency, density
    number = np.floor(_PER_OCTAVE * np.log2(frequency[crowded] / from_here)).astype(np.int64)
    _, first, count = np.unique(number, return_index=True, return_counts=True)
    means = np.add.reduceat(density[crowded], first) / count
    middles = np.add.reduceat(frequency[crowded], first) / count
    return np.concatenate([frequency[~crowded], middles]), np.concatenate([density[~crowded], means])
