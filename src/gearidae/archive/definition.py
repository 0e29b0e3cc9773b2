"""The definitions of an archive without its data: the same variables and attributes at whatever length.

xarray decides how a dataset is put into a file (names, attributes, coordinates, fill values); it is asked once, with
a dataset of no length, and its answer is repeated at the length wanted.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from gearidae.archive.library import Form, opened, uninterrupted

_COMPRESSED_FROM = 2**12
"""Variables of this size [bytes] are compressed: a block of the disk, below which nothing is won."""
_OWN_CHUNKS_ABOVE = 2**16
"""Variables of a sweep that are larger than this [bytes] have chunks for each run."""
CHUNK = 2**20
"""Largest chunk [bytes]."""
_ROOM = "room"
_HEADER = 2**17
"""Bytes left for the header of a file in the classic format: where it outgrows its place, all data are moved."""


@uninterrupted()
def define(
    template: xr.Dataset,
    path: Path,
    sizes: Mapping[str, int],
    *,
    in_place: bool = False,
    compress: bool = True,
) -> None:
    """Create a netCDF file that holds a dataset's definitions at other lengths.

    Parameters
    ----------
    template : xarray.Dataset
        A dataset in which the dimensions in `sizes` have length 0.
    path : Path
        File to create.
    sizes : mapping of str to int
        Lengths of the dimensions.
    in_place : bool, optional
        Whether the file is written while others read it: in netCDF's classic format (CDF-5), whose structure is its
        beginning and never changes, and filled with what stands for nothing. By default netCDF4, in chunks.
    compress : bool, optional
        Whether large variables of a netCDF4 file are compressed.
    """
    with tempfile.TemporaryDirectory() as folder:
        sample = Path(folder) / "template.nc"
        encoding = {name: text_storage(values) for name, values in template.variables.items()}
        for name in template.coords:
            encoding[name]["_FillValue"] = None
        template.drop_encoding().to_netcdf(sample, engine="netcdf4", encoding=encoding)
        form: Form = "NETCDF3_64BIT_DATA" if in_place else "NETCDF4"
        with opened(sample) as old, opened(path, "x", form) as new:
            old.set_auto_chartostring(False)
            new.set_auto_chartostring(False)
            lengths = {name: len(dimension) for name, dimension in old.dimensions.items()} | dict(sizes)
            new.setncatts({_ROOM: " " * _HEADER} if in_place else {})
            for name, size in lengths.items():
                new.createDimension(name, size)
            for name, variable in old.variables.items():
                attributes = {key: variable.getncattr(key) for key in variable.ncattrs()}
                fill = attributes.pop("_FillValue", None)
                storage: dict[str, Any] = {}
                if not in_place and variable.dtype is not str:
                    shape = tuple(lengths[dim] for dim in variable.dimensions)
                    nbytes = variable.dtype.itemsize * int(np.prod(shape))
                    storage = chunked(variable.dtype, shape, nbytes, compress=compress)
                made = new.createVariable(
                    name, variable.dtype, variable.dimensions, fill_value=fill, **storage
                )
                if _ROOM in new.ncattrs():  # data begin behind it from now on
                    new.delncattr(_ROOM)
                made.setncatts(attributes)
                if not set(variable.dimensions) & set(sizes):  # it is all there
                    made[...] = variable[...]
            new.setncatts({name: old.getncattr(name) for name in old.ncattrs()})


def text_storage(variable: xr.Variable) -> dict[str, Any]:
    """How to store a text: a single one as characters, others as the library does.

    netCDF's library ends the program if a single text of varying length is read twice while the file is open elsewhere.
    """
    return {"dtype": "S1"} if variable.dtype.kind in "OU" and not variable.dims else {}


def chunked(
    dtype: np.dtype[Any], shape: tuple[int, ...], nbytes: int, *, compress: bool = True
) -> dict[str, Any]:
    """How to store a variable: in chunks with a checksum each (Fletcher-32), large ones compressed.

    Bytes are sorted by their place in the number (shuffle), then deflated at the lowest level: counts and flags shrink
    to a hundredth, samples of motion, whose last digits are noise, to six tenths at 85 MB/s on one core; higher levels
    win a hundredth. HDF5 has no filter for single numbers and for texts, which are stored plainly.
    """
    if dtype.kind not in "fi" or not nbytes or not shape:
        return {}
    pieces = -(-shape[-1] * dtype.itemsize // CHUNK)
    # the runs of a sweep are chunks of their own where they are long
    runs = shape[:-1] if nbytes <= _OWN_CHUNKS_ABOVE else (1,) * (len(shape) - 1)
    storage: dict[str, Any] = {"fletcher32": True, "chunksizes": (*runs, -(-shape[-1] // pieces))}
    if compress and nbytes >= _COMPRESSED_FROM:
        storage |= {"zlib": True, "complevel": 1, "shuffle": True}
    return storage
