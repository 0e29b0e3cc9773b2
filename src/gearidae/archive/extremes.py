"""The extremes of a run, read from its dataset."""

from __future__ import annotations

import json
import math

import xarray as xr

from gearidae.archive.variables import EXTREMES
from gearidae.records import Extremes
from gearidae.records.standing import COLUMNS


def standstills_as_text(extremes: Extremes) -> str:
    """Write the standstills of a run as JSON, which has no NaN: the end of one that lasts is null."""
    plain = [None if math.isnan(number) else number for number in extremes.standstill_list]
    return json.dumps([plain[k : k + len(COLUMNS)] for k in range(0, len(plain), len(COLUMNS))])


def standstills_from_text(text: str) -> list[list[float]]:
    """Read what `standstills_as_text` has written."""
    return [[math.nan if number is None else float(number) for number in row] for row in json.loads(text)]


def extremes_of(run: xr.Dataset) -> Extremes | None:
    """Read the extremes of one run.

    Parameters
    ----------
    run : xarray.Dataset
        A single run, or one picked from a sweep.

    Returns
    -------
    Extremes or None
        None if there are none: the run produced nothing, or has left no checkpoint yet.
    """
    if "final_speed" not in run.variables or math.isnan(float(run["final_speed"])):
        return None
    known = [name for name in EXTREMES if name in run.variables and name != "min_separation"]
    return Extremes({name: run[name].values.item() for name in known})
