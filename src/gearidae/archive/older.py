"""Archives of older versions, brought to what this version writes."""

from __future__ import annotations

import json
from typing import Any

import xarray as xr

from gearidae.archive.pieces import reached
from gearidae.archive.variables import ENERGY_BALANCE, OF_SWEPT_RUN
from gearidae.records.energy import TERMS


def converted(ds: xr.Dataset) -> xr.Dataset:
    """Put the energy balance of a single run, JSON in an attribute up to version 0.2.0, into variables.

    A loss that the version did not know is 0, also in a sweep. The run summary, another attribute, follows from
    the rest.

    Parameters
    ----------
    ds : xarray.Dataset
        As read from a file of any version.
    """
    ds.attrs.pop("account", None)
    kept: dict[str, Any] = json.loads(ds.attrs.pop("energy_balance", "{}"))
    if "swept" not in ds.attrs and "reached" not in ds:
        samples = reached(ds["time"])
        last = float(ds["time"][samples - 1]) if samples else float(ds.attrs["t_end"])
        ds["reached"] = ((), float(kept.get("time", last)), OF_SWEPT_RUN["reached"].attributes)
    later = {name for name, each in TERMS.items() if each.since}
    for name in ENERGY_BALANCE if kept else ():
        ds[name] = ((), float(kept.get(name, 0.0) if name in later else kept[name]), _attributes(name))
    if all(name in ds for name in ENERGY_BALANCE if name not in later):
        for name in later - set(map(str, ds.variables)):
            ds[name] = (ds["residual"].dims, 0.0 * ds["residual"].values, _attributes(name))
    return ds


def _attributes(name: str) -> dict[str, Any]:
    return ENERGY_BALANCE[name].attributes
