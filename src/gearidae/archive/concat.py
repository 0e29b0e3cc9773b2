"""Several datasets joined into one: runs and sweeps along a swept key, or the runs of a chain along time."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from gearidae.archive.chain import chained, history_of, part_name, software_of
from gearidae.archive.dataset import dimension_names
from gearidae.archive.exposures import exposure_coordinates
from gearidae.archive.output_selection import kept_in
from gearidae.archive.row_variables import rows_from
from gearidae.archive.select import is_train, run_value, runs, scene_of, single_run, swept_dims
from gearidae.archive.stack import Axis, stack
from gearidae.archive.variables import (
    ENERGY_TOTALS,
    EXPOSURES,
    EXTREMES,
    RUN,
    STANDSTILL_LIST,
    VERDICT,
)
from gearidae.errors import SceneError
from gearidae.records import ROWS, Solution, Statistics
from gearidae.scene import Scene, describe_keys
from gearidae.scene.differences import first_difference
from gearidae.scene.keys import scene_value
from gearidae.scene.named_tables import NAME


def concat(datasets: Iterable[xr.Dataset] | Mapping[str, xr.Dataset], dim: str) -> xr.Dataset:
    """Join runs and sweeps into one dataset.

    Parameters
    ----------
    datasets : iterable of xarray.Dataset, or mapping of str to xarray.Dataset
        Single runs, sweeps, or selections from sweeps; of a mapping, single runs by the names that they shall have.
    dim : str
        The key in which they differ (``coating.sam_fraction``) or the name of its dimension (``sam_fraction``);
        ``name`` for single runs of any scenes with names of their own; or ``time`` for a chain of runs, each of which
        goes on where the one before has ended.

    Returns
    -------
    xarray.Dataset
        As `gearidae.sweep` returns it, with the runs in the order given: scenes, events, statistics, extremes,
        exposures and energy balance of each are its own. Along ``name``, keys in which the runs differ are coordinates
        too, if they hold numbers or words. Of a chain, as `gearidae.simulate` returns it: the samples and
        events of all, their statistics added up; energy balance, extremes and exposures, which each run carries on from
        the one before, are those of the last, and so are scene and status. The attribute ``chain`` holds where each run
        begins and ends, and its scene.

    Raises
    ------
    SceneError
        If the datasets cannot be joined: they differ in another key, which is named, or have the same value of this
        one; or the runs of a chain do not follow each other.
    """
    parts = list(datasets.values() if isinstance(datasets, Mapping) else datasets)
    if not parts:
        raise SceneError("concat", "[]", "needs at least one dataset")
    for number, part in enumerate(parts):
        if not isinstance(part, xr.Dataset):
            raise SceneError(part_name(number), type(part).__name__, "must be a dataset")
        scene_of(part)
        if is_train(part) and dim != "time":
            allowed = (
                "cannot be joined: they are of trains of several meshes, which gearidae.sweep runs into one"
            )
            raise SceneError(part_name(number), "(train)", allowed)
    if dim == "time":
        return chained(parts)
    if isinstance(datasets, Mapping) and dim != "name":
        raise SceneError("dim", dim, 'must be "name" for datasets by name')
    if dim == "name":
        parts = _named(parts, list(datasets) if isinstance(datasets, Mapping) else None)
        axes = [_differing(parts)]
    else:
        axes = _axes(parts, _key_of(parts, dim))
    members = [_Run(run, single_run(run)) for part in parts for _, run in runs(part)]
    scenes = [Scene.from_dict(scene_of(member.single)) for member in members]
    order = _order(axes, scenes)
    scenes, members = [scenes[index] for index in order], [members[index] for index in order]
    if dim != "name":
        _refuse_differences(scenes, [key for axis in axes for key in axis])
    _refuse_other_samples(members)
    selection = kept_in(parts[0].attrs, scenes[0])
    for number, part in enumerate(parts):
        if part.attrs.get("keep") != parts[0].attrs.get("keep"):
            raise SceneError(
                "keep", part.attrs.get("keep"), f"of {part_name(number)} must be that of the first"
            )
    base = Scene.from_dict(scene_of(parts[0]))
    ds = stack(base, axes, scenes, [_solution(member.single) for member in members], selection=selection)
    ds = _with_exposures(_with_numbers(ds, parts, members), base, [member.picked for member in members])
    return ds.assign_attrs(
        history=history_of(parts, f"joined {len(parts)} datasets along {dim}"), **software_of(parts)
    )


class _Run(NamedTuple):
    """A run as it was picked from its dataset, and by itself."""

    picked: xr.Dataset
    single: xr.Dataset


def _named(parts: Sequence[xr.Dataset], names: Sequence[str] | None) -> list[xr.Dataset]:
    """Single runs with names of their own, which stand in their scenes."""
    singles = [single_run(part) for part in parts]
    for number, single in enumerate(singles):
        if several := swept_dims(single):
            raise SceneError(part_name(number), f"runs along {', '.join(several)}", "must be a single run")
        if names is not None:
            scene = Scene.from_dict(scene_of(single)).replace({"name": names[number]})
            singles[number] = single.assign_attrs(scene=json.dumps(scene.to_dict()))
    return singles


def _differing(parts: Sequence[xr.Dataset]) -> Axis:
    """Names of single runs, with the keys in which the runs differ and that hold numbers, or words."""
    scenes = [Scene.from_dict(scene_of(part)) for part in parts]
    axis: Axis = {"name": [scene.name for scene in scenes]}
    for number, name in enumerate(axis["name"]):
        if name in axis["name"][:number]:
            raise SceneError("name", name, "stands in the datasets twice: name them, as in {name: dataset}")
    others: list[str] = []
    for scene in scenes[1:]:
        while difference := first_difference(scenes[0].to_dict(), scene.to_dict(), (*axis, *others)):
            key = difference[0]
            values = [scene_value(entry, key) for entry in scenes]
            kinds = {type(value) for value in values}
            if kinds <= {int, float} or kinds == {str}:
                axis[key] = values
            else:
                others.append(key)
    return axis


def _key_of(parts: Sequence[xr.Dataset], dim: str) -> str:
    """Find the key that a dimension is named after."""
    known = [info.key for info in describe_keys() if NAME not in info.key]
    swept = [key for part in parts for axis in _own_axes(part) for key in axis]
    candidates = [dim] if dim in (*known, *swept) else []
    for key in (*swept, *known):
        if dim in (key.rpartition(".")[2], key.replace(".", "_")) and key not in candidates:
            candidates.append(key)
    if len(candidates) > 1:
        differing = [
            key for key in candidates if key in swept or len({str(_value(p, key)) for p in parts}) > 1
        ]
        candidates = differing or candidates
    if len(candidates) != 1:
        allowed = (
            f"could be {' or '.join(candidates)}: name the key" if candidates else "is no key of a scene"
        )
        raise SceneError("dim", dim, allowed)
    return candidates[0]


def _value(part: xr.Dataset, key: str) -> Any:
    try:
        return scene_value(Scene.from_dict(scene_of(part)), key)
    except (AttributeError, LookupError, TypeError):
        return None


def _own_axes(part: xr.Dataset) -> list[Axis]:
    """The axes of a dataset that still are dimensions, with the values that are left."""
    swept = json.loads(part.attrs.get("swept", "{}"))
    axes: dict[str, Axis] = {}
    for key, name in dimension_names(swept).items():
        if name in part.coords and part[name].dims:
            values = part[name].values.tolist()
            if part[name].attrs.get("comment"):
                values = [swept[key][number] for number in values]
            axes.setdefault(str(part[name].dims[0]), {})[key] = values
    return [_led(axis, dim, swept) for dim, axis in axes.items()]


def _led(axis: Axis, dim: str, swept: dict[str, Any]) -> Axis:
    """Put the key that names the dimension in front."""
    names = dimension_names(swept)
    return dict(sorted(axis.items(), key=lambda entry: names[entry[0]] != dim))


def _axes(parts: Sequence[xr.Dataset], key: str) -> list[Axis]:
    """Axes of the whole: the parts' axes, of which the one of `key` is walked from part to part."""
    part_axes = [_own_axes(part) for part in parts]
    with_key = [next((axis for axis in axes if key in axis), None) for axes in part_axes]
    rest = [[axis for axis in axes if key not in axis] for axes in part_axes]
    for number, axes in enumerate(rest):
        mine, first = ({k: v for axis in group for k, v in axis.items()} for group in (axes, rest[0]))
        for other in {**first, **mine}:
            if mine.get(other) != first.get(other):
                shown = mine.get(other, "(not swept)")
                raise SceneError(
                    other, shown, f"of {part_name(number)} must be as in the first: {first.get(other)}"
                )
    together = {tuple(axis) if axis else (key,) for axis in with_key}
    if len(together) > 1:
        keys = sorted({name for names in together for name in names} - {key})
        raise SceneError(keys[0], f"zipped with {key}", "must be so in all datasets")
    joined: Axis = {name: [] for name in together.pop()}
    for part, axis in zip(parts, with_key, strict=True):
        for name, values in joined.items():
            values.extend(axis[name] if axis else [_value(single_run(part) if not rest[0] else part, name)])
    leader = next(iter(joined))
    for number, value in enumerate(joined[leader]):
        if value in joined[leader][:number]:
            raise SceneError(leader, value, "stands in the datasets twice")
    index = next((number for number, axis in enumerate(part_axes[0]) if key in axis), 0)
    return [*rest[0][:index], joined, *rest[0][index:]]


