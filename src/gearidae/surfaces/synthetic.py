"""Gaussian surfaces of a known spectrum, to try the analysis on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearidae.errors import SceneError
from gearidae.scene.group import shorten


def gaussian_map(
    points: int,
    size: float,
    rms_height: float,
    *,
    shortest: float,
    longest: float,
    hurst: float = 0.8,
    seed: int = 0,
) -> NDArray[np.float64]:
    r"""Make a square map of an isotropic, self-affine Gaussian surface.

    Parameters
    ----------
    points : int
        Along each side.
    size : float
        Length of a side [m].
    rms_height : float
        Of the ensemble of such surfaces [m].
    shortest, longest : float
        Wavelengths between which the spectrum lies [m].
    hurst : float, optional
        Exponent :math:`H`; the spectrum falls as :math:`q^{-2-2H}`.
    seed : int, optional
        Of the random numbers.

    Returns
    -------
    ndarray, shape (points, points)
        Heights [m]. The map is cut out of one twice as long, so that its edges do not match each other, as those of a
        measured map.

    Raises
    ------
    SceneError
        If the wavelengths are not in order, or the points do not resolve the shortest.
    """
    if not 2 * size / points <= shortest < longest <= 2 * size:
        allowed = f"must lie in {2 * size / points:.4g}..{2 * size:.4g} m, the shorter one first"
        raise SceneError("shortest, longest", shorten(f"{shortest:g}, {longest:g}"), allowed)
    count = 2 * points
    white = np.random.default_rng(seed).standard_normal((count, count))
    rows = 2 * np.pi * np.fft.fftfreq(count, size / points)
    columns = 2 * np.pi * np.fft.rfftfreq(count, size / points)
    q = np.hypot(rows[:, None], columns[None, :])
    inside = (q >= 2 * np.pi / longest) & (q <= 2 * np.pi / shortest)
    weight = np.where(inside, np.where(inside, q, 1.0) ** (-1.0 - hurst), 0.0)
    # white noise has unit power in every wave: the sum of the weights' squares is the variance, both halves counted
    whole = 2 * np.square(weight).sum() - np.square(weight[:, [0, -1]]).sum()
    surface = np.fft.irfft2(np.fft.rfft2(white) * weight, s=white.shape) * count / np.sqrt(whole)
    heights: NDArray[np.float64] = rms_height * surface[:points, :points]
    return heights
