"""What to know before trusting the numbers of a measured surface."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearidae.scene.prefixes import with_prefix

if TYPE_CHECKING:
    import xarray as xr

_BANDWIDTHS = (1.50, 1.75, 2.70, 9.44)
_GAUSSIAN_SKEWNESS = (0.49, 0.27, 0.09, -0.02)
_GAUSSIAN_KURTOSIS = (0.22, 0.08, 0.06, 0.03)
"""Skewness and excess kurtosis of the summit heights of Gaussian surfaces against the bandwidth parameter, from 15,000
to 57,000 summits of synthetic ones each. Where all waves are about as long, low summits are rare and the distribution
leans."""
_SKEWED = 0.3
_PEAKED = 0.6
"""Differences from those that are named."""
_STANDARD_ERRORS = 3.0
_FEW = 200  # summits: 5 % standard error of the rms height
_DIRECTED = 1.3
_DISAGREEING = 0.25
_OBLONG = 1.01


def remarks(ds: xr.Dataset, cutoff: float | None) -> tuple[str, ...]:
    """Say what is particular about a measured surface.

    Parameters
    ----------
    ds : Dataset
        From `gearidae.surfaces.statistics.statistics`.
    cutoff : float or None
        Chosen cut-off wavelength [m]; without one, only what does not depend on it.

    Returns
    -------
    tuple of str
        Sentences.
    """
    said = []
    if holes := ds.attrs["holes"]:
        share = 100.0 * ds.attrs["hole_share"]
        many = "1 hole" if holes == 1 else f"{holes} holes"
        said.append(f"{many} ({share:.2g} % of the points) filled by interpolation and not counted.")
    between_rows, along_rows = np.divide(ds.attrs["size"], ds.attrs["points"])
    if not 1.0 / _OBLONG < between_rows / along_rows < _OBLONG:
        between, along = with_prefix(between_rows, "m"), with_prefix(along_rows, "m")
        said.append(
            f"Rows are {between} apart, points along them {along}: if rows are missing, as of a scan that was stopped, "
            "give the extent of those that are there (size, --size)."
        )
    counted = zip(("rows", "columns"), ds.attrs["repeated_lines"], ds.attrs["points"], strict=True)
    said += [
        f"{count} of {points} {lines} equal another one, or have one height throughout, as where a scan has stopped: "
        "density and radius are wrong; leave them out."
        for lines, count, points in counted
        if count
    ]
    if streaks := ds.attrs["streaks"]:
        said.append(
            f"{streaks} of {ds.attrs['points'][0]} rows have a streak that differs from the rows on both sides, as "
            "scars of a scan do: the tips are too sharp; repair or leave them out."
        )
    for lines, noise in zip(("rows", "columns"), ds.attrs["line_noise"], strict=True):
        if noise:
            remedy = (
                "align_rows, --align-rows" if lines == "rows" else "of the transposed map with align_rows"
            )
            said.append(
                f"Line noise: {lines} are offset against each other by {with_prefix(noise, 'm')} rms, which makes "
                f"summits and slopes that the surface has not; align them ({remedy})."
            )
    if cutoff is not None:
        at = ds.sel(cutoff=cutoff)
        said += [*_shape(at), *_sampling(at)]
    return tuple(said)


def _shape(at: xr.Dataset) -> list[str]:
    """Name heights that are not Gaussian, and directions that are not alike."""
    count, skewness, kurtosis, bandwidth = (
        float(at[name]) for name in ("summit_count", "summit_skewness", "summit_kurtosis", "bandwidth")
    )
    said = []
    leaning = abs(skewness - np.interp(bandwidth, _BANDWIDTHS, _GAUSSIAN_SKEWNESS))
    tailed = abs(kurtosis - np.interp(bandwidth, _BANDWIDTHS, _GAUSSIAN_KURTOSIS))
    # standard errors of both for a sample of a normal distribution; NaN, for too few summits, exceeds nothing
    error = np.sqrt(6.0 / max(count, 1.0))
    if leaning > max(_SKEWED, _STANDARD_ERRORS * error) or tailed > max(
        _PEAKED, 2 * _STANDARD_ERRORS * error
    ):
        said.append(
            f"The summit heights are not Gaussian, as the contact model takes them to be: skewness {skewness:.2f}, "
            f"excess kurtosis {kurtosis:.2f}."
        )
    if float(at["anisotropy"]) > _DIRECTED:
        said.append(
            f"The surface has a direction: slopes along one are {float(at['anisotropy']):.2f} times those across; "
            "the moments are taken as if there were none."
        )
    return said


def _sampling(at: xr.Dataset) -> list[str]:
    """Name numbers that rest on few summits, and ways to them that disagree."""
    count = int(at["summit_count"])
    said = []
    if count < _FEW:
        error = 100.0 / np.sqrt(2.0 * max(count, 1))
        said.append(f"Only {count} summits: the roughness has a standard error of {error:.0f} % or more.")
    names = ("roughness", "asperity_density", "asperity_radius")
    ratios = {name: float(at[name].sel(by="summits") / at[name].sel(by="moments")) for name in names}
    apart = [
        f"{name} {ratio:.2f} times" for name, ratio in ratios.items() if abs(np.log(ratio)) > _DISAGREEING
    ]
    if apart:
        said.append(f"Summits and moments disagree: {', '.join(apart)} as large by summits as by moments.")
    return said