def _order(axes: Sequence[Axis], scenes: Sequence[Scene]) -> list[int]:
    """Indices of the runs in the order of the whole: the last axis changes fastest."""
    shape = tuple(len(next(iter(axis.values()))) for axis in axes)
    number_at: dict[int, int] = {}
    for number, scene in enumerate(scenes):
        index = []
        for axis in axes:
            leader = next(iter(axis))
            value = scene_value(scene, leader)
            if value not in axis[leader]:
                raise SceneError(leader, value, "is not among the values of the datasets")
            index.append(axis[leader].index(value))
        number_at[int(np.ravel_multi_index(index, shape))] = number
    return [number_at[number] for number in range(math.prod(shape))]


def _refuse_differences(scenes: Sequence[Scene], swept: Sequence[str]) -> None:
    """Name the first key in which runs differ that is not swept."""
    for scene in scenes[1:]:
        difference = first_difference(scenes[0].to_dict(), scene.to_dict(), ignored=("name", *swept))
        if difference is not None:
            key, ours, theirs = difference
            raise SceneError(
                key, theirs, f"is {ours} in the first run: runs may differ in {', '.join(swept)} only"
            )


def _refuse_other_samples(members: Sequence[_Run]) -> None:
    """Refuse runs that do not share one time axis, as far as each of them goes, or have other variables along it."""
    for number, run in enumerate(members):
        ours, theirs = (
            {n for n, variable in member.single.data_vars.items() if "time" in variable.dims}
            for member in (members[0], run)
        )
        if other := ours ^ theirs:
            shown = ", ".join(sorted(map(str, other)))
            raise SceneError(part_name(number), shown, "must be sampled in all runs, or in none")
    times = [member.single["time"].values for member in members if "time" in member.single.dims]
    longest = max(times, key=len, default=np.empty(0))
    for time in times:
        if not np.array_equal(time, longest[: len(time)]):
            raise SceneError(
                "time",
                f"{time[0]:g} to {time[-1]:g} s",
                "differs between the runs, which share one time axis",
            )


