"""The numbers of a rough surface against the cut-off wavelength, as a dataset."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy import ndimage, stats

from gearidae.errors import SceneError
from gearidae.surfaces.filtering import Field, band_limited, cosine_sum, grid_points
from gearidae.surfaces.height_map import HeightMap
from gearidae.surfaces.moments import Asperities, from_moments
from gearidae.surfaces.summits import find_summits

METHODS = ("summits", "moments")
"""Ways to the asperities: counted and measured one by one, or from the spectral moments of a Gaussian surface."""

_FEWEST_SUMMITS = 10
_WAVES_ALONG_SIDE = 8  # longest cut-off: a margin of one at each edge leaves six along the shorter side
_POINTS_OF_WAVE = 2  # shortest cut-off, in points of the map: below that nothing has been measured
_SHORTEST_USUAL = 4
_MOST_GRID_POINTS = 40_000_000
_USUAL_COUNT = 16

_VARIABLES = {
    "m0": ("m2", "variance of the heights"),
    "m2": ("1", "variance of the slopes of a profile"),
    "m4": ("m-2", "variance of the curvatures of a profile"),
    "rms_height": ("m", "rms height of the surface"),
    "rms_slope": ("1", "rms gradient of the surface"),
    "bandwidth": ("1", "bandwidth parameter alpha = m0 m4 / m2^2"),
    "summit_count": ("1", "summits found"),
    "summit_skewness": ("1", "skewness of the summit heights"),
    "summit_kurtosis": ("1", "excess kurtosis of the summit heights"),
    "anisotropy": ("1", "rms slope along its largest direction over that across"),
    "roughness": ("m", "rms height of the summits, sigma"),
    "asperity_density": ("m-2", "summits per area, N"),
    "asperity_radius": ("m", "mean tip radius, beta"),
    "summit_plane": ("m", "height of the summits' mean plane above that of the surface"),
}
_BY_METHOD = ("roughness", "asperity_density", "asperity_radius", "summit_plane")


def allowed_cutoffs(surface: HeightMap) -> tuple[float, float]:
    """Return the shortest and the longest cut-off wavelength for which a map has the points [m]."""
    longest = min(surface.size) / _WAVES_ALONG_SIDE
    return _POINTS_OF_WAVE * surface.spacing, longest


def usual_cutoffs(surface: HeightMap) -> NDArray[np.float64]:
    """Choose cut-off wavelengths evenly in their logarithm, from four points to an eighth of the map's side [m]."""
    shortest, longest = allowed_cutoffs(surface)
    first = max(shortest * _SHORTEST_USUAL / _POINTS_OF_WAVE, _finest(surface))
    return np.geomspace(first, longest, _USUAL_COUNT)


def statistics(surface: HeightMap, cutoffs: NDArray[np.float64]) -> xr.Dataset:
    """Analyse a map for several cut-off wavelengths.

    Parameters
    ----------
    cutoffs : ndarray, shape (n,)
        Shortest wavelengths that are kept [m].

    Returns
    -------
    Dataset, dims (by, cutoff)
        The moments, `METHODS` of getting asperities, and the shape of the distribution of the summit heights. All are
        taken at least one cut-off wavelength inside the edges, and half of one away from holes that are larger than a
        quarter of it.

    Raises
    ------
    SceneError
        If a cut-off is not within `allowed_cutoffs`, or so short that the grid would not fit into memory.
    """
    shortest, longest = allowed_cutoffs(surface)
    for cutoff in cutoffs:
        # a rounding error more or less is none of the user's
        if not shortest * (1 - 1e-9) <= cutoff <= longest * (1 + 1e-9):
            raise SceneError(
                "cutoff",
                f"{cutoff:.4g} m",
                f"must lie in {shortest:.4g}..{longest:.4g} m: two points of the map to an eighth of its side",
            )
        if np.prod(grid_points(surface.size, float(cutoff))) > _MOST_GRID_POINTS:
            raise SceneError(
                "cutoff",
                f"{cutoff:.4g} m",
                f"must be at least {_finest(surface):.4g} m for a map of this size",
            )
    amplitudes = cosine_sum(surface.heights)
    rows = [_analysed(surface, amplitudes, float(cutoff)) for cutoff in cutoffs]
    variables: dict[str, Any] = {}
    for name, (unit, words) in _VARIABLES.items():
        dims = ("by", "cutoff") if name in _BY_METHOD else ("cutoff",)
        values = np.array([row[name] for row in rows]).T
        variables[name] = (dims, values, {"units": unit, "long_name": words})
    wavelengths = xr.Variable("cutoff", cutoffs, {"units": "m", "long_name": "cut-off wavelength"})
    return xr.Dataset(
        variables,
        coords={"cutoff": wavelengths, "by": list(METHODS)},
        attrs={
            "points": list(surface.heights.shape),
            "size": list(surface.size),
            "holes": surface.hole_count,
            "hole_share": surface.hole_share,
            "tilt_removed": surface.tilt,
            "curvature_removed": surface.curvature,
            "rows_aligned": int(surface.rows_aligned),
            "line_noise": list(surface.line_noise),
            "repeated_lines": list(surface.repeated),
            "streaks": surface.streaks,
        },
    )


