"""What studies say of the gears of one design: means over seeds, and starting torques.

See `gearidae.studies.answers`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final, TypeAlias

import numpy as np
import xarray as xr

from gearidae.scene.prefixes import with_prefix

SLOW_ENOUGH: Final = 0.1
"""Change of the median by half the rate below which a rate is slow enough."""
Rows: TypeAlias = Iterator[tuple[str, str, str]]


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
