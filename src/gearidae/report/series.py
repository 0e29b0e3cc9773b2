"""The time series of a report, packed for the viewer in the page."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.pieces import PIECE, count, pieces
from gearidae.archive.select import is_roller, runs
from gearidae.archive.variables import SAMPLES
from gearidae.drawing.style import MOST_RUNS, run_labels, runs_of
from gearidae.errors import SceneError
from gearidae.records import EventKind, sampled_columns
from gearidae.report import html
from gearidae.report.outcomes import ascending, numbers_ascending, pack_outcomes

MOST_VALUES = 1_500_000
"""Numbers a page holds at most (8 MB of text); longer series are reduced to the extremes of intervals."""
MOST_OF_MANY = 500_000
"""Numbers that a page holds at most (2.7 MB of text) of more runs than one picture shows."""
_MOST_EVENTS = 2000
"""Times of contacts made, and broken, of a run."""
_MOST_OF_ALL = 14_000
"""Times of contacts made, and broken, of all runs."""
_SHOWN_FIRST = ("gear_speed", "gear_contact_torque", "height", "force")


def pack(ds: xr.Dataset, most_values: int | None = None) -> dict[str, Any]:
    """Pack samples and contact events of all runs for the viewer.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep.
    most_values : int, optional
        Numbers to embed at most, shared by the runs; by default `MOST_VALUES`, of more than seven runs `MOST_OF_MANY`.

    Returns
    -------
    dict
        ``end`` [s], ``reduced`` (samples per interval, 1 if none were left out), ``series`` (name, label,
        unit, shown, and per run the base64 text of little-endian float32 values on a uniform grid from 0 to
        ``end``), ``runs`` (label and times of onsets and separations [s]), ``outcomes`` from
        `gearidae.report.outcomes.pack_outcomes`, in whose order the runs are, ``chosen`` (which of them are drawn
        first: those of the pictures, in their order) and ``most`` (that are drawn at once). Empty without samples.
    """
    names = [name for name in sampled_columns(roller=is_roller(ds)) if name in ds]
    samples = ds.sizes.get("time", 0)
    try:
        shown = runs_of(ds, names[0]) if names and samples else []
    except SceneError:  # no run has samples
        return {}
    if not shown:
        return {}
    order, sorted_ds = numbers_ascending(ds), ascending(ds)
    members = list(runs(sorted_ds))
    if most_values is None:
        most_values = MOST_VALUES if len(members) <= MOST_RUNS else MOST_OF_MANY
    share = max(2, most_values // (len(names) * len(members)))
    size = block(samples, share)
    most_events = min(_MOST_EVENTS, _MOST_OF_ALL // len(members))
    series = []
    for name in names:
        variable = SAMPLES[name]
        series.append(
            {
                "name": name,
                "label": variable.long_name,
                "unit": "" if variable.units == "1" else variable.units,
                "shown": name in _SHOWN_FIRST,
                "runs": [html.numbers(reduced(run[name], size)) for _, run in members],
            }
        )
    return {
        "end": float(ds["time"][-1]),
        "samples": samples,
        "reduced": size,
        "series": series,
        "runs": [
            {"label": label or "run", **_contacts(run, most_events)}
            for label, (_, run) in zip(run_labels(members), members, strict=True)
        ],
        "outcomes": pack_outcomes(sorted_ds),
        "chosen": [order.index(run.number) for run in shown],
        "most": MOST_RUNS,
    }


def block(samples: int, share: int) -> int:
    """Samples per interval so that two values of each interval are at most `share` values."""
    return 1 if samples <= share else -(-2 * samples // share)


def reduced(values: xr.DataArray, size: int) -> NDArray[np.float64]:
    """Reduce a variable of any length, read in pieces of whole intervals."""
    step = max(1, PIECE // size) * size
    return np.concatenate([_extremes(part, size) for _, part in pieces(values, size=step)])


def _extremes(values: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    """Keep the smallest and the largest value of every interval of `size` samples, in their order."""
    if size == 1:
        return values
    whole = -(-len(values) // size) * size
    padded = np.concatenate([values, np.full(whole - len(values), values[-1])]).reshape(-1, size)
    low, high = np.where(np.isnan(padded), np.inf, padded), np.where(np.isnan(padded), -np.inf, padded)
    first, second = low.argmin(axis=1), high.argmax(axis=1)
    rows = np.arange(len(padded))
    pairs = np.stack(
        [padded[rows, np.minimum(first, second)], padded[rows, np.maximum(first, second)]], axis=1
    )
    return pairs.reshape(-1)


def _contacts(run: xr.Dataset, most: int) -> dict[str, list[float]]:
    """Times of contacts made and broken [s], evenly picked where there are very many; none if no events are kept."""
    return {
        name: [float(f"{time:.9g}") for time in _times(run, kind, most)]
        for name, kind in (("onsets", EventKind.ONSET), ("separations", EventKind.SEPARATION))
    }


def _times(run: xr.Dataset, kind: EventKind, most: int) -> NDArray[np.float64]:
    """Times of the events of a kind, evenly picked where there are more than `most`."""
    if "event_kind" not in run:
        return np.empty(0)
    total = count(run["event_kind"], kind)
    wanted = np.linspace(0, total - 1, min(total, most)).astype(int)
    parts, passed = [np.empty(0)], 0
    for offset, kinds in pieces(run["event_kind"]):
        indices = offset + np.flatnonzero(kinds == kind)
        here = wanted[(wanted >= passed) & (wanted < passed + indices.size)] - passed
        if here.size:
            first = int(indices[here[0]])
            times = run["event_time"].variable[first : int(indices[here[-1]]) + 1].values
            parts.append(times[indices[here] - first])
        passed += indices.size
    return np.concatenate(parts)
