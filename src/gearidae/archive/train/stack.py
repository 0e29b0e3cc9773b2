"""Runs of trains along the axes of a sweep."""

from __future__ import annotations

import json
from collections.abc import Hashable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gearidae.archive.dataset import dimension_names, key_labels, sweep_attributes
from gearidae.archive.output_selection import EVERYTHING, OutputSelection
from gearidae.archive.row_variables import add_row_labels
from gearidae.archive.stack import Axis, leaders_of, with_zipped
from gearidae.archive.train.dataset import train_dataset
from gearidae.archive.train.variables import ATTRIBUTES, COORDINATES, HELD_BY
from gearidae.archive.variables import CONTACT, OF_SWEPT_RUN, RUN, SAM_FRACTION, Variable, run_label

if TYPE_CHECKING:
    from gearidae.records.train_results import TrainSolution
    from gearidae.scene import Scene, TrainScene

_TOTALS = tuple(name for name, variable in RUN.items() if variable.dtype is np.int64)
_OF_RUN: dict[str, Variable] = dict(RUN)
_OF_RUN |= {variable.name: variable for variable in CONTACT} | {"skipped": OF_SWEPT_RUN["skipped"]}
"""Attributes of a single run that are variables of a sweep."""


def stack_trains(
    base: Scene,
    axes: Sequence[Axis],
    scenes: Sequence[TrainScene],
    solutions: Sequence[TrainSolution],
    *,
    selection: OutputSelection = EVERYTHING,
) -> xr.Dataset:
    """Put runs of trains into one dataset.

    Parameters
    ----------
    base : Scene
        What the runs have in common.
    axes : sequence of dict
        For each dimension, the values of its keys in SI units; several keys where they are zipped.
    scenes, solutions : sequence
        One for each run; shafts and meshes have the same names in all. The last axis changes fastest.
    selection : OutputSelection, optional
        Which variables the dataset has; by default all.

    Returns
    -------
    xarray.Dataset
        See `gearidae.sweep`.
    """
    leaders = leaders_of(axes)
    names = dimension_names(leaders)
    dims, shape = tuple(names.values()), tuple(len(values) for values in leaders.values())
    labels = {names[key]: key_labels(key, names[key], values) for key, values in leaders.items()}
    members = [
        train_dataset(scene, solution, selection) for scene, solution in zip(scenes, solutions, strict=True)
    ]
    first, longest = members[0], max((member["time"] for member in members), key=len)
    members = [member.reindex(time=longest) for member in members]

    def stacked(values: Sequence[Any], dtype: Any, over: tuple[Any, ...] = ()) -> tuple[Any, Any]:
        array = np.empty((len(members), *np.shape(values[0])), dtype=dtype)
        for row, value in enumerate(values):
            array[row] = value
        return (*dims, *over), array.reshape(*shape, *np.shape(values[0]))

    variables: dict[Hashable, Any] = {}
    coords: dict[Hashable, Any] = {}
    if selection.columns(base):
        coords["time"] = ("time", longest.values, longest.attrs)
    coords.update(labels)
    for name, variable in first.data_vars.items():
        parts = [member[name].values for member in members]
        if "event" in variable.dims:
            variables[name] = (("event",), np.concatenate(parts), variable.attrs)
        else:
            variables[name] = (*stacked(parts, variable.dtype, variable.dims), variable.attrs)
    for name in COORDINATES:
        parts = [member[name].values for member in members]
        alike = all(np.array_equal(part, parts[0]) for part in parts)
        over = first[name].dims
        values = (over, parts[0]) if alike else stacked(parts, parts[0].dtype, over)
        coords[name] = (*values, first[name].attrs)
    if "event_time" in first:
        add_row_labels(variables, "event", labels, [member.sizes["event"] for member in members])
    for name, known in _OF_RUN.items():
        if selection.holds(name):
            variables[name] = _column(known, [member.attrs[name] for member in members], dims, shape)
    held = [member.attrs.get("held_by", "") for member in members]
    variables[HELD_BY.name] = _column(HELD_BY, held, dims, shape)
    if selection.holds("scene"):
        inputs = [json.dumps(scene.to_dict(), allow_nan=False) for scene in scenes]
        variables["scene"] = _column(OF_SWEPT_RUN["scene"], inputs, dims, shape)
    if SAM_FRACTION.name not in dims:
        coords.update({**run_label(base)})
    drivers = {name: {member.attrs[name] for member in members} - {""} for name in ("backend", "method")}
    ds = xr.Dataset(
        variables,
        coords=coords,
        attrs={
            **sweep_attributes(base, leaders, [member.attrs["status"] for member in members]),
            **({} if selection.names is None else {"keep": json.dumps(selection.asked)}),
            **{name: sum(int(member.attrs[name]) for member in members) for name in _TOTALS},
            "wall_time": float(sum(member.attrs["wall_time"] for member in members)),
            **{name: ", ".join(sorted(texts)) for name, texts in drivers.items()},
            **{name: first.attrs[name] for name in ATTRIBUTES},
        },
    )
    return with_zipped(ds, base, axes)


def _column(
    variable: Variable, values: Sequence[Any], dims: tuple[str, ...], shape: tuple[int, ...]
) -> tuple[Any, Any, Any]:
    column = np.empty(len(values), dtype=object)
    column[:] = values
    return dims, column.astype(variable.dtype).reshape(shape), variable.attributes
