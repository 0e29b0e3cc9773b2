"""Datasets as pandas tables: time series, events, passages and impacts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import IntEnum
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from gearidae.archive.row_variables import own_rows
from gearidae.archive.select import is_train, refuse_train, swept_dims
from gearidae.archive.variables import ROW_VARIABLES, SAM_FRACTION
from gearidae.errors import SceneError
from gearidae.records import Impacts, Rows

LARGEST_TABLE = 2**31
"""Size of a table [bytes] above which it is refused unless more is allowed."""


def time_series(
    ds: xr.Dataset, variables: Sequence[str] | None = None, *, largest: float = LARGEST_TABLE
) -> pd.DataFrame:
    """Make a table of the samples.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep.
    variables : sequence of str, optional
        Which of the sampled variables; by default all.
    largest : float, optional
        Size that the table may have [bytes].

    Returns
    -------
    pandas.DataFrame
        A row for each sample, by its ``time`` [s]; a column for each variable, in SI units. Of a sweep the runs stand
        one below the other, with a column for each swept key in front; samples that a run did not reach are NaN.

    Raises
    ------
    SceneError
        If there is no such sampled variable, or the table would be too large.
    """
    sampled = [str(name) for name, variable in ds.data_vars.items() if "time" in variable.dims]
    wanted = sampled if variables is None else [variables] if isinstance(variables, str) else list(variables)
    for name in wanted:
        if name not in sampled:
            raise SceneError("variables", name, f"must be sampled: {', '.join(sampled) or 'nothing is'}")
    dims = swept_dims(ds)
    shape = tuple(ds.sizes[dim] for dim in dims)
    rows = math.prod(shape) * ds.sizes.get("time", 0)
    columns = (
        1 + len(dims) + sum(math.prod(ds.sizes[dim] for dim in _parts(ds[name], dims)) for name in wanted)
    )
    if 8 * rows * columns > largest:
        raise SceneError(
            "to_dataframe",
            f"{rows:.3g} rows of {columns} columns",
            f"would take {8e-9 * rows * columns:.3g} GB: pick runs (ds.sel), samples (ds.isel(time=slice(None, None, "
            "10))) or variables=[...] first, or allow it by largest=",
        )
    if not wanted:
        return pd.DataFrame(index=pd.Index([], dtype=np.float64, name="time"))
    time = pd.Index(np.tile(ds["time"].values, math.prod(shape)), name="time")
    labels = {name: np.repeat(values, ds.sizes["time"]) for name, values in run_labels(ds, dims).items()}
    values: dict[str, Any] = {}
    for name in wanted:
        values |= _columns_of(ds[name], dims)
    return pd.DataFrame({**labels, **values}, index=time)


def _parts(variable: xr.DataArray, dims: tuple[str, ...]) -> list[str]:
    """Dimensions of a sampled variable besides time and swept keys: the shafts or the meshes of a train."""
    return [str(dim) for dim in variable.dims if dim != "time" and dim not in dims]


def _columns_of(variable: xr.DataArray, dims: tuple[str, ...]) -> dict[str, Any]:
    """Columns of a sampled variable: one, or one for each shaft or mesh."""
    parts = _parts(variable, dims)
    if not parts:
        return {str(variable.name): variable.transpose(*dims, "time").values.ravel()}
    (part,) = parts
    return {
        f"{variable.name}[{label}]": variable.isel({part: number}).transpose(*dims, "time").values.ravel()
        for number, label in enumerate(variable[part].values.tolist())
    }


def row_table(ds: xr.Dataset, kind: type[Rows]) -> pd.DataFrame:
    """Make a table of the events, the passages or the impacts.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep, or runs picked from one.
    kind : type of Rows
        `gearidae.records.Events`, `gearidae.records.Passages` or `gearidae.records.Impacts`.

    Returns
    -------
    pandas.DataFrame
        A row for each event, passage or impact of these runs: the swept keys, ``sam_fraction``, ``time`` [s], and the
        other variables without the dimension in front of their names; ``kind`` and ``flank`` in words (as categories).

    Raises
    ------
    SceneError
        If they have not been kept.
    """
    if kind.dim not in ds.dims:
        refuse_train(ds)
        advice = f"sweep with keep=[..., '{kind.field}']"
        if kind is Impacts:
            advice = "run with run.impacts = true, and if a sweep keeps parts of its runs " + advice
        raise SceneError(kind.field, "(missing)", f"have not been kept: {advice}")
    ds, known, prefix = own_rows(ds), ROW_VARIABLES[kind], f"{kind.dim}_"
    labels = [str(name) for name in ds.data_vars if str(name).startswith(prefix) and name not in known]
    columns: dict[str, Any] = {}
    for name in (*labels, f"{prefix}{SAM_FRACTION.name}", *(name for name in known if name in ds)):
        flags = known[name].flags if name in known else None
        values = ds[name].values
        columns.setdefault(name.removeprefix(prefix), _in_words(values, flags) if flags else values)
    for part in ("mesh", "shaft") if is_train(ds) else ():
        names = ds[part].values.tolist()
        columns[part] = pd.Categorical.from_codes(columns[part], categories=names)
    return pd.DataFrame(columns)


def run_labels(ds: xr.Dataset, dims: tuple[str, ...]) -> dict[str, Any]:
    """Return the swept keys' values, of zipped ones too, each as one array with an entry for each run."""
    shape = tuple(ds.sizes[dim] for dim in dims)
    along = [name for name in ds.coords if ds[name].dims and set(ds[name].dims) <= set(dims)]
    labels = {}
    for name in sorted(
        map(str, along),
        key=lambda coordinate: (coordinate not in dims, dims.index(str(ds[coordinate].dims[0]))),
    ):
        axis = dims.index(str(ds[name].dims[0]))
        spread = np.unravel_index(np.arange(math.prod(shape)), shape)[axis]
        labels[name] = ds[name].values[spread]
    return labels


def _in_words(values: np.ndarray[Any, Any], kinds: type[IntEnum]) -> pd.Categorical:
    """Give flags their names."""
    numbers = [kind.value for kind in kinds]
    words = [kind.name.lower() for kind in kinds]
    codes = np.searchsorted(numbers, values)
    return pd.Categorical.from_codes(codes, categories=words)
