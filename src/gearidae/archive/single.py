"""One run taken out of a sweep: the dataset that it would have been by itself."""

from __future__ import annotations

from typing import Any

import xarray as xr

from gearidae.archive.provenance import provenance, surface_regimes
from gearidae.archive.rows import DIMS, LABELS, own_rows
from gearidae.archive.select import run_scene, swept_dims
from gearidae.archive.variables import OF_SWEPT_RUN, RUN, SAM_FRACTION


def single_run(ds: xr.Dataset) -> xr.Dataset:
    """Make the dataset of a single run of one that was picked from a sweep.

    Parameters
    ----------
    ds : xarray.Dataset
        With one run: picked by ``sel`` or ``isel``, or a single run, which is returned as it is.

    Returns
    -------
    xarray.Dataset
        With the scene, the statistics, the events and the passages of that run alone, where `gearidae.simulate`
        puts them.

    Raises
    ------
    SceneError
        If there are several runs, or their scene is not known.
    """
    if "swept" not in ds.attrs:
        return ds
    scene = run_scene(ds)
    ds = own_rows(ds.squeeze(swept_dims(ds)))
    found: dict[str, Any] = {name: ds[name].values.item() for name in (*RUN, *OF_SWEPT_RUN) if name in ds}
    found.pop("reached", None)
    swept = [str(name) for name in ds.coords if name not in (*LABELS, "sam_fraction")]
    gone = {*found, *swept, *(f"{dim}_{name}" for dim in DIMS for name in swept)}
    single = ds.drop_vars([name for name in gone if name in ds.variables])
    single["sam_fraction"] = ((), scene.coating.sam_fraction, SAM_FRACTION.attributes)
    of_sweep = ("history", "source", "date_created", "product_version", "backend", "method", "keep")
    single.attrs = {
        **provenance(scene, ""),
        **{name: ds.attrs[name] for name in of_sweep if name in ds.attrs},
        **found,
        **surface_regimes(scene),
    }
    return single
