"""Read what a study has written, other than runs: a coating map, the life of a coating."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import xarray as xr

from gearidae.archive.library import loaded
from gearidae.errors import SceneError

__all__ = ["read_product"]

_HEADERS = (b"\x89HDF\r\n\x1a\n", b"CDF")
"""How netCDF files begin, those of version 4 and the older ones."""


def read_product(
    path: str | os.PathLike[str],
    name: str,
    what: str,
    command: str,
    check: Callable[[xr.Dataset], xr.Dataset],
) -> xr.Dataset:
    """Read a file and make sure of what it is.

    Parameters
    ----------
    path : path-like
        A netCDF file.
    name, what : str
        How errors call the file, and what it should be.
    command : str
        Which makes one.
    check : callable
        Returns the dataset, or raises a SceneError if it is not what it should be.

    Returns
    -------
    Dataset

    Raises
    ------
    SceneError
        If the file cannot be read or is something else.
    """
    source = Path(path)
    if not source.is_file():
        raise SceneError(name, path, "there is no such file")
    try:
        with source.open("rb") as file:
            head = file.read(8)
    except OSError as error:
        raise SceneError(name, path, f"cannot be read ({error.strerror})") from error
    if not head.startswith(_HEADERS):
        raise SceneError(name, path, f"is no {what} but another kind of file; make one with {command}")
    try:
        found = loaded(source)
    except Exception as error:
        raise SceneError(name, path, f"is damaged ({error})") from error
    try:
        return check(found)
    except SceneError as error:
        raise SceneError(name, path, error.allowed) from None
