"""The time series of a report, packed for the viewer in the page."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.pieces import PIECE, count, pieces
from gearidae.archive.select import is_roller, runs
from gearidae.archive.variables import SAMPLES
from gearidae.drawing.style import runs_of
from gearidae.errors import SceneError
from gearidae.records import EventKind, sampled_columns
from gearidae.report import html

MOST_VALUES = 1_500_000
"""Numbers a page holds at most (8 MB of text); longer series are reduced to the extremes of intervals."""
_MOST_EVENTS = 2000
_SHOWN_FIRST = ("gear_speed", "gear_contact_torque", "height", "force")


def pack(ds: xr.Dataset, most_values: int = MOST_VALUES) -> dict[str, Any]:
    """Pack samples and contact events for the viewer.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep; of more than seven runs, seven are packed, as in the pictures.
    most_values : int, optional
        Numbers to embed at most.

    Returns
    -------
    dict
        ``end`` [s], ``reduced`` (samples per interval, 1 if none were left out), ``series`` (name, label,
        unit, shown, and per run the base64 text of little-endian float32 values on a uniform grid from 0 to
        ``end``), ``runs`` (label and times of onsets and separations [s]). Empty without samples.
    """
    names = [name for name in sampled_columns(roller=is_roller(ds)) if name in ds]
    samples = ds.sizes.get("time", 0)
    try:
        shown = runs_of(ds, names[0]) if names and samples else []
    except SceneError:  # no run has samples
        return {}
    if not shown:
        return {}
    share = max(2, most_values // (len(names) * len(shown)))
    size = block(samples, share)
    series = []
    for name in names:
        variable = SAMPLES[name]
        series.append(
            {
                "name": name,
                "label": variable.long_name,
                "unit": "" if variable.units == "1" else variable.units,
                "shown": name in _SHOWN_FIRST,
                "runs": [html.numbers(reduced(run.data[name], size)) for run in shown],
            }
        )
    return {
        "end": float(ds["time"][-1]),
        "samples": samples,
        "reduced": size,
        "series": series,
        "runs": [{"label": run.label or "run", **_contacts(run.data)} for run in shown],
        "of": sum(1 for _ in runs(ds)),
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


def _contacts(run: xr.Dataset) -> dict[str, list[float]]:
    """Times of contacts made and broken [s], evenly picked where there are very many; none if no events are kept."""
    return {
        name: [float(f"{time:.9g}") for time in _times(run, kind)]
        for name, kind in (("onsets", EventKind.ONSET), ("separations", EventKind.SEPARATION))
    }


def _times(run: xr.Dataset, kind: EventKind) -> NDArray[np.float64]:
    """Times of the events of a kind, at most `_MOST_EVENTS` of them."""
    if "event_kind" not in run:
        return np.empty(0)
    total = count(run["event_kind"], kind)
    wanted = np.linspace(0, total - 1, min(total, _MOST_EVENTS)).astype(int)
    parts, passed = [np.empty(0)], 0
    for place, kinds in pieces(run["event_kind"]):
        places = place + np.flatnonzero(kinds == kind)
        here = wanted[(wanted >= passed) & (wanted < passed + places.size)] - passed
        if here.size:
            first = int(places[here[0]])
            times = run["event_time"].variable[first : int(places[here[-1]]) + 1].values
            parts.append(times[places[here] - first])
        passed += places.size
    return np.concatenate(parts)
