"""The extremes of runs in a dataset: variables without a dimension of a single run, along the swept ones of a sweep."""

from __future__ import annotations

import json
import math
from collections.abc import Hashable, Sequence
from dataclasses import fields
from typing import Any

import numpy as np
import xarray as xr

from gearidae.archive.variables import EXTREMES, ROLLER_EXTREMES, STANDSTILL_LIST, extreme_names
from gearidae.records import Extremes
from gearidae.records.standing import COLUMNS
from gearidae.scene import Scene


def extreme_variables(
    scene: Scene, runs: Sequence[Extremes | None], dims: tuple[str, ...] = (), shape: tuple[int, ...] = ()
) -> dict[Hashable, Any]:
    """Make the variables of the runs' extremes.

    Parameters
    ----------
    scene : Scene
        That the runs were derived from.
    runs : sequence of Extremes or None
        Of each run; None where it produced nothing.
    dims, shape : tuple, optional
        Swept dimensions and their lengths.

    Returns
    -------
    dict
        Name to dimensions, values and attributes. NaN, and 0 of counts, where a run produced nothing; empty if none
        did.
    """
    if all(extremes is None for extremes in runs):
        return {}
    names = list(extreme_names(scene.roller is not None, scene.contact.model))
    if scene.contact.model == "elastic":  # of these it is sampled
        names.remove("min_separation")
    made: dict[Hashable, Any] = {}
    catalogue = EXTREMES if scene.roller is None else ROLLER_EXTREMES
    for name in names:
        variable = catalogue[name]
        nothing = 0 if variable.dtype is np.int64 else math.nan
        field = "smallest_separation" if name == "min_separation" else name
        values = [getattr(extremes, field, nothing) for extremes in runs]
        made[name] = (dims, np.array(values, dtype=variable.dtype).reshape(shape), variable.attributes)
    if scene.roller is None:
        lists = np.empty(len(runs), dtype=object)
        lists[:] = [standstills_as_text(extremes) for extremes in runs]
        made[STANDSTILL_LIST.name] = (dims, lists.reshape(shape), STANDSTILL_LIST.attributes)
    return made


def standstills_as_text(extremes: Extremes | None) -> str:
    """Write the standstills of a run as JSON, which has no NaN: the end of one that lasts is null."""
    numbers = [] if extremes is None else list(extremes.standstill_list)
    plain = [None if math.isnan(number) else number for number in numbers]
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
    numbers: dict[str, Any] = {}
    for field in fields(Extremes):
        if field.name in ("exposures", "standstill_list"):  # variables of their own
            continue
        counts = EXTREMES[field.name].dtype is np.int64
        if field.name in run.variables:
            numbers[field.name] = run[field.name].values.item()
        else:
            numbers[field.name] = 0 if counts else math.nan
    return Extremes(**numbers)
