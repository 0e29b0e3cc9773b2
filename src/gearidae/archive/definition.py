"""The definitions of an archive without its data: the same variables and attributes at whatever length.

xarray decides how a dataset is put into a file (names, attributes, coordinates, fill values); it is asked once, with
a dataset of no length, and its answer is repeated at the length wanted.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr

from gearidae.archive.library import LIBRARY, await_lock, opened, uninterrupted

__all__ = ["CHUNK", "chunked", "define", "offsets"]

_COMPRESSED_ABOVE = 2**16
"""Variables larger than this [bytes] are compressed if that pays, and of a sweep have chunks for each run."""
CHUNK = 2**20
"""Largest chunk [bytes]."""


@uninterrupted()
def define(
    template: xr.Dataset,
    path: Path,
    sizes: Mapping[str, int],
    extra: Mapping[str, tuple[str, ...]] | None = None,
) -> None:
    """Create a netCDF4 file that holds a dataset's definitions at other lengths.

    Parameters
    ----------
    template : xarray.Dataset
        A dataset in which the dimensions in `sizes` have length 0.
    path : Path
        File to create.
    sizes : mapping of str to int
        Lengths of the dimensions.
    extra : mapping of str to tuple of str, optional
        Further float64 and (those without dimensions) int64 variables, by name, with their dimensions. If given,
        nothing is chunked or compressed, and every variable's place is taken up and filled.
    """
    with tempfile.TemporaryDirectory() as folder:
        sample = Path(folder) / "template.nc"
        template.drop_encoding().to_netcdf(
            sample, engine="netcdf4", encoding={name: {"_FillValue": None} for name in template.coords}
        )
        with opened(sample) as old, netCDF4.Dataset(path, "x", format="NETCDF4") as new:
            new.setncatts({name: old.getncattr(name) for name in old.ncattrs()})
            lengths = {name: len(dimension) for name, dimension in old.dimensions.items()} | dict(sizes)
            for name, size in lengths.items():
                new.createDimension(name, size)
            for name, variable in old.variables.items():
                attributes = {key: variable.getncattr(key) for key in variable.ncattrs()}
                fill = attributes.pop("_FillValue", None)
                shape = tuple(lengths[dim] for dim in variable.dimensions)
                storage: dict[str, Any] = {}
                if extra is not None:
                    storage = {"contiguous": all(shape)}  # a length of 0 is one without limit to netCDF
                elif variable.dtype is not str:
                    nbytes = variable.dtype.itemsize * int(np.prod(shape))
                    storage = chunked(name, variable.dtype, shape, nbytes)
                made = new.createVariable(
                    name, variable.dtype, variable.dimensions, fill_value=fill, **storage
                )
                made.setncatts(attributes)
                if not set(variable.dimensions) & set(sizes):  # it is all there
                    made[...] = variable[...]
            for name, dims in (extra or {}).items():
                new.createVariable(name, "f8" if dims else "i8", dims, contiguous=True)
                new[name].setncatts({"long_name": name.replace("_", " "), "units": "1"})
            if extra is not None:
                for made in new.variables.values():
                    _claim(made)


def chunked(name: str, dtype: np.dtype[Any], shape: tuple[int, ...], nbytes: int) -> dict[str, Any]:
    """How to store a variable: in chunks with a checksum each (Fletcher-32), large ones compressed where it pays.

    Counts and flags shrink to a hundredth at half the speed of plain writing; samples of motion, whose last
    digits are noise, to two thirds at a twentieth, so they are left as they are. HDF5 has no checksum for single
    numbers and for texts of varying length, which are stored plainly.
    """
    if dtype.kind not in "fi" or not nbytes or not shape:
        return {}
    pieces = -(-shape[-1] * dtype.itemsize // CHUNK)
    # the runs of a sweep are chunks of their own where they are long
    runs = shape[:-1] if nbytes <= _COMPRESSED_ABOVE else (1,) * (len(shape) - 1)
    storage: dict[str, Any] = {"fletcher32": True, "chunksizes": (*runs, -(-shape[-1] // pieces))}
    if nbytes > _COMPRESSED_ABOVE and (dtype.kind == "i" or name == "pairs_in_contact"):
        storage |= {"zlib": True, "complevel": 1, "shuffle": True}
    return storage


def offsets(path: Path) -> dict[str, int]:
    """Where in the file the data of every variable begin [bytes]; all must be contiguous and have been claimed."""
    found: dict[str, int] = {}
    with LIBRARY:
        import h5py  # starts a process, which must not inherit a file that another thread is writing

        await_lock(path)
        with h5py.File(path, "r") as file:
            for name, variable in file.items():
                place = variable.id.get_offset()
                if place is not None:  # a dimension without a variable has no data
                    found[name] = int(place)
    return found


def _claim(variable: Any) -> None:
    """Have the file's space for a variable allocated, and filled with what stands for nothing."""
    if variable.dimensions:
        first = (slice(0, 1),) * len(variable.dimensions)
        if variable.size:
            variable[first] = variable[first]
    elif np.ma.is_masked(variable[...]):
        variable[...] = 0
