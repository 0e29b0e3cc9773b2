"""What tells damage in an archive: which variable it is in, and that it is never read as data.

Numbers along a dimension carry HDF5's Fletcher-32, piece by piece; names, attributes and the structure lie in object
headers that carry a checksum of their own. HDF5 has none for single numbers and for texts of varying length: theirs
are in the file's attribute ``checksums``.
"""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Hashable
from typing import Any

import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.backends.netCDF4_ import NetCDF4ArrayWrapper
from xarray.core.indexing import ExplicitIndexer, LazilyIndexedArray

from gearidae.errors import SceneError

__all__ = ["CHECKSUMS", "CheckedStore", "verify", "with_checksums"]

CHECKSUMS = "checksums"
"""Attribute of the file, not of the dataset that is read from it."""


class CheckedStore(xr.backends.NetCDF4DataStore):
    """A netCDF4 file whose variables, whenever they are read, say which of them cannot be."""

    def open_store_variable(self, name: str, var: Any) -> xr.Variable:
        """Describe a variable; its values are read when they are used."""
        variable: xr.Variable = super().open_store_variable(name, var)
        stored = NetCDF4ArrayWrapper(name, self)  # type: ignore[no-untyped-call]
        values = LazilyIndexedArray(_Checked(stored, name, self._filename))
        return xr.Variable(variable.dims, values, variable.attrs, variable.encoding)


class _Checked(BackendArray):
    """Values of one variable in a file."""

    def __init__(self, values: NetCDF4ArrayWrapper, name: str, path: str) -> None:
        self._values, self._name, self._path = values, name, path
        self.shape, self.dtype = values.shape, values.dtype

    def __getitem__(self, key: ExplicitIndexer) -> Any:
        try:
            return self._values[key]
        except (RuntimeError, OSError, ValueError, MemoryError) as error:
            # netCDF4 has one kind of error for a wrong checksum, an unknown filter and a missing piece
            raise _damaged(self._path, self._name, f"cannot be read ({error})") from error


def with_checksums(ds: xr.Dataset) -> xr.Dataset:
    """Add the attribute `CHECKSUMS` to a dataset that is to be written."""
    sums = {str(name): _checksum(ds[name]) for name in ds.variables if _needs(ds[name])}
    return ds.assign_attrs({CHECKSUMS: json.dumps(sums)}) if sums else ds


def verify(ds: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Compare the variables that HDF5 has no checksum for with the attribute `CHECKSUMS`, and take that away.

    Raises
    ------
    SceneError
        If one of them is not what was written; it is named.
    ValueError, TypeError, AttributeError
        If the attribute is not what `with_checksums` wrote.
    """
    for name, found in json.loads(ds.attrs.pop(CHECKSUMS, "{}")).items():
        if name in ds.variables and _checksum(ds[name]) != found:
            raise _damaged(path, name, "is not what was written")


def _needs(array: xr.DataArray) -> bool:
    return bool(array.size) and (not array.dims or array.dtype.kind not in "fiu")


def _checksum(array: xr.DataArray) -> str:
    values = array.values
    if values.dtype.kind in "fiu":
        content = np.ascontiguousarray(values.astype(values.dtype.newbyteorder("<"))).tobytes()
    else:
        content = json.dumps(values.tolist()).encode()
    return f"{zlib.crc32(content):08x}"


def _damaged(path: str | os.PathLike[str], name: Hashable, how: str) -> SceneError:
    return SceneError("archive", path, f"is damaged: its variable {name} {how}")
