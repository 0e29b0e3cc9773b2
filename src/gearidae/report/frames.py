"""Runs of a dataset as pictures in a row and curves over time, packed for the page of `explore`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from gearidae.archive.pieces import pieces
from gearidae.arrays import Floats
from gearidae.report import html
from gearidae.report.outcomes import pack_outcomes
from gearidae.report.series import block

_MOST_FRAMES = 6000


class Thinning(NamedTuple):
    """How much of a record a page holds.

    Attributes
    ----------
    every : int
        Samples for each picture.
    size : int
        Samples of an interval of which a curve keeps the smallest and the largest value, 1 if it keeps all.
    """

    every: int
    size: int


class ShownRun(NamedTuple):
    """What a page holds of one run.

    Attributes
    ----------
    gears : int
        Number of its gears among all.
    frames : ndarray, shape (n, columns)
        Samples of its pictures.
    curves : list of ndarray
        Curves over time.
    """

    gears: int
    frames: Floats
    curves: list[Floats]


def thinning(samples: int, runs: int, columns: int, curves: int, most_values: int) -> Thinning:
    """Share the numbers of a page among its runs: of a curve, four for each picture.

    Parameters
    ----------
    samples : int
        Of the longest run.
    runs : int
    columns, curves : int
        Numbers of a picture, and curves of a run.
    most_values : int
        Numbers to embed at most.
    """
    share = max(2, min(_MOST_FRAMES, most_values // ((columns + 2 * curves) * runs)))
    return Thinning(max(1, math.ceil((samples - 1) / (share - 1))), block(samples, 2 * share))


def picked(values: xr.DataArray, every: int, count: int) -> Floats:
    """One of so many of the first values, read piece by piece."""
    parts = [part[-first % every :: every] for first, part in pieces(values, 0, count)]
    return np.concatenate([np.empty(0), *parts])


def largest_of(values: Floats) -> float:
    """Largest magnitude of some values, 0 if none is finite."""
    return float(np.max(np.abs(values), initial=0.0, where=np.isfinite(values)))


def range_of(curves: Sequence[Floats]) -> list[float]:
    """Smallest and largest value of some curves."""
    values = np.concatenate(curves)
    values = values[np.isfinite(values)]
    return [float(values.min()), float(values.max())] if values.size else [0.0, 0.0]


def pack_frames(
    ds: xr.Dataset, columns: Sequence[str], every: int, gears: Sequence[Any], shown: Sequence[ShownRun]
) -> dict[str, Any]:
    """Pack the runs of a dataset, from `gearidae.report.outcomes.ascending`, up to its last sample.

    Returns
    -------
    dict
        What `gearidae.report.outcomes.pack_outcomes` packs, and ``columns``, ``every`` (samples a picture), ``start``
        and ``end`` [s], numbers of ``samples`` and ``frames``, ``gears``, and ``runs``: which gears, ``frames`` and
        ``curves`` as text from `gearidae.report.html.numbers`.
    """
    samples = ds.sizes["time"]
    return {
        **pack_outcomes(ds),
        "columns": list(columns),
        "every": every,
        "start": float(ds["time"][0]),
        "end": float(ds["time"][-1]),
        "samples": samples,
        "frames": math.ceil(samples / every),
        "gears": list(gears),
        "runs": [
            {
                "gears": run.gears,
                "frames": html.numbers(run.frames),
                "curves": [html.numbers(curve) for curve in run.curves],
            }
            for run in shown
        ],
    }
