"""The life of a coating: coverage, speed and ring frequency over passages, and coverage along the flank."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearidae.drawing.style import new_axes
from gearidae.errors import SceneError

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


def life(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw coverage against passages, with the end of the life and the frequency that a speed sensor sees.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.life`; of `gearidae.studies.assess_life` what the signals say is drawn too, with its 95 %
        interval.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        The frequency is on a second axis, at the right.

    Raises
    ------
    SceneError
        If the dataset is no life.
    """
    _require(ds, "coverage")
    ax = new_axes(ax, height=3.8)
    passages = ds["passages"].values
    if "assessed_coverage" in ds:
        _draw_assessed(ds, ax)
    for side in ds["side"].values:
        share = 100.0 * ds["coverage"].sel(side=side).values
        ax.plot(passages, share, marker=".", label=f"coverage, {side}")
    if ds.attrs.get("ending") == "sticks":
        ax.axvspan(
            passages[-1], float(ds.attrs["passages_to_sticking"]), color="0.6", alpha=0.5, label="sticks"
        )
    ax.set_xlabel("passages of each tooth of the pinion")
    ax.set_ylabel("coverage [%]")
    ax.set_ylim(0.0, 105.0)
    if "characteristic_frequency" in ds:
        right = ax.twinx()
        frequency = 1e-3 * ds["characteristic_frequency"].values
        right.plot(
            passages, frequency, color="C1", marker=".", linestyle="--", label="characteristic frequency"
        )
        right.set_ylabel("characteristic frequency [kHz]")
        lines, labels = (
            a + b
            for a, b in zip(ax.get_legend_handles_labels(), right.get_legend_handles_labels(), strict=True)
        )
        right.legend(lines, labels, loc="center left", frameon=False)
    else:
        ax.legend(loc="lower left", frameon=False)
    return ax


def _draw_assessed(ds: xr.Dataset, ax: Axes) -> None:
    """Draw what signals along the life say, where they can tell."""
    passages, shares = ds["passages"].values, 100.0 * ds["assessed_coverage"].values
    below, above = 100.0 * ds["assessed_low"].values, 100.0 * ds["assessed_high"].values
    assessed = np.isfinite(shares)
    spread = [shares[assessed] - below[assessed], above[assessed] - shares[assessed]]
    ax.errorbar(
        passages[assessed],
        shares[assessed],
        yerr=spread,
        label="by the speed signal, 95 %",
        fmt="o",
        color="C2",
        markersize=4.0,
        capsize=2.5,
    )


def coverage_along_flank(ds: xr.Dataset, ax: Axes | None = None, *, tooth: int | None = None) -> Axes:
    """Draw the coverage along the flank over passages.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.life` with ``resolved="place"`` or ``"tooth"``.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.
    tooth : int, optional
        Tooth of the pinion; by default the mean of all.

    Returns
    -------
    Axes
        A line for each of up to six steps of the life, from light to dark.

    Raises
    ------
    SceneError
        If the dataset is no such life, or has no such tooth.
    """
    _require(ds, "coverage_by_place")
    found = ds["coverage_by_place"].isel(side=0)
    if tooth is not None and tooth not in found["tooth"].values:
        raise SceneError("tooth", tooth, f"must lie in 0..{found.sizes['tooth'] - 1}")
    found = found.mean("tooth") if tooth is None else found.sel(tooth=tooth)
    ax = new_axes(ax, height=3.8)
    chosen = np.unique(np.linspace(0, found.sizes["passages"] - 1, 6).round().astype(int))
    for rank, number in enumerate(chosen):
        one = found.isel(passages=int(number))
        shade = str(0.75 * (1.0 - rank / max(len(chosen) - 1, 1)))
        ax.plot(
            1e6 * found["place"].values,
            100.0 * one.values,
            color=shade,
            marker=".",
            label=f"{float(one['passages']):.3g} passages",
        )
    ax.set_xlabel("place along the path of contact [µm]")
    ax.set_ylabel("coverage [%]")
    ax.legend(frameon=False)
    return ax


def _require(ds: xr.Dataset, name: str) -> None:
    if "passages" not in ds.dims or name not in ds:
        raise SceneError(
            "dataset", type(ds).__name__, f"must be a life with {name}, from gearidae.studies.life"
        )
