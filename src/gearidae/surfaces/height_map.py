"""A map of heights: checked, without its tilt and curvature, its holes filled and known."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse
from scipy.sparse import linalg

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.scene.carried import numbers_of
from gearidae.surfaces.lines import aligned_rows, line_noise, repeated_lines, streaks

Flags = NDArray[np.bool_]

FEWEST_POINTS = 64
"""Points along each side of a map that are needed at least: sixteen wavelengths of four points."""
_MOST_HOLES = 0.2


@dataclass(frozen=True, slots=True)
class HeightMap:
    """Heights over a rectangle.

    Attributes
    ----------
    heights : ndarray, shape (rows, columns)
        Heights about the fitted paraboloid [m]; interpolated in the holes.
    holes : ndarray of bool, shape (rows, columns)
        Where nothing had been measured.
    size : tuple of float
        Extent along the rows' and along the columns' index [m]: number of points times their distance.
    tilt : float
        Slope of the plane that was taken out [1].
    curvature : float
        Largest curvature, in magnitude, of the paraboloid that was taken out [1/m].
    rows_aligned : bool
        Whether rows have been shifted against each other.
    repeated : tuple of int
        Rows, and columns, that equal another one or have one height throughout.
    streaks : int
        Rows with a scar.
    """

    heights: Floats
    holes: Flags
    size: tuple[float, float]
    tilt: float
    curvature: float
    rows_aligned: bool = False
    repeated: tuple[int, int] = (0, 0)
    streaks: int = 0

    @property
    def spacing(self) -> float:
        """Distance of neighbouring points, the larger of both directions [m]."""
        return float(max(length / count for length, count in zip(self.size, self.heights.shape, strict=True)))

    @property
    def steepness(self) -> float:
        """Root mean square of the slopes from point to point, along the direction in which it is larger [1]."""
        steps = (np.sqrt(np.square(np.diff(self.heights, axis=axis)).mean()) for axis in (0, 1))
        spacings = (length / count for length, count in zip(self.size, self.heights.shape, strict=True))
        return float(max(step / spacing for step, spacing in zip(steps, spacings, strict=True)))

    @property
    def line_noise(self) -> tuple[float, float]:
        """Root mean square offsets of rows and of columns against each other [m]; 0 where there is no line noise."""
        return (0.0, 0.0) if self.rows_aligned else line_noise(self.heights, self.size)

    @property
    def hole_count(self) -> int:
        """Number of holes; points that touch at an edge belong to one."""
        return int(ndimage.label(self.holes)[1])

    @property
    def hole_share(self) -> float:
        """Share of the points at which nothing had been measured [1]."""
        return float(self.holes.mean())


def height_map(heights: Any, size: tuple[float, float], *, align_rows: bool = False) -> HeightMap:
    """Level a measured map and fill its holes.

    Parameters
    ----------
    heights : array_like, shape (rows, columns)
        Heights [m]; NaN, or masked, where there is none.
    size : tuple of float
        Extent along both indices [m].
    align_rows : bool, optional
        Whether to shift the rows so that the medians of their differences vanish.

    Returns
    -------
    HeightMap
        Without the paraboloid ``a + b x + c y + d x^2 + e x y + f y^2`` that fits the measured points best.

    Raises
    ------
    SceneError
        If the map has not two dimensions with at least `FEWEST_POINTS` points each, heights are infinite or all equal,
        or more than a fifth is missing.
    """
    measured = _read(heights)
    holes = np.isnan(measured)
    if holes.mean() > _MOST_HOLES:
        raise SceneError(
            "surface scan",
            f"({100 * holes.mean():.3g} % missing)",
            f"at most {100 * _MOST_HOLES:g} % of the points may be missing",
        )
    repeated = repeated_lines(measured), repeated_lines(measured.T)
    measured = aligned_rows(measured) if align_rows else measured
    shape, coefficients = _paraboloid(measured, holes)
    levelled = measured - shape
    spread = float(np.nanstd(levelled))
    if not spread > 1e-9 * float(np.nanmax(np.abs(measured))):
        raise SceneError("surface scan", "(flat)", "the heights lie on a paraboloid: there is no roughness")
    _, b, c, d, e, f = coefficients
    half = [length / 2 for length in size]
    slopes = (b / half[0], c / half[1])
    second = np.array(
        [
            [2 * d / half[0] ** 2, e / (half[0] * half[1])],
            [e / (half[0] * half[1]), 2 * f / half[1] ** 2],
        ]
    )
    largest = float(np.abs(np.linalg.eigvalsh(second)).max())
    filled, scars = _filled(levelled, holes), streaks(measured)
    return HeightMap(filled, holes, size, float(np.hypot(*slopes)), largest, align_rows, repeated, scars)


def _read(heights: Any) -> Floats:
    """Make an array of numbers, NaN where there is none."""
    try:
        measured = numbers_of(heights, "m")
    except (TypeError, ValueError) as error:
        raise SceneError("surface scan", "(heights)", f"must be an array of numbers: {error}") from None
    if measured.ndim != 2 or min(measured.shape) < FEWEST_POINTS:
        raise SceneError(
            "surface scan",
            f"(shape {measured.shape})",
            f"must have two dimensions with at least {FEWEST_POINTS} points each",
        )
    if np.isinf(measured).any():
        raise SceneError("surface scan", "inf", "heights must be finite, or NaN where there is none")
    return measured


def _paraboloid(measured: Floats, holes: Flags) -> tuple[Floats, Floats]:
    """Fit a paraboloid to the measured points, in coordinates -1..1; return it with its coefficients."""
    rows, columns = ((2 * np.arange(count) + 1) / count - 1 for count in measured.shape)
    y, x = np.meshgrid(rows, columns, indexing="ij")
    terms = np.stack([np.ones_like(x), y, x, y * y, x * y, x * x], axis=-1)
    known = ~holes
    fitted = np.linalg.lstsq(terms[known], measured[known], rcond=None)[0]
    return terms @ fitted, fitted


def _filled(levelled: Floats, holes: Flags) -> Floats:
    """Span a membrane over the holes: each missing height is the mean of its neighbours.

    At the edge of the map, points have fewer neighbours. The heights solve Laplace's equation, so that they stay
    between those around the hole.
    """
    if not holes.any():
        return levelled
    number = np.full(holes.shape, -1)
    number[holes] = np.arange(holes.sum())
    filled = np.where(holes, 0.0, levelled)
    padded_number = np.pad(number, 1, constant_values=-2)  # -2: outside, -1: measured
    padded_height = np.pad(filled, 1)
    points = np.argwhere(holes) + 1
    diagonal = np.zeros(len(points))
    right = np.zeros(len(points))
    row_indices = [np.arange(len(points))]
    others = [np.arange(len(points))]
    entries: list[Floats] = []
    for step in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        rows, columns = (points + step).T
        neighbour = padded_number[rows, columns]
        diagonal += neighbour != -2
        right += np.where(neighbour == -1, padded_height[rows, columns], 0.0)
        missing = np.flatnonzero(neighbour >= 0)
        row_indices.append(missing)
        others.append(neighbour[missing])
        entries.append(-np.ones(len(missing)))
    matrix = sparse.csc_matrix(
        (np.concatenate([diagonal, *entries]), (np.concatenate(row_indices), np.concatenate(others)))
    )
    filled[holes] = linalg.spsolve(matrix, right)
    return filled
