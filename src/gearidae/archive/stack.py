"""Runs along the axes of a sweep: one key a dimension, or several that are walked together."""

from __future__ import annotations

import itertools
import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from gearidae.archive.dataset import combine, dimension_names, key_labels
from gearidae.archive.output_selection import EVERYTHING, OutputSelection
from gearidae.archive.provenance import provenance
from gearidae.archive.row_variables import DIMS
from gearidae.archive.sample_table import SampleTable
from gearidae.records import Solution

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.scene import Scene

Axis = dict[str, list[Any]]
"""Values of the keys that are walked together along one dimension; the first key labels it."""


def stack(
    base: Scene,
    axes: Sequence[Axis],
    scenes: Sequence[Scene],
    solutions: Sequence[Solution],
    *,
    selection: OutputSelection = EVERYTHING,
    samples: SampleTable | None = None,
) -> xr.Dataset:
    """Put runs into one dataset.

    Parameters
    ----------
    base : Scene
        What the runs have in common.
    axes : sequence of dict
        For each dimension, the values of its keys in SI units; several keys where they are zipped.
    scenes, solutions : sequence
        One for each run; the last axis changes fastest.
    selection : OutputSelection, optional
        Which variables the dataset has; by default all.
    samples : SampleTable, optional
        Holds the samples, if the solutions do not.

    Returns
    -------
    xarray.Dataset
        See `gearidae.sweep`.
    """
    ds = combine(base, leaders_of(axes), scenes, solutions, selection=selection, samples=samples)
    return with_zipped(ds, base, axes)


def leaders_of(axes: Sequence[Axis]) -> Axis:
    """Return the values of the key that labels each axis, the first."""
    return {leader: axis[leader] for axis in axes for leader in [next(iter(axis))]}


def with_zipped(ds: xr.Dataset, base: Scene, axes: Sequence[Axis]) -> xr.Dataset:
    """Add the keys that are walked together with those that label the dimensions of a dataset.

    Parameters
    ----------
    ds : xarray.Dataset
        Of the runs, with a dimension for the first key of each axis.
    base, axes
        As for `stack`.
    """
    zipped = zipped_keys(axes)
    if not zipped:
        return ds
    leaders = [next(iter(axis)) for axis in axes]
    names = dimension_names([key for axis in axes for key in axis])
    renamed = {short: names[key] for key, short in dimension_names(leaders).items() if short != names[key]}
    labels = {f"{dim}_{short}": f"{dim}_{name}" for dim in DIMS for short, name in renamed.items()}
    ds = ds.rename(renamed | {short: name for short, name in labels.items() if short in ds})
    for axis in axes:
        leader, *others = axis
        ds = ds.assign_coords({names[key]: key_labels(key, names[leader], axis[key]) for key in others})
    about = provenance(base, "", swept=tuple(" with ".join(axis) for axis in axes))
    return ds.assign_attrs(
        title=about["title"], summary=about["summary"], swept=swept_values(axes), zipped=zipped
    )


def swept_values(axes: Sequence[Axis]) -> str:
    """Write the values of every key as the attribute ``swept`` holds them."""
    return json.dumps({key: axis[key] for axis in axes for key in axis}, allow_nan=False)


def zipped_keys(axes: Sequence[Axis]) -> str:
    """Name the keys that are walked together, as the attribute ``zipped`` does; empty without any."""
    return ", ".join(itertools.chain(*(axis for axis in axes if len(axis) > 1)))
