"""Reading a file whose damage its own checksums show: which variable it is in, in one line.

Numbers along a dimension carry HDF5's Fletcher-32, piece by piece; the file's structure has checksums of its own.
"""

from __future__ import annotations

from typing import Any

import xarray as xr
from xarray.backends import BackendArray
from xarray.backends.netCDF4_ import NetCDF4ArrayWrapper
from xarray.core.indexing import ExplicitIndexer, LazilyIndexedArray

from gearidae.errors import SceneError


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
            damage = f"is damaged: its variable {self._name} cannot be read ({error})"
            raise SceneError("archive", self._path, damage) from error
