"""Read the life of a coating, or those of an ensemble, back."""

from __future__ import annotations

import os

import xarray as xr

from gearidae.errors import SceneError
from gearidae.studies.product_file import read_product

__all__ = ["open_life", "open_lives", "require_life", "require_lives"]

_NEEDED = ("coverage", "verdict", "mean_gear_speed", "min_gear_speed")
_OF_LIVES = ("passages_to_sticking", "passages_turning", "sticks", "ending", "status")


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


def open_lives(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read the lives of an ensemble that were saved.

    Parameters
    ----------
    path : path-like
        A netCDF file, from `lives` or ``gearidae lives``.

    Returns
    -------
    Dataset

    Raises
    ------
    SceneError
        If the file cannot be read or holds no lives.
    """
    return read_product(path, "lives", "ensemble of lives", "lives", require_lives)


def require_lives(ds: xr.Dataset) -> xr.Dataset:
    """Return a dataset that holds the lives of an ensemble.

    Raises
    ------
    SceneError
        If it holds none.
    """
    if not ds.sizes.get("member", 0) or any(
        name not in ds or ds[name].dims != ("member",) for name in _OF_LIVES
    ):
        raise SceneError("dataset", type(ds).__name__, "holds no lives; make them with gd.studies.lives")
    return ds
