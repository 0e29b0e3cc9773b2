"""Read the life of a coating back."""

from __future__ import annotations

import os

import xarray as xr

from gearidae.errors import SceneError
from gearidae.studies.product_file import read_product

__all__ = ["open_life", "require_life"]

_NEEDED = ("coverage", "verdict", "mean_gear_speed", "min_gear_speed")


def open_life(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read the life of a coating that was saved.

    Parameters
    ----------
    path : path-like
        A netCDF file, from `life` or ``gearidae life``.

    Returns
    -------
    Dataset

    Raises
    ------
    SceneError
        If the file cannot be read or is no life.
    """
    return read_product(path, "life", "life of a coating", "life", require_life)


def require_life(ds: xr.Dataset) -> xr.Dataset:
    """Return a dataset that is the life of a coating.

    Raises
    ------
    SceneError
        If it is none.
    """
    whole = ds.sizes.get("passages", 0) > 0 and "side" in ds.coords
    if not whole or any(name not in ds or ds[name].dims[:1] != ("passages",) for name in _NEEDED):
        raise SceneError(
            "dataset", type(ds).__name__, "is no life of a coating; make one with gd.studies.life"
        )
    return ds
