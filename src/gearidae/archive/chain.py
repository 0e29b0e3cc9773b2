"""Runs that go on from each other, read as one run; and where a dataset that was joined from others comes from."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr

import gearidae
from gearidae.archive.row_variables import DIMS, kinds_in, rows_from
from gearidae.archive.select import run_scene, single_run
from gearidae.archive.train.variables import REST_LIST
from gearidae.archive.variables import RUN
from gearidae.errors import SceneError
from gearidae.scene.differences import first_difference, may_change

_CONTINUOUS = ("gear_speed", "pinion_speed", "gear_angle", "transmission_error", "height", "speed")
"""What cannot jump where one run goes on from another."""
_SEAM = 1e3
"""Tolerances by which a state may differ on both sides of a seam, over its range: each run reads it from its own dense
output."""
_GROWING = (("time",), *((dim,) for dim in DIMS))
"""What a chain has more of with each run; anything else is that of the last."""
_SUMS = ("wall_time", *(name for name, variable in RUN.items() if variable.dtype is np.int64))


def chained(parts: Sequence[xr.Dataset]) -> xr.Dataset:
    """Join the runs of a chain along time; see `gearidae.concat`.

    Parameters
    ----------
    parts : sequence of xarray.Dataset
        Single runs, in their order.

    Raises
    ------
    SceneError
        If they do not follow each other.
    """
    scenes = [run_scene(part) for part in parts]
    singles = [single_run(part) for part in parts]
    for number, scene in enumerate(scenes[1:], 1):
        first = scenes[0].to_dict()
        difference = first_difference(first, scene.to_dict(), ignored=may_change(first))
        if difference is not None:
            raise SceneError(
                difference[0],
                difference[2],
                f"of {part_name(number)} must be {difference[1]}, as in the first",
            )
    _refuse_other_samples(singles)
    cut = [singles[0]]
    for number, (before, after) in enumerate(pairwise(singles), 1):
        cut.append(after.isel(time=slice(_seam(before, after, part_name(number)), None)))
        _refuse_same_rows(before, after, part_name(number))
    last = singles[-1]
    variables = {
        str(name): (
            variable.dims,
            np.concatenate([part[name].values for part in cut], axis=-1)
            if variable.dims[-1:] in _GROWING
            else variable.values,
            variable.attrs,
        )
        for name, variable in last.variables.items()
    }
    if REST_LIST.name in variables:
        variables[REST_LIST.name] = ((), np.array(_rests(singles), object), REST_LIST.attributes)
    ds = xr.Dataset(
        {name: variable for name, variable in variables.items() if name not in last.coords},
        coords={name: variable for name, variable in variables.items() if name in last.coords},
        attrs=last.attrs,
    )
    for name in ("start_time", "parent"):
        ds.attrs.pop(name, None)
        if name in singles[0].attrs:
            ds.attrs[name] = singles[0].attrs[name]
    for name in _SUMS:
        ds.attrs[name] = sum(part.attrs[name] for part in singles)
    for name in ("backend", "method"):
        ds.attrs[name] = ", ".join(sorted({part.attrs.get(name, "") for part in singles} - {""}))
    links = [link for part in singles for link in _links(part)]
    return ds.assign_attrs(
        chain=json.dumps(links, allow_nan=False),
        history=history_of(parts, f"joined {len(parts)} runs along time"),
        **software_of(parts),
    )


def _rests(singles: Sequence[xr.Dataset]) -> str:
    """Join the rests of the shafts of a train; one that goes on beyond a seam has one row, with its later end."""
    rests = {}
    for single in singles:
        for shaft, begin, end in json.loads(str(single[REST_LIST.name].item())):
            rests[shaft, begin] = end
    return json.dumps([[shaft, begin, end] for (shaft, begin), end in rests.items()])


def _refuse_other_samples(singles: Sequence[xr.Dataset]) -> None:
    """Refuse runs that have not the same variables."""
    for number, single in enumerate(singles):
        differing = {str(name) for name in singles[0].variables} ^ {str(name) for name in single.variables}
        if differing:
            shown = ", ".join(sorted(differing))
            raise SceneError(part_name(number), shown, "must be in all runs of the chain, or in none")


def _seam(before: xr.Dataset, after: xr.Dataset, name: str) -> int:
    """Return how many samples of a run are those that the run before ended with; refuse what is no continuation."""
    end, start = _end(before), _start(after)
    width = 1e-9 * max(abs(end), abs(start))
    if start < end - width:
        raise SceneError(
            "time",
            f"{start:g} s",
            f"is where {name} begins, before the end of the one before, {end:g} s: it does not go on from it "
            "(gearidae.simulate(start=...))",
        )
    if not (before.sizes["time"] and after.sizes["time"]):
        return 0
    if start <= end + width:
        _refuse_jump(before, after, name)
        return 1
    if start - end > 1.5 * max(_spacing(before), _spacing(after)):
        raise SceneError(
            "time", f"{start:g} s", f"is where {name} begins: from {end:g} s to then a run is missing"
        )
    return 0


def _refuse_same_rows(before: xr.Dataset, after: xr.Dataset, name: str) -> None:
    """Refuse rows of a run that the run before has, too: they have not been cut with the samples."""
    for kind in kinds_in(after):
        if not (before.sizes[kind.dim] and after.sizes[kind.dim]):
            continue
        ends = (before.isel({kind.dim: [-1]}), after.isel({kind.dim: [0]}))
        last, first = (rows_from(part, kind).table()[0] for part in ends)
        if last[0] > first[0] or np.array_equal(last, first, equal_nan=True):
            allowed = f"in the {kind.field} of {name} must follow the run before: cut them with the samples"
            raise SceneError(f"{kind.dim}_time", f"{first[0]:g} s", allowed)


def _refuse_jump(before: xr.Dataset, after: xr.Dataset, name: str) -> None:
    tolerance = _SEAM * max(before.attrs["rtol"], after.attrs["rtol"])
    for variable in _CONTINUOUS:
        if variable not in after:
            continue
        old, new = before[variable].values[..., -1], after[variable].values[..., 0]
        extent = max(float(abs(part[variable]).max()) for part in (before, after))
        if (np.abs(new - old) > tolerance * extent).any():
            there, wanted = (", ".join(f"{value:g}" for value in np.ravel(values)) for values in (new, old))
            raise SceneError(
                variable, there, f"at the start of {name} must be {wanted}, as the run before ended"
            )


def _start(run: xr.Dataset) -> float:
    """When a run begins [s]; without that number, where its samples or events do."""
    if "start_time" in run.attrs:
        return float(run.attrs["start_time"])
    firsts = [float(run[name][0]) for name in ("time", "event_time") if name in run and run[name].size]
    return min(firsts, default=math.inf)


def _end(run: xr.Dataset) -> float:
    """When a run ends [s]."""
    lasts = [float(run[name][-1]) for name in ("time", "event_time") if name in run and run[name].size]
    if not run.sizes.get("time", 0):
        lasts.append(float(run["reached"]))
    return max(lasts, default=0.0)


def _spacing(run: xr.Dataset) -> float:
    return float(np.diff(run["time"].values[:2])[0]) if run.sizes["time"] > 1 else 0.0


def _links(run: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Where a run begins and ends, with its scene and the run that it goes on from; of a chain, its runs."""
    if "chain" in run.attrs:
        yield from json.loads(run.attrs["chain"])
        return
    start, end = _start(run), max(_end(run), float(run["reached"]))
    yield {
        "start": None if math.isinf(start) else start,
        "end": end,
        "scene": json.loads(run.attrs["scene"]),
        **{name: run.attrs[name] for name in ("started_from", "parent") if name in run.attrs},
    }


_MOST_LINES = 100
"""Lines of history taken over from the parts."""


def history_of(parts: Sequence[xr.Dataset], action: str) -> str:
    """Return the histories of the parts, each line once, and what has been done with them."""
    lines = list(dict.fromkeys(line for part in parts for line in part.attrs.get("history", "").splitlines()))
    if len(lines) > _MOST_LINES:
        lines = [*lines[: _MOST_LINES - 1], f"and {len(lines) - _MOST_LINES + 1} lines more"]
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    return "\n".join([*lines, f"{now} gearidae {gearidae.__version__}: {action}"])


def software_of(parts: Sequence[xr.Dataset]) -> dict[str, str]:
    """Return the software that computed the parts, as the attribute ``source``."""
    return {
        "source": "; ".join(dict.fromkeys(part.attrs["source"] for part in parts if "source" in part.attrs))
    }


def part_name(number: int) -> str:
    """Name one of the datasets in a message."""
    return f"dataset {number + 1}"
