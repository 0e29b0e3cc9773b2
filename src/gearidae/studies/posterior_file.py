"""Read the posterior of a calibration back."""

from __future__ import annotations

import json
import os

import xarray as xr

from gearidae.archive.dataset import dimension_names
from gearidae.errors import SceneError
from gearidae.studies.product_file import read_product

__all__ = ["calibrated_keys", "open_posterior", "require_posterior"]


def open_posterior(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read a posterior that was saved.

    Parameters
    ----------
    path : path-like
        A netCDF file, from `calibrate` or ``gearidae calibrate``.

    Returns
    -------
    Dataset

    Raises
    ------
    SceneError
        If the file cannot be read or is no posterior.
    """
    return read_product(path, "posterior", "posterior", "gearidae calibrate", require_posterior)


def require_posterior(ds: xr.Dataset) -> xr.Dataset:
    """Return a dataset that is a posterior.

    Raises
    ------
    SceneError
        If it is none.
    """
    calibrated_keys(ds)
    return ds


def calibrated_keys(posterior: xr.Dataset) -> tuple[str, ...]:
    """Return the keys that a posterior is about.

    Raises
    ------
    SceneError
        If the dataset is no posterior.
    """
    try:
        keys = tuple(map(str, json.loads(posterior.attrs["calibration"])["priors"]))
        names = dimension_names(keys).values()
        whole = bool(keys) and all(name in posterior.variables for name in names)
        if whole and ("weight" in posterior or "draw" in posterior.dims):
            return keys
    except (AttributeError, KeyError, TypeError, ValueError):
        pass
    raise SceneError("posterior", type(posterior).__name__, "must be a posterior, from studies.calibrate")
