"""How a dataset is put into a netCDF4 file: whole, or piece by piece where it is long.

xarray decides on names, attributes, coordinates and fill values. Of a long dataset it is asked without data, and its
answer is repeated at the length wanted.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from gearidae.archive.netcdf_access import opened, uninterrupted
from gearidae.archive.row_variables import DIMS

_COMPRESSED_FROM = 2**12
"""Variables of this size [bytes] are compressed: a block of the disk, below which nothing is won."""
_OWN_CHUNKS_ABOVE = 2**16
"""Variables of a sweep that are larger than this [bytes] have chunks for each run."""
CHUNK = 2**20
"""Largest chunk [bytes]."""
LONGEST_WHOLE = 128 * 2**20
"""Datasets larger than this [bytes in memory] are written, and read, piece by piece."""
_ROWS = 2**20
"""Values written at a time."""
_GROWING = ("time", *DIMS)
"""Dimensions that may be long."""


@uninterrupted()
def write(ds: xr.Dataset, path: Path, *, compress: bool = True) -> None:
    """Write a dataset into a netCDF4 file; what it reads from a file itself is in memory piece by piece.

    Parameters
    ----------
    ds : xarray.Dataset
        Of which a single run may be long.
    path : Path
        File to create.
    compress : bool, optional
        Whether large variables are compressed.
    """
    ds = ds.drop_encoding()
    if ds.nbytes <= LONGEST_WHOLE or "swept" in ds.attrs:
        ds.to_netcdf(path, engine="netcdf4", format="NETCDF4", encoding=_encoding(ds, compress=compress))
        return
    long = {dim: ds.sizes[dim] for dim in _GROWING if dim in ds.sizes}
    with tempfile.TemporaryDirectory() as folder:
        sample = Path(folder) / "template.nc"
        nothing = ds.isel({dim: slice(0) for dim in long})
        nothing.to_netcdf(sample, engine="netcdf4", encoding=_encoding(nothing, compress=compress))
        with opened(sample) as old, opened(path, "x") as new:
            for file in (old, new):
                file.set_auto_maskandscale(False)
                file.set_auto_chartostring(False)
            for name, dimension in old.dimensions.items():
                new.createDimension(name, long.get(name, len(dimension)))
            for name, variable in old.variables.items():
                attributes = {key: variable.getncattr(key) for key in variable.ncattrs()}
                fill = attributes.pop("_FillValue", None)
                storage: dict[str, Any] = {}
                if variable.dtype is not str:
                    shape = tuple(long.get(dim, len(old.dimensions[dim])) for dim in variable.dimensions)
                    nbytes = variable.dtype.itemsize * int(np.prod(shape))
                    storage = chunked(variable.dtype, shape, nbytes, compress=compress)
                made = new.createVariable(
                    name, variable.dtype, variable.dimensions, fill_value=fill, **storage
                )
                made.setncatts(attributes)
                if not {*variable.dimensions} & {*long}:
                    made[...] = variable[...]
            new.setncatts({name: old.getncattr(name) for name in old.ncattrs()})
    with opened(path, "a") as file:  # anew: the library keeps all chunks of variables that it has just made
        file.set_auto_maskandscale(False)
        for name, variable in file.variables.items():
            if {*variable.dimensions} & {*long}:
                _copy(ds.variables[name], variable)


def _copy(values: xr.Variable, made: Any) -> None:
    """Copy a long variable into one of a file, whole chunks at a time."""
    chunks, step = made.chunking(), _ROWS
    if isinstance(chunks, list):
        step = max(_ROWS // chunks[0], 1) * chunks[0]
        made.set_var_chunk_cache(size=0)  # whole chunks come once each: nothing to remember
    for start in range(0, values.size, step):
        made[start : start + step] = values[start : start + step].values


def _encoding(ds: xr.Dataset, *, compress: bool) -> dict[str, dict[str, Any]]:
    """How to store each variable."""
    encoding: dict[str, dict[str, Any]] = {}
    for name, variable in ds.variables.items():
        entry = text_storage(variable)
        entry |= chunked(variable.dtype, variable.shape, variable.nbytes, compress=compress)
        # The reason of `text_storage` holds for several texts too; the library cannot store none as characters.
        if variable.dtype.kind in "OU" and variable.size:
            entry["dtype"] = "S1"
        if variable.dtype.kind == "f" and name in ds.coords:
            entry["_FillValue"] = None  # coordinates have no gaps
        encoding[str(name)] = entry
    return encoding


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
