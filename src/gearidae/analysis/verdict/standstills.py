"""Standstills of the runs of a dataset, with the verdict of each."""

from __future__ import annotations

import math
from typing import Any

import xarray as xr

from gearidae.analysis.verdict.judge import standing_verdict
from gearidae.archive.select import runs, swept_dims
from gearidae.archive.totals import standstills_from_text
from gearidae.archive.variables import STANDSTILL_LIST
from gearidae.errors import SceneError
from gearidae.records.standing import COLUMNS, Holding

_SHOWN = ("begin", "end", "advance", "free_advance", "held_torque", "held_by", "verdict", "rest_time")


def standstill_rows(ds: xr.Dataset) -> tuple[list[str], list[list[Any]]]:
    """Return names and rows of the table of standstills.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run, a sweep, or a selection from one.

    Raises
    ------
    SceneError
        If the runs have not kept their standstills.
    """
    if STANDSTILL_LIST.name not in ds.variables:
        raise SceneError(
            "standstills",
            "(not kept)",
            "need runs of gears of this version; a sweep keeps them with its extremes",
        )
    rows = [
        [*label.values(), *(standstill[name] for name in _SHOWN)]
        for label, run in runs(ds)
        for standstill in _of_run(run)
    ]
    return [*swept_dims(ds), *_SHOWN], rows


def _of_run(run: xr.Dataset) -> list[dict[str, Any]]:
    standstills = []
    for numbers in standstills_from_text(run[STANDSTILL_LIST.name].item() or "[]"):
        standstill: dict[str, Any] = dict(zip(COLUMNS, numbers, strict=True))
        end = float(run["followed_time"]) if math.isnan(standstill["end"]) else standstill["end"]
        standstill["held_by"] = Holding(int(standstill["holding"])).words
        standstill["verdict"] = standing_verdict(standstill["free_advance"], standstill["driven_time"], end)
        standstills.append(standstill)
    return standstills
