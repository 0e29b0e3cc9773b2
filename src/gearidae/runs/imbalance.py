"""What is said of a run whose energy balance does not close: a wrong run must not look like any other."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np

from gearidae.archive.totals import imbalance_of

if TYPE_CHECKING:
    import xarray as xr

log = logging.getLogger(__name__)


def log_imbalance(ds: xr.Dataset) -> None:
    """Log a warning if the residual of an energy balance is beyond its bound.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run, or a sweep, whose members get one warning together.
    """
    if "residual" not in ds.variables or "residual_bound" not in ds.variables:
        return
    if not ds.variables["residual"].dims:
        out_by = imbalance_of(ds)
        if out_by > 1.0:
            log.warning(
                "the energy balance of this run is out by %.2g times its bound: "
                "do not rely on it; if a smaller run.rtol does not bring it within, report the scene",
                out_by,
            )
        return
    out = np.abs(ds["residual"].values) > ds["residual_bound"].values
    if out.any():
        log.warning(
            "the energy balance of %d of %d runs is out of its bound: "
            "do not rely on them; if a smaller run.rtol does not bring them within, report the scene",
            out.sum(),
            out.size,
        )