def _solution(run: xr.Dataset) -> Solution:
    """Turn a single run's dataset back into what it was made from, as far as `stack` needs it."""
    samples = {str(n): variable.values for n, variable in run.data_vars.items() if variable.dims == ("time",)}
    rows: dict[str, Any] = {kind.field: rows_from(run, kind) for kind in ROWS}
    numbers = {name: _number(run, name) for name in RUN if name not in ("status", "message")}
    statistics = Statistics(**numbers, skipped=json.loads(run.attrs.get("skipped", "{}")))
    reached = run["reached"] if "reached" in run else run.attrs["t_end"]
    return Solution(
        run["time"].values if "time" in run.dims else np.empty(0),
        samples,
        statistics=statistics,
        status=run.attrs["status"],
        message=run.attrs["message"],
        reached=float(reached),
        **rows,
    )


def _number(run: xr.Dataset, name: str) -> Any:
    try:
        return run_value(run, name)
    except KeyError:  # has not been kept
        return "" if RUN[name].dtype is np.str_ else 0


def _with_numbers(ds: xr.Dataset, parts: Sequence[xr.Dataset], members: Sequence[_Run]) -> xr.Dataset:
    """Put in what is taken from the runs' datasets as it is: extremes, energy balances, verdicts, and totals."""
    dims, shape = ds["status"].dims, ds["status"].shape
    for name, variable in {
        **ENERGY_TOTALS,
        **EXTREMES,
        STANDSTILL_LIST.name: STANDSTILL_LIST,
        **VERDICT,
    }.items():
        known = [name in member.picked and not member.picked[name].dims for member in members]
        if all(known) or (name in ENERGY_TOTALS and any(known)):
            numbers = [
                member.picked[name].values.item() if has else math.nan
                for member, has in zip(members, known, strict=True)
            ]
            values = np.array(numbers, dtype=variable.dtype)
            ds[name] = (dims, values.reshape(shape), members[known.index(True)].picked[name].attrs)
    for name, variable in RUN.items():
        if name not in ds and name in ds.attrs:  # of runs that have not kept theirs the parts know the sum
            entries = [part.attrs[name] for part in parts]
            is_text = variable.dtype is np.str_
            ds.attrs[name] = ", ".join(sorted({*entries} - {""})) if is_text else sum(entries)
    return ds


def _with_exposures(ds: xr.Dataset, base: Scene, picked: Sequence[xr.Dataset]) -> xr.Dataset:
    """Put in what the flanks of each run have been exposed to, if all have the same teeth, bins and materials."""
    dims, shape = ds["status"].dims, ds["status"].shape
    for name, variable in EXPOSURES.items():
        if {run[name].dims if name in run else () for run in picked} != {variable.dims}:
            continue
        if len({run[name].shape for run in picked}) == 1:
            values = np.stack([run[name].values for run in picked])
            ds[name] = (
                (*dims, *variable.dims),
                values.reshape(*shape, *values.shape[1:]),
                variable.attributes,
            )
    return ds.assign_coords(exposure_coordinates(base)) if "place" in ds.dims else ds
