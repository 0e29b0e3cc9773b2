"""Rows of runs in datasets, events, passages and impacts: along a dimension of their own, labelled by their runs."""

from __future__ import annotations

import json
from collections.abc import Hashable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.variables import PLACES, POPULATION_EVENTS, ROW_VARIABLES, SAM_FRACTION, TRAIN_LABELS
from gearidae.errors import SceneError
from gearidae.records import ROWS, Flank, Rows, Solution
from gearidae.scene import Scene
from gearidae.scene.sampled import rows_of

DIMS = tuple(kind.dim for kind in ROWS)
"""Dimensions of rows."""
LABELS = ("time", *DIMS, *PLACES, *TRAIN_LABELS)
"""Coordinates that label no runs."""


def kinds_in(ds: xr.Dataset) -> Iterator[type[Rows]]:
    """Kinds of rows that a dataset has."""
    return (kind for kind in ROWS if kind.dim in ds.dims)


def needed(kind: type[Rows]) -> tuple[str, ...]:
    """Variables that rows of a kind have in archives of every version that knows the kind."""
    names = [name for name, column in kind.columns.items() if column.missing is None]
    return tuple(f"{kind.dim}_{name}" for name in (*names, SAM_FRACTION.name))


def teeth_in(attributes: Mapping[str, Any]) -> int:
    """Teeth of the pinion in a dataset's scene, as its attributes have it; 1 for a roller."""
    return int(json.loads(attributes["scene"]).get("gears", {}).get("pinion_teeth", 1))


def archived(rows: Rows, teeth: int, label: float) -> dict[str, NDArray[Any]]:
    """Values of rows of one run by the names of their variables.

    Parameters
    ----------
    teeth : int
        Of the pinion; 1 for a roller. The tooth of a row of no flank is -1.
    label : float
        Of the run: its value of `COVERAGE_KEY`.
    """
    values = {name: getattr(rows, name) for name in rows.columns}
    values["tooth"] = np.where(rows.flank != Flank.NONE, rows.pair % teeth, -1)
    values[SAM_FRACTION.name] = np.broadcast_to(label, len(rows))
    return {f"{rows.dim}_{name}": column for name, column in values.items()}


def row_variables(
    kind: type[Rows],
    scenes: Sequence[Scene],
    solutions: Sequence[Solution],
    labels: Mapping[str, xr.Variable] | None = None,
) -> dict[Hashable, Any]:
    """Make the variables of the rows of all runs, one run after the other.

    Parameters
    ----------
    kind : type of Rows
    scenes, solutions : sequence
        The runs; the last label changes fastest.
    labels : mapping of str to Variable, optional
        Values of each swept dimension.

    Returns
    -------
    dict
        Name to dimension, values and attributes; empty if no run leaves such rows.
    """
    if not any(kind in rows_of(scene) for scene in scenes):
        return {}
    parts = [
        archived(
            getattr(solution, kind.field),
            1 if scene.gears is None else scene.gears.pinion_teeth,
            scene.coating.sam_fraction,
        )
        for scene, solution in zip(scenes, solutions, strict=True)
    ]
    discrete = any(scene.contact.is_discrete for scene in scenes)
    made: dict[Hashable, Any] = {}
    for name, variable in ROW_VARIABLES[kind].items():
        if discrete or name not in POPULATION_EVENTS:
            columns = [part[name] for part in parts]  # one alone may be longer than the memory
            values = columns[0] if len(columns) == 1 else np.concatenate(columns)
            values = values.astype(variable.dtype, copy=False)
            made[name] = ((kind.dim,), values, variable.attributes)
    counts = [len(getattr(solution, kind.field)) for solution in solutions]
    add_row_labels(made, kind.dim, labels or {}, counts)
    return made


def add_row_labels(
    variables: dict[Hashable, Any], rows: str, labels: Mapping[str, xr.Variable], counts: Sequence[int]
) -> None:
    """Label every row of a sweep with the run that it belongs to, where a variable does not do so already.

    Parameters
    ----------
    variables : dict
        Gets a variable for each label.
    rows : str
        Dimension of the rows.
    labels : mapping of str to Variable
        Values of each swept dimension; the last changes fastest.
    counts : sequence of int
        Rows of each run.
    """
    shape = tuple(label.size for label in labels.values())
    for position, (dim, label) in enumerate(labels.items()):
        if f"{rows}_{dim}" not in variables:
            index = np.unravel_index(np.arange(len(counts)), shape)[position]
            words = {"long_name": f"{dim} of the run the {rows} belongs to", "units": label.attrs["units"]}
            variables[f"{rows}_{dim}"] = ((rows,), np.repeat(label.values[index], counts), words)


def rows_from(run: xr.Dataset, kind: type[Rows]) -> Rows:
    """Rows of a single run's dataset; none where it has none."""
    if kind.dim not in run.dims:
        return kind.none()
    named = {name: f"{kind.dim}_{name}" for name in kind.columns}
    return kind(**{name: run[full].values for name, full in named.items() if full in run})


def own_rows(ds: xr.Dataset) -> xr.Dataset:
    """Drop the rows of other runs, which xarray leaves behind when runs are picked from a sweep.

    Parameters
    ----------
    ds : xarray.Dataset
        Runs of a sweep, or one of them.

    Returns
    -------
    xarray.Dataset
        With the rows only that carry the labels of its runs.

    Raises
    ------
    SceneError
        If a label of the rows lies along the runs, too.
    """
    for kind in kinds_in(ds) if "swept" in ds.attrs else ():
        mask = np.ones(ds.sizes[kind.dim], dtype=bool)
        for name in map(str, ds.coords):
            label = f"{kind.dim}_{name}"
            if name not in LABELS and label in ds.variables and ds[name].ndim < 2:
                if ds[label].ndim > 1:
                    allowed = (
                        f"must lie along {kind.dim} alone; where() repeats it: pick runs with sel() or isel()"
                    )
                    raise SceneError("dataset", f"{label} {ds[label].dims}", allowed)
                mask &= np.isin(ds[label].values, ds[name].values)
        ds = ds if mask.all() else ds.isel({kind.dim: mask})
    return ds


def row_indices(ds: xr.Dataset, dims: tuple[str, ...]) -> dict[str, list[Any]]:
    """Indices of each run's rows, found in one pass, by the rows' dimensions.

    Those are left out of which labels do not tell the runs apart.
    """
    indexes = [ds.get_index(dim) for dim in dims]
    shape = tuple(ds.sizes[dim] for dim in dims)
    if not dims or not all(index.is_unique for index in indexes):
        return {}
    by_dim: dict[str, list[Any]] = {}
    for kind in kinds_in(ds):
        labels = [f"{kind.dim}_{dim}" for dim in dims]
        if any(label not in ds.variables for label in labels):
            continue
        indices = [index.get_indexer(ds[label].values) for index, label in zip(indexes, labels, strict=True)]
        number = np.ravel_multi_index(indices, shape) if len(indices[0]) else np.empty(0, dtype=np.int64)
        order = np.argsort(number, kind="stable")
        bounds = pairwise(np.searchsorted(number[order], np.arange(int(np.prod(shape)) + 1)))
        if np.array_equal(order, np.arange(len(order))):
            by_dim[kind.dim] = [slice(first, last) for first, last in bounds]
        else:
            by_dim[kind.dim] = [order[first:last] for first, last in bounds]
    return by_dim