def asperities(surface: HeightMap, cutoff: float) -> xr.Dataset:
    """List the summits of a map for one cut-off wavelength.

    Parameters
    ----------
    cutoff : float
        Shortest wavelength that is kept [m], one that `statistics` allows.

    Returns
    -------
    Dataset, dims (asperity,)
        ``along`` and ``across``, the positions along the columns' and the rows' index from the edge of the area that is
        analysed, ``height`` above the summits' mean plane and ``radius`` [m], ordered along. The attributes ``length``
        and ``width`` are that area's [m].
    """
    field = band_limited(cosine_sum(surface.heights), surface.size, cutoff)
    wanted = _wanted(surface, field, cutoff)
    summits = find_summits(field, wanted)
    order = np.argsort(summits.positions[1], kind="stable")
    edges, sides = [], []
    for axis, step in enumerate(field.spacing):
        inside = np.flatnonzero(wanted.any(axis=1 - axis))
        edges.append((inside[0] - 0.5) * step)
        sides.append(float((inside[-1] + 1 - inside[0]) * step))
    columns = {
        "along": (summits.positions[1] - edges[1], "place along the columns' index"),
        "across": (summits.positions[0] - edges[0], "place along the rows' index"),
        "height": (summits.heights - summits.heights.mean(), "height above the summits' mean plane"),
        "radius": (1.0 / summits.curvatures, "radius of the tip"),
    }
    return xr.Dataset(
        {
            name: ("asperity", values[order], {"units": "m", "long_name": words})
            for name, (values, words) in columns.items()
        },
        attrs={"width": sides[0], "length": sides[1]},
    )


def _finest(surface: HeightMap) -> float:
    """Cut-off for which the grid has as many points as it may [m]; 1 % to spare, sides being rounded up."""
    area = surface.size[0] * surface.size[1]
    return float(1.01 * 8 * np.sqrt(area / _MOST_GRID_POINTS))


def _analysed(surface: HeightMap, amplitudes: NDArray[np.float64], cutoff: float) -> dict[str, Any]:
    """All numbers for one cut-off; those by summits are NaN where there are too few of them."""
    field = band_limited(amplitudes, surface.size, cutoff)
    wanted = _wanted(surface, field, cutoff)
    m0 = float(field.heights[wanted].var())
    along, across = (slope[wanted] for slope in field.slopes)
    tensor = np.array([[along @ along, along @ across], [along @ across, across @ across]]) / wanted.sum()
    low, high = np.linalg.eigvalsh(tensor)
    # of an isotropic surface, the mean square of the gradient is 2 m2, that of the Laplacian 8/3 m4
    m2 = 0.5 * float(low + high)
    m4 = 0.375 * float(np.square(field.curvature[wanted]).mean())
    summits = find_summits(field, wanted)
    count = len(summits.heights)
    enough = count >= _FEWEST_SUMMITS
    area = wanted.sum() * field.spacing[0] * field.spacing[1]
    mean = float(field.heights[wanted].mean())
    counted = (
        Asperities(
            float(summits.heights.std(ddof=1)),
            count / area,
            1.0 / float(summits.curvatures.mean()),
            float(summits.heights.mean()) - mean,
        )
        if enough
        else Asperities(np.nan, np.nan, np.nan, np.nan)
    )
    by_method = zip(counted, from_moments(m0, m2, m4), strict=True)
    return {
        "m0": m0,
        "m2": m2,
        "m4": m4,
        "rms_height": np.sqrt(m0),
        "rms_slope": np.sqrt(2.0 * m2),
        "bandwidth": m0 * m4 / m2**2,
        "summit_count": count,
        "summit_skewness": float(stats.skew(summits.heights, bias=False)) if enough else np.nan,
        "summit_kurtosis": float(stats.kurtosis(summits.heights, bias=False)) if enough else np.nan,
        "anisotropy": float(np.sqrt(high / low)) if low > 0.0 else np.inf,
        **dict(zip(_BY_METHOD, by_method, strict=True)),
    }


def _wanted(surface: HeightMap, field: Field, cutoff: float) -> NDArray[np.bool_]:
    """Points of the grid that tell: away from the edges and from what was filled."""
    inside = np.zeros(field.heights.shape, dtype=bool)
    margins = [int(np.ceil(cutoff / step)) for step in field.spacing]
    inside[margins[0] : -margins[0], margins[1] : -margins[1]] = True
    if surface.holes.any():
        steps = [length / count for length, count in zip(surface.size, surface.holes.shape, strict=True)]
        # what is narrower than a quarter of the shortest wave is interpolated well
        deep = ndimage.distance_transform_edt(surface.holes, sampling=steps) > cutoff / 8
        if deep.any():
            far = ndimage.distance_transform_edt(~deep, sampling=steps) > 5 * cutoff / 8
            indices = [
                np.minimum(((np.arange(count) + 0.5) * points / count).astype(int), points - 1)
                for count, points in zip(field.heights.shape, surface.holes.shape, strict=True)
            ]
            inside &= far[np.ix_(*indices)]
    if not inside.any():
        raise SceneError(
            "cutoff", f"{cutoff:.4g} m", "leaves nothing of the map between its edges and its holes"
        )
    return inside
