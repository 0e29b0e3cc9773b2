"""The summits of a band-limited surface: where they are, how high, how sharp."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from gearidae.arrays import Floats
from gearidae.surfaces.filtering import Field

_NEIGHBOURS = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 1]], dtype=bool)


class Summits(NamedTuple):
    """Summits of a surface.

    Attributes
    ----------
    heights : ndarray, shape (n,)
        [m].
    curvatures : ndarray, shape (n,)
        Mean of both principal curvatures, positive [1/m].
    positions : ndarray, shape (2, n)
        Along both indices, from the first point of the grid [m].
    """

    heights: Floats
    curvatures: Floats
    positions: Floats


def find_summits(field: Field, wanted: NDArray[np.bool_]) -> Summits:
    """Find the maxima of a surface.

    Parameters
    ----------
    field : Field
        The surface; its grid resolves the shortest wave.
    wanted : ndarray of bool, shape (rows, columns)
        Where to look.

    Returns
    -------
    Summits
        Points that are higher than their eight neighbours, moved by one Newton step from the point of the grid to where
        the slope vanishes; height and curvature are interpolated there by cubic splines.
    """
    highest = ndimage.maximum_filter(field.heights, footprint=_NEIGHBOURS, mode="nearest")
    rows, columns = np.nonzero((field.heights > highest) & wanted)
    positions = np.stack([rows, columns]).astype(np.float64) + _to_the_top(field, rows, columns)
    heights, laplacian = (
        ndimage.map_coordinates(values, positions, order=3, mode="nearest")
        for values in (field.heights, field.curvature)
    )
    return Summits(heights, -0.5 * laplacian, positions * np.array(field.spacing)[:, None])


def _to_the_top(field: Field, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> Floats:
    """Newton's step from points of the grid to the maximum, in points, shape (2, n); none where it leads too far."""
    down = np.minimum(rows + 1, field.heights.shape[0] - 1), np.maximum(rows - 1, 0)
    right = np.minimum(columns + 1, field.heights.shape[1] - 1), np.maximum(columns - 1, 0)
    along_rows, along_columns = (
        slope * step for slope, step in zip(field.slopes, field.spacing, strict=True)
    )  # heights per point of the grid
    aa = 0.5 * (along_rows[down[0], columns] - along_rows[down[1], columns])
    bb = 0.5 * (along_columns[rows, right[0]] - along_columns[rows, right[1]])
    # the mixed derivative has two differences, which differ by their errors: their mean depends on no order of the axes
    ab = 0.25 * (
        (along_rows[rows, right[0]] - along_rows[rows, right[1]])
        + (along_columns[down[0], columns] - along_columns[down[1], columns])
    )
    a, b = along_rows[rows, columns], along_columns[rows, columns]
    determinant = aa * bb - ab * ab
    with np.errstate(divide="ignore", invalid="ignore"):
        step = np.stack([(ab * b - bb * a) / determinant, (ab * a - aa * b) / determinant])
    sound = (determinant > 0.0) & (np.abs(step) <= 1.0).all(axis=0)
    return np.where(sound, step, 0.0)
