"""The extremes of a run that is not at its end, as far as the samples in its archive tell them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from gearidae.archive.pieces import first_above, reached, spread
from gearidae.archive.select import is_roller, scene_of
from gearidae.records import Extremes

__all__ = ["extremes_of_samples"]

_START_UP, _LAST, _HELD_WITHIN = 0.05, 0.95, 0.5


def extremes_of_samples(run: xr.Dataset) -> Extremes | None:
    """Work out a run's extremes from its samples; None if it has none.

    Parameters
    ----------
    run : xarray.Dataset
        A single run. Parts of it are shares of what has been sampled.
    """
    roller = is_roller(run)
    force, speed = spread(run["force" if roller else "mesh_force"]), run["speed" if roller else "gear_speed"]
    end = reached(speed)
    if not end:
        return None
    shown: dict[str, Any] = dict.fromkeys(_FLOATS, math.nan) | {
        "largest_mesh_force": force.high,
        "smallest_mesh_force": force.low,
        "final_speed": float(speed[end - 1]),
    }
    counts: dict[str, Any] = dict.fromkeys(("reversals", "turn_backs", "stick_exits", "mesh_exits"), 0)
    return Extremes(**shown, **counts) if roller else Extremes(**(shown | _of_gear(run, end)), **counts)


_FLOATS = (
    "min_gear_speed",
    "max_gear_speed",
    "settled_gear_speed",
    "settled_spread",
    "speed_fall",
    "speed_rise",
    "late_gear_speed",
    "late_spread",
    "last_min_gear_speed",
    "stick_time",
    "turned_back",
    "time_adhering",
    "largest_mesh_force",
    "largest_mesh_force_time",
    "smallest_mesh_force",
    "smallest_mesh_force_time",
    "smallest_separation",
    "final_speed",
)


def _of_gear(run: xr.Dataset, end: int) -> dict[str, float]:
    speed = run["gear_speed"]
    whole = spread(speed, 0, end)
    settled = spread(speed, int(_START_UP * end), end)
    late = spread(speed, end // 2, end)
    values = speed.values[int(_START_UP * end) : end]
    fall = float(np.max(np.maximum.accumulate(values) - values))
    rise = float(np.max(values - np.minimum.accumulate(values)))
    return {
        "min_gear_speed": whole.low,
        "max_gear_speed": whole.high,
        "settled_gear_speed": settled.mean,
        "settled_spread": settled.high - settled.low,
        "speed_fall": fall,
        "speed_rise": rise,
        "late_gear_speed": late.mean,
        "late_spread": late.high - late.low,
        "last_min_gear_speed": spread(speed, min(int(_LAST * end), end - 1), end).low,
        **_standstill(run, end),
    }


def _standstill(run: xr.Dataset, end: int) -> dict[str, float]:
    """Find where the speed first fell to zero in the place where the gear still is."""
    speed, time = run["gear_speed"].values[:end], run["time"].values[:end]
    place = run["gear_angle"].values[:end] * int(scene_of(run)["gears"]["gear_teeth"]) / (2.0 * math.pi)
    if not first_above(run["gear_speed"], 0.0) and speed[0] <= 0.0:
        return {"stick_time": 0.0, "turned_back": max(float(place[0] - place[-1]), 0.0)}
    held = None
    for k in np.flatnonzero((speed[1:] <= 0.0) & (speed[:-1] > 0.0)) + 1:
        if held is None or place[held:k].max() - place[held] > _HELD_WITHIN:
            held = int(k)
    if held is None or place[held:].max() - place[held] > _HELD_WITHIN:
        return {"stick_time": math.nan, "turned_back": 0.0}
    return {"stick_time": float(time[held]), "turned_back": max(float(place[held] - place[-1]), 0.0)}
