"""What studies say of the gears of one design: means over seeds, and starting torques.

See `gearidae.studies.answers`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final, TypeAlias

import numpy as np
import xarray as xr

from gearidae.archive.specimen import SEED
from gearidae.scene.prefixes import with_prefix

SLOW_ENOUGH: Final = 0.1
"""Change of the median by half the rate below which a rate is slow enough."""
Rows: TypeAlias = Iterator[tuple[str, str, str]]

FIGURES: Final = (
    "min_gear_speed",
    "max_gear_speed",
    "largest_mesh_force",
    "smallest_mesh_force",
    "stick_time",
)
_OF_GEARS: Final = ("settled_gear_speed", *FIGURES, "asperity_onsets")
"""Figures whose means over the seeds are given."""


def mean_rows(ds: xr.Dataset) -> Rows:
    """Means over the gears with their standard errors, and how far one gear is from them."""
    if "index_comment" in ds.attrs:
        left = 1.0 - float(ds["first_order"].sum())
        yield (
            SEED,
            "no index",
            f"{left:.3f} is no first order of a key: scatter between seeds, and interactions",
        )
    yield "Means over the seeds", "", "one gear is one specimen of the design"
    figures = {
        name.replace("_", " "): (ds[name].values, str(ds[name].attrs["units"]).replace("rad s-1", "rad/s"))
        for name in _OF_GEARS
        if name in ds
    }
    if {"adhesion_loss", "drive_work"} <= set(map(str, ds.data_vars)):
        with np.errstate(divide="ignore", invalid="ignore"):
            figures["adhesion loss over drive work"] = (
                ds["adhesion_loss"].values / ds["drive_work"].values,
                "1",
            )
    for name, (values, unit) in figures.items():
        found = values[np.isfinite(values)]
        if found.size > 1:
            spread = float(np.std(found, ddof=1))
            low, high = np.quantile(found, (0.05, 0.95))
            yield (
                name,
                _with_error(float(found.mean()), spread / math.sqrt(found.size), unit),
                f"standard deviation of one gear {spread:.2g}, 90 % between {low:.4g} and {high:.4g}",
            )


def _with_error(mean: float, error: float, unit: str) -> str:
    """Write a mean to the second digit of its standard error."""
    if not error > 0.0:
        return f"{mean:.6g}" + ("" if unit == "1" else f" {unit}")
    last = math.floor(math.log10(error))
    digits = max(2, math.floor(math.log10(abs(mean))) - last + 2) if mean else 2
    return f"{mean:.{digits}g} +- {error:.2g}" + ("" if unit == "1" else f" {unit}")


def starts_sentence(ds: xr.Dataset) -> str:
    """Say what the gears of the worst coverage need, and how many of them the drive starts."""
    worst = ds.isel(sam_fraction=int(np.argmin(ds["sam_fraction"].values)))
    count, coated = _followed(worst), f"SAM {100.0 * float(worst['sam_fraction']):.4g} %"
    middle = _torque(worst["quantiles"].sel(quantile=0.5), worst)
    sentence = f"{coated}: half of {count} gears of this design start at {middle} on the pinion"
    drive = float(ds.attrs.get("drive_torque", math.nan))
    if not drive > 0.0:
        return f"{sentence}."
    started = int(worst["starts"].sum())
    return f"{sentence}; the drive's own {with_prefix(drive, 'N m', 4)} starts {started} of them."


def starts_rows(ds: xr.Dataset) -> Rows:
    """Quantiles, gears that did not start, chance at the drive's own torque, and rate, at each coverage."""
    drive = float(ds.attrs.get("drive_torque", math.nan))
    for number in range(ds.sizes["sam_fraction"]):
        one = ds.isel(sam_fraction=number)
        count = _followed(one)
        yield f"Starting torque of {count} gears, SAM {100.0 * float(one['sam_fraction']):.4g} %", "", ""
        for share in one["quantile"].values.tolist():
            below = f"{100.0 * share:.0f} % of the gears start below"
            yield below, _torque(one["quantiles"].sel(quantile=share), one), ""
        if failed := one.sizes["seed"] - count:
            yield "left out", f"{failed} of {one.sizes['seed']}", "their runs could not be finished"
        rests = round(float(one["not_started"]) * count)
        yield "not started", f"{rests} of {count}", f"when the ramp ended at {_torque(one['ramp_end'], one)}"
        if drive > 0.0:
            started = int(one["starts"].sum())
            own = f"turn one pitch at the drive's own {with_prefix(drive, 'N m', 4)}, there at once"
            yield "chance of starting", f"{started / count:.3g}", f"{started} of {count} {own}"
        change = float(one["median_change"])
        words = f"twice this rate changes the median by {100.0 * change:.2g} %"
        words += "" if change < SLOW_ENOUGH else ": not slow enough to rely on it"
        yield "rate of the torque", f"{with_prefix(1e-3 * float(one['rate']), 'N m', 3)} per ms", words
        yield (
            "damping of the mesh",
            f"{float(one['damping']):.3g} N s/m",
            "at least 3 % of critical in this study",
        )


def _followed(one: xr.Dataset) -> int:
    """Gears whose runs could be finished."""
    return one.sizes["seed"] - (int(one["failed"].sum()) if "failed" in one else 0)


def _torque(value: xr.DataArray, one: xr.Dataset) -> str:
    if np.isfinite(value):
        return with_prefix(float(value), "N m", 3)
    return f"more than {with_prefix(float(one['ramp_end']), 'N m', 3)}"
