"""Lines of a scan that are offset against each other: drift and noise of the microscope from one line to the next.

A microscope measures a map line by line. Whatever moves meanwhile shifts whole lines, which makes steps across them and
summits that the surface has not.
"""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from gearidae.arrays import Floats

_STRONGER = 2.5
"""Line noise makes the medians' variance so many times that in the other direction: of isotropic maps 0.4 to 1.5."""
_WHITE = 1.8
"""Independent offsets have differences whose own differences have 3 times their variance, a random walk's 2, those of
waves that the map resolves less than 1."""

_OUTSTANDING = 3.0
"""A scar differs from both neighbouring rows by so many times the median difference of neighbours."""
_STRETCH = 16
"""Points in a row that do so: of random surfaces none."""


def aligned_rows(heights: Floats) -> Floats:
    """Shift each row so that the median of its differences from the row before is zero.

    Parameters
    ----------
    heights : ndarray, shape (rows, columns)
        [m]; NaN where there is none.

    Returns
    -------
    ndarray, shape (rows, columns)
        A tilt across the rows is lost, too.
    """
    offsets = np.concatenate([[0.0], np.cumsum(_medians(heights))])
    return np.asarray(heights - offsets[:, None], dtype=np.float64)


def line_noise(heights: Floats, size: tuple[float, float]) -> tuple[float, float]:
    """Offsets of rows and of columns against each other.

    Parameters
    ----------
    heights : ndarray, shape (rows, columns)
        Without tilt and curvature [m].
    size : tuple of float
        Extent along both indices [m].

    Returns
    -------
    rows, columns : float
        Root mean square of the offsets [m]; 0 where there is no line noise. It shows where medians of the differences
        between neighbouring lines vary more than in the other direction, and without connexion from line to line: those
        of grooves vary smoothly.
    """
    steps = [_medians(heights), _medians(heights.T)]
    # variances of slopes, and of means over as long a line
    scale = [size[1 - axis] * (heights.shape[axis] / size[axis]) ** 2 for axis in (0, 1)]
    variance = [float(step.var()) for step in steps]
    noise = []
    for axis in (0, 1):
        expected = variance[1 - axis] * scale[1 - axis] / scale[axis]
        white = variance[axis] > 0.0 and float(np.diff(steps[axis]).var()) > _WHITE * variance[axis]
        noisy = white and variance[axis] > _STRONGER * expected
        noise.append(float(np.sqrt(0.5 * (variance[axis] - expected))) if noisy else 0.0)
    return noise[0], noise[1]


def repeated_lines(heights: Floats) -> int:
    """Count rows [m] that equal another one, or have one height throughout, as where a scan stops; NaN is a hole."""
    rows = heights[~np.isnan(heights).all(axis=1)]
    relief = rows[np.nanmin(rows, axis=1) < np.nanmax(rows, axis=1)]
    return len(rows) - len({row.tobytes() for row in relief})


def streaks(heights: Floats) -> int:
    """Count rows [m] with a stretch that stands above, or below, both neighbouring rows: scars of a scan."""
    steps = np.diff(heights, axis=0)
    least = _OUTSTANDING * float(np.nanmedian(np.abs(steps)))
    above, below = (np.minimum(sign * steps[:-1], -sign * steps[1:]) > least for sign in (1.0, -1.0))
    long = [ndimage.binary_erosion(out, np.ones((1, _STRETCH))).any(axis=1) for out in (above, below)]
    return int((long[0] | long[1]).sum())


def _medians(heights: Floats) -> Floats:
    """Medians of the differences between each row and the next [m]; 0 where two have no point in common."""
    steps = np.diff(heights, axis=0)
    steps[np.isnan(steps).all(axis=1)] = 0.0
    return np.asarray(np.nanmedian(steps, axis=1), dtype=np.float64)
