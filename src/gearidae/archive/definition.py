"""How a dataset is put into a netCDF4 file: whole, or piece by piece where it is long.

Names, attributes, coordinates, fill values and texts are laid out as xarray's own writer lays them out. That one writes
each variable as soon as it has made it, and netCDF's library brings the file's description up to date before each: a
run's 110 variables take half the time where all are made first.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import NDArray

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
_VALUES = (str, int, float, np.number, np.ndarray)
"""Types of attributes."""
_LAYOUT = {"_FillValue", "_Encoding", "coordinates", "dtype"}
"""Attributes that tell the layout."""


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
    if not _is_usual(ds):
        ds.to_netcdf(path, engine="netcdf4", format="NETCDF4", encoding=_encoding(ds, compress=compress))
        return
    is_long = ds.nbytes > LONGEST_WHOLE and "swept" not in ds.attrs
    long = {dim for dim in _GROWING if is_long and dim in ds.sizes}
    with opened(path, "x") as file:
        file.set_auto_maskandscale(False)
        file.set_auto_chartostring(False)
        (beside, free), gaps = _beside(ds), {*ds.variables} - {*ds.coords}  # coordinates have none
        made = [
            _made(file, str(name), variable, beside.get(str(name), ""), name in gaps, compress)
            for name, variable in ds.variables.items()
        ]
        file.setncatts({**ds.attrs, **({"coordinates": free} if free else {})})
        for variable, values in made:
            if not long & {*variable.dimensions}:
                variable[...] = values.values if isinstance(values, xr.Variable) else values
    if not long:
        return
    with opened(path, "a") as file:  # anew: the library keeps all chunks of variables that it has just made
        file.set_auto_maskandscale(False)
        for name, variable in file.variables.items():
            if long & {*variable.dimensions}:
                _copy(ds.variables[name], variable)


def _is_usual(ds: xr.Dataset) -> bool:
    """Whether a dataset has nothing but what gearidae's own have; xarray writes others, or says what it refuses."""
    return _are_usual(ds.attrs) and all(
        isinstance(name, str)
        and not {" ", "/"} & {*name}
        and variable.chunks is None
        and _are_usual(variable.attrs)
        and (
            variable.dtype.kind in "fiubU"
            or (variable.dtype.kind == "O" and all(isinstance(text, str) for text in variable.values.ravel()))
        )
        for name, variable in ds.variables.items()
    )


def _are_usual(attributes: Mapping[Hashable, Any]) -> bool:
    """Whether attributes are texts and numbers, and none tells the layout."""
    return not _LAYOUT & attributes.keys() and all(
        isinstance(name, str) and type(value) is not bool and isinstance(value, _VALUES)
        for name, value in attributes.items()
    )


def _beside(ds: xr.Dataset) -> tuple[dict[str, str], str]:
    """Text of each variable's attribute `coordinates`, with all but its dimensions; coordinates that belong to none."""
    others = sorted(str(name) for name in {*ds.coords} - {*ds.dims})
    dims = {other: {*ds.variables[other].dims} for other in others}
    beside: dict[str, str] = {}
    listed: set[str] = set()
    for name, variable in ds.variables.items():
        if name not in dims and name not in variable.dims:
            mine = [other for other in others if dims[other] <= {*variable.dims}]
            beside[str(name)] = " ".join(mine)
            listed.update(mine)
    return beside, " ".join(other for other in others if other not in listed)


def _made(
    file: netCDF4.Dataset, name: str, variable: xr.Variable, beside: str, has_gaps: bool, compress: bool
) -> tuple[Any, xr.Variable | NDArray[Any]]:
    """Make a variable in a file, and its dimensions; with the values that it gets."""
    dtype: Any = variable.dtype
    values: xr.Variable | NDArray[Any] = variable
    attributes, fill = dict(variable.attrs), None
    if beside:
        attributes["coordinates"] = beside
    dims = {str(dim): size for dim, size in variable.sizes.items()}
    if dtype.kind in "OU" and not variable.size:
        dtype = str
    elif dtype.kind in "OU":  # as characters: see `_encoding`
        texts = np.array([str(text).encode() for text in variable.values.ravel()])
        values = texts.reshape(*variable.shape, 1).view("S1")
        dtype, attributes["_Encoding"] = "S1", "utf-8"
        dims[f"string{texts.dtype.itemsize}"] = texts.dtype.itemsize
    elif dtype.kind == "b":
        values, dtype, attributes["dtype"] = variable.values.astype(np.int8), np.dtype(np.int8), "bool"
    elif dtype.kind == "f" and has_gaps:
        fill = dtype.type(np.nan)
    for dim, size in dims.items():
        if dim not in file.dimensions:
            file.createDimension(dim, size)
    storage = chunked(variable.dtype, variable.shape, variable.nbytes, compress=compress)
    made = file.createVariable(name, dtype, (*dims,), fill_value=fill, **storage)
    made.setncatts(attributes)
    return made, values


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

    Bytes are sorted by their significance in the number (shuffle), then deflated at the lowest level: counts and flags
    shrink to a hundredth, samples of motion, whose last digits are noise, to six tenths at 85 MB/s on one core; higher
    levels win a hundredth. HDF5 has no filter for single numbers and for texts, which are stored plainly.
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
