"""The outcomes of runs that have left behind their verdict, and perhaps little else."""

from __future__ import annotations

import math
from itertools import product
from typing import Any

import xarray as xr

from gearidae.archive.energy import imbalance
from gearidae.archive.select import is_roller, swept_dims

__all__ = ["kept_fields"]


def kept_fields(ds: xr.Dataset) -> list[dict[str, Any]]:
    """List what an outcome consists of, for each run of a dataset that has a variable ``verdict``.

    Parameters
    ----------
    ds : xarray.Dataset
        A sweep made with ``keep``, or a selection from it.

    Returns
    -------
    list of dict
        The fields of `gearidae.analysis.verdict.GearOutcome`, or of `RollerOutcome`; NaN and 0 where the numbers have
        not been kept.
    """
    dims = swept_dims(ds)
    labels = [
        dict(zip(dims, values, strict=True)) for values in product(*(ds[dim].values.tolist() for dim in dims))
    ]
    columns = {name: ds[name].values.ravel().tolist() for name in _NAMES if name in ds}
    roller = is_roller(ds)
    names = _ROLLER if roller else _GEAR
    found = []
    for number, label in enumerate(labels):
        row = {name: values[number] for name, values in columns.items()}
        fields: dict[str, Any] = {field: row.get(name, missing) for field, (name, missing) in names.items()}
        if roller:
            # NaN first, which max leaves where it is
            fields["peak_force"] = max(fields["peak_force"], 0.0)
            fields["pull_off_force"] = max(-fields["pull_off_force"], 0.0)
            fields["restitution"] = math.nan
        else:
            fields["window"] = float(ds.attrs["t_end"])
        fields["imbalance"] = imbalance(row.get("residual", math.nan), row.get("residual_bound", math.nan))
        found.append({"label": label, **fields})
    return found


_BOTH = {
    "status": ("status", ""),
    "verdict": ("verdict", ""),
    "impacts": ("impacts", 0),
    "wall_time": ("wall_time", math.nan),
}
_GEAR = _BOTH | {
    "min_speed": ("min_gear_speed", math.nan),
    "max_speed": ("max_gear_speed", math.nan),
    "stick_time": ("stick_time", math.nan),
    "mesh_exits": ("stick_exits", 0),
}
_ROLLER = _BOTH | {
    "peak_force": ("largest_mesh_force", math.nan),
    "pull_off_force": ("smallest_mesh_force", math.nan),
}
_NAMES = {name for name, _ in (*_GEAR.values(), *_ROLLER.values())} | {"residual", "residual_bound"}
