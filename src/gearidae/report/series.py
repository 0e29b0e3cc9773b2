"""The time series of a report, packed for the viewer in the page."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.select import is_roller, runs
from gearidae.archive.variables import SAMPLES, columns
from gearidae.plot.style import runs_of
from gearidae.records import EventKind

__all__ = ["MOST_VALUES", "pack"]

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
    names = [name for name in columns(is_roller(ds)) if name in ds]
    time = ds["time"].values
    if not names or not len(time) or not any(np.isfinite(ds[name].values).any() for name in names):
        return {}
    shown = runs_of(ds, names[0])
    share = max(2, most_values // (len(names) * len(shown)))
    size = _block(len(time), share)
    series = []
    for name in names:
        variable = SAMPLES[name]
        series.append(
            {
                "name": name,
                "label": variable.long_name,
                "unit": "" if variable.units == "1" else variable.units,
                "shown": name in _SHOWN_FIRST,
                "runs": [_encode(_extremes(run.data[name].values, size)) for run in shown],
            }
        )
    return {
        "end": float(time[-1]),
        "samples": len(time),
        "reduced": size,
        "series": series,
        "runs": [{"label": run.label or "run", **_contacts(run.data)} for run in shown],
        "of": sum(1 for _ in runs(ds)),
    }


def _block(samples: int, share: int) -> int:
    """Samples per interval so that two values of each interval are at most `share` values."""
    return 1 if samples <= share else -(-2 * samples // share)


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


def _encode(values: NDArray[np.float64]) -> str:
    return base64.b64encode(values.astype("<f4").tobytes()).decode("ascii")


def _contacts(run: xr.Dataset) -> dict[str, list[float]]:
    """Times of contacts made and broken [s], evenly picked where there are very many."""
    found = {}
    for name, kind in (("onsets", EventKind.ONSET), ("separations", EventKind.SEPARATION)):
        times = run["event_time"].values[run["event_kind"].values == kind]
        if len(times) > _MOST_EVENTS:
            times = times[np.linspace(0, len(times) - 1, _MOST_EVENTS).astype(int)]
        found[name] = [float(f"{time:.9g}") for time in times]
    return found
