"""The largest differences of two runs, each relative to the scale of its variable."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
import xarray as xr

from gearidae.archive.row_variables import DIMS
from gearidae.archive.select import run_scene, run_value, runs, swept_dims
from gearidae.archive.totals import balance_of
from gearidae.archive.variables import ENERGY_BALANCE, EVENTS, EXTREMES, OF_SWEPT_RUN, ROW_VARIABLES, RUN
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.records import EventKind, Impacts, Passages, Rows

if TYPE_CHECKING:
    import pandas as pd

COLUMNS: Final = ("difference", "scale", "relative", "where")
_LEFT_OUT: Final = {*RUN, *OF_SWEPT_RUN, *EVENTS, "residual", "residual_bound"}
"""Effort and errors of a run, which say nothing of its motion; events are compared as a sequence."""
_WHICH: Final = ("pair", "flank", "tooth", "sam_fraction")
"""What says which row it is."""
_EVENT: Final = ("event_time", "event_kind", "event_pair", "event_flank")
"""What events must have to be compared one by one."""
_ROWS: Final[tuple[type[Rows], ...]] = (Passages, Impacts)
"""Rows that are compared one by one."""
_NEEDED: Final = ("time", "pair", "flank")
"""What they must have for it."""
_EXCHANGED: Final = ("stored_change", "kinetic_change", "radius_work", "model_change")
"""Energies of either sign, which may cancel: their scale is that of all that has been exchanged."""


class Difference(NamedTuple):
    """Largest difference of one variable: its size, the scale of the variable, their ratio, and where it is."""

    difference: float
    scale: float
    relative: float
    where: str


def compare(a: xr.Dataset, b: xr.Dataset) -> pd.DataFrame:
    """Make a table of the largest differences of two runs, or of two sweeps run by run.

    Parameters
    ----------
    a, b : xarray.Dataset
        What `gearidae.simulate`, `gearidae.sweep` or `gearidae.open_archive` returned, with the same sample times and
        the same swept values. Their scenes may differ, for example in the tolerance.

    Returns
    -------
    pandas.DataFrame
        A row for each variable, the largest relative difference first. ``difference`` is in the unit of the variable
        and ``relative`` the same over ``scale``; ``where`` names the sample, the label or the event. Samples and losses
        have their largest magnitude as scale, speeds, forces and times of a run the largest speed, the largest force
        and the duration, energies of either sign all that has been exchanged. The row ``events`` has the largest
        difference of the times of events that are the same one by one, or infinity at the first that is another.
        Passages and impacts have a row for each of their variables, or where they are not of the same pairs
        ``passages`` or ``impacts`` has
        infinity. NaN equals NaN. Solver statistics, dates and the residual of the energy balance are left out.

    Raises
    ------
    SceneError
        If the datasets have no variable in common, other runs, or other sample times.
    """
    import pandas as pd

    _require_same_labels(a, b)
    largest: dict[str, Difference] = {}
    for (label, run), (_, other_run) in zip(runs(a), runs(b), strict=True):
        at = ", ".join(
            f"{dim}={value:g}" if isinstance(value, float) else f"{dim}={value}"
            for dim, value in label.items()
        )
        for name, difference in _differences(run, other_run):
            difference = difference._replace(where=", ".join(part for part in (at, difference.where) if part))
            if name not in largest or not difference.relative <= largest[name].relative:
                largest[name] = difference
    if not largest:
        raise SceneError("compare", "two datasets", "must have a variable in common")
    table = pd.DataFrame.from_dict(largest, orient="index", columns=COLUMNS)
    table.index.name = "variable"
    return table.sort_values("relative", ascending=False, kind="stable", na_position="first")


def _require_same_labels(a: xr.Dataset, b: xr.Dataset) -> None:
    """Refuse datasets whose runs or samples are not the same one by one."""
    dims = swept_dims(a)
    if dims != swept_dims(b):
        raise SceneError(
            "compare",
            f"runs along {swept_dims(b) or 'no dimension'}",
            f"must be runs along {dims or 'no dimension'}",
        )
    for name in (*dims, "time"):
        if (name in a.coords) != (name in b.coords):
            raise SceneError("compare", name, "must be a coordinate of both datasets")
        if name not in a.coords:
            continue
        if a.sizes[name] != b.sizes[name]:
            allowed = (
                f"must have as many values in both datasets, and not {a.sizes[name]} and {b.sizes[name]}"
            )
            raise SceneError("compare", name, f"{allowed}; pick common ones with ds.sel or ds.isel")
        labels, other_labels = a[name].values, b[name].values
        same = (
            labels == other_labels
            if labels.dtype.kind != "f"
            else np.isclose(labels, other_labels, rtol=1e-9, atol=0.0)
        )
        if not same.all():
            position = int(np.flatnonzero(~same)[0])
            raise SceneError(
                "compare",
                f"{name} {labels[position]} and {other_labels[position]}",
                "must have the same values in both datasets",
            )


def _differences(a: xr.Dataset, b: xr.Dataset) -> Iterator[tuple[str, Difference]]:
    """Go through the variables that two single runs have in common."""
    for name in ("status", "verdict"):
        words = [_word(run, name) for run in (a, b)]
        if None not in words:
            same = words[0] == words[1]
            yield (
                name,
                Difference(
                    math.nan, math.nan, 0.0 if same else math.inf, words[0] if same else " and ".join(words)
                ),
            )
    totals, other_totals = _totals(a), _totals(b)
    scales = _scales(a, totals, b, other_totals)
    for name in (total for total in totals if total in other_totals):
        yield name, _largest(np.array([totals[name]]), np.array([other_totals[name]]), scales.get(name))
    for key, variable in a.data_vars.items():
        name = str(key)
        if name in totals or name in _LEFT_OUT or name not in b.data_vars or {*DIMS} & {*variable.dims}:
            continue
        if variable.dtype.kind in "fiu" and variable.dims == b[name].dims:
            yield name, _of_samples(variable, b[name])
    if all(name in run for run in (a, b) for name in _EVENT):
        yield "events", _of_events(a, b)
    for kind in _ROWS:
        if all(f"{kind.dim}_{name}" in run for run in (a, b) for name in _NEEDED):
            yield from _of_rows(a, b, kind, scales)


def _word(run: xr.Dataset, name: str) -> Any:
    """Status or verdict of a run; None if it cannot be said."""
    if name == "status":
        return str(run_value(run, name)) if name in run.attrs or name in run.variables else None
    from gearidae.analysis.verdict import outcomes

    try:
        return outcomes(run)[0].verdict
    except (KeyError, SceneError):
        return None


def _totals(run: xr.Dataset) -> dict[str, float]:
    """Numbers of a whole run: its extremes and the terms of its energy balance."""
    totals = {name: float(run[name]) for name in EXTREMES if name in run.variables and not run[name].dims}
    balance = balance_of(run) or {}
    return totals | {name: value for name, value in balance.items() if name not in _LEFT_OUT}


def _scales(
    a: xr.Dataset, totals: Mapping[str, float], b: xr.Dataset, other_totals: Mapping[str, float]
) -> dict[str, float]:
    """Scales of the totals whose own size says little: they may be close to zero in a run that is not at rest."""

    def size(*names: str) -> float:
        return float(
            np.nanmax(
                [0.0, *(abs(run[name]) for run in (totals, other_totals) for name in names if name in run)]
            )
        )

    by_unit = {
        "rad s-1": size("min_gear_speed", "max_gear_speed"),
        "N": size("largest_mesh_force", "smallest_mesh_force"),
        "s": max(_duration(a), _duration(b)),
        "m": max(size("smallest_separation"), run_scene(a).surface.roughness),
        "1": 1.0,
    }
    scales = {
        name: max(size(name), by_unit.get(EXTREMES[name].units, 0.0)) for name in totals if name in EXTREMES
    }
    if "final_speed" in scales:
        scales["final_speed"] = size("final_speed", "min_gear_speed", "max_gear_speed")
    return scales | {
        name: max(size(name), size("throughput")) for name in _EXCHANGED if name in ENERGY_BALANCE
    }


def _duration(run: xr.Dataset) -> float:
    scene = run_scene(run)
    return float(scene.run.duration)


def _largest(a: Floats, b: Floats, scale: float | None = None) -> Difference:
    """Largest difference of two arrays, without its position; NaN equals NaN."""
    difference, _ = _where_largest(a, b)
    size = scale if scale is not None else _size(a, b)
    return Difference(difference, size, _relative(difference, size), "")


def _of_samples(a: xr.DataArray, b: xr.DataArray) -> Difference:
    """Largest difference of a variable along any dimensions, with the labels of its position."""
    values, other_values = np.asarray(a.values, dtype=float), np.asarray(b.values, dtype=float)
    difference, position = _where_largest(values, other_values)
    size = _size(values, other_values)
    labels = dict(zip(map(str, a.dims), position, strict=True))
    return Difference(
        difference,
        size,
        _relative(difference, size),
        ", ".join(_label(a, dim, at) for dim, at in labels.items()),
    )


def _label(variable: xr.DataArray, dim: Hashable, position: int) -> str:
    if dim not in variable.coords:
        return f"{dim} {position}"
    value = variable[dim].values[position]
    unit = variable[dim].attrs.get("units", "1")
    shown = f"{value:.6g}" if isinstance(value, np.floating) else str(value)
    return f"{dim}={shown}" + (f" {unit}" if unit != "1" else "")


def _where_largest(a: Floats, b: Floats) -> tuple[float, tuple[int, ...]]:
    """Size and position of the largest difference; infinite where only one is NaN."""
    if not a.size:
        return 0.0, (0,) * a.ndim
    with np.errstate(invalid="ignore"):
        apart = np.abs(a - b)
    apart = np.where((np.isnan(a) & np.isnan(b)) | (a == b), 0.0, np.where(np.isnan(apart), np.inf, apart))
    position = np.unravel_index(int(np.argmax(apart)), apart.shape)
    return float(apart[position]), tuple(int(index) for index in position)


def _size(a: Floats, b: Floats) -> float:
    """Largest finite magnitude of two arrays."""
    both = np.abs(np.concatenate([np.ravel(a), np.ravel(b)]))
    finite = both[np.isfinite(both)]
    return float(finite.max()) if finite.size else 0.0


def _relative(difference: float, scale: float) -> float:
    if difference == 0.0:
        return 0.0
    return difference / scale if scale > 0.0 else math.inf


def _of_events(a: xr.Dataset, b: xr.Dataset) -> Difference:
    """Compare events one by one: the same kinds of the same pairs in the same order, and their times."""
    counts = a.sizes["event"], b.sizes["event"]
    common = min(counts)
    other = np.zeros(common, dtype=bool)
    for name in ("event_kind", "event_pair", "event_flank", "event_asperity"):
        if name in a and name in b:
            other |= a[name].values[:common] != b[name].values[:common]
    span = max(_duration(a), _duration(b))
    if other.any() or counts[0] != counts[1]:
        first = int(np.flatnonzero(other)[0]) if other.any() else common
        words = " and ".join(_event_words(run, first) for run in (a, b))
        return Difference(math.inf, span, math.inf, f"event {first}: {words}")
    difference, position = _where_largest(a["event_time"].values, b["event_time"].values)
    at = f"in order, event {position[0]}: {_event_words(a, position[0])}" if common else "in order, no events"
    return Difference(difference, span, _relative(difference, span), at)


def _of_rows(
    a: xr.Dataset, b: xr.Dataset, kind: type[Rows], scales: Mapping[str, float]
) -> Iterator[tuple[str, Difference]]:
    """Compare rows one by one, over the scales of the whole run; infinite where they are not of the same pairs."""
    pairs, other_pairs = (
        np.stack([run[f"{kind.dim}_{name}"].values for name in ("pair", "flank")]) for run in (a, b)
    )
    if not np.array_equal(pairs, other_pairs):
        common = min(pairs.shape[1], other_pairs.shape[1])
        other = (pairs[:, :common] != other_pairs[:, :common]).any(axis=0)
        first = int(np.argmax(other)) if other.any() else common
        yield (
            kind.field,
            Difference(math.inf, math.nan, math.inf, f"{kind.dim} {first}: not of the same pair"),
        )
        return
    by_unit = {"N": scales.get("largest_mesh_force", 0.0), "s": max(_duration(a), _duration(b))}
    for name, variable in ROW_VARIABLES[kind].items():
        if name in a and name in b and (short := name.removeprefix(f"{kind.dim}_")) not in _WHICH:
            difference = _of_samples(a[name], b[name])
            total = scales.get(short, by_unit.get(variable.units, 0.0))
            size = max(difference.scale, total)
            yield name, difference._replace(scale=size, relative=_relative(difference.difference, size))


def _event_words(run: xr.Dataset, number: int) -> str:
    if number >= run.sizes["event"]:
        return f"no more than {run.sizes['event']} events"
    kind = EventKind(int(run["event_kind"].values[number])).name.lower()
    return f"{kind} of pair {int(run['event_pair'].values[number])} at {float(run['event_time'].values[number]):.6g} s"
