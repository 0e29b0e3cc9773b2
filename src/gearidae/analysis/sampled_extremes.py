"""The extremes of a run that is not at its end, as far as the samples in its archive tell them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from gearidae.archive.pieces import first_above, pieces, reached, spread
from gearidae.archive.select import is_roller, scene_of
from gearidae.records import RUN_PARTS, Extremes

__all__ = ["extremes_of_samples"]

_START_UP, _HALF, _LAST = RUN_PARTS
_HELD_WITHIN = 0.5


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
    gear: dict[str, Any] = {} if roller else _of_gear(run, end)
    return Extremes(
        **gear,
        largest_mesh_force=force.high,
        smallest_mesh_force=force.low,
        final_speed=float(speed[end - 1]),
    )


def _of_gear(run: xr.Dataset, end: int) -> dict[str, float]:
    speed = run["gear_speed"]
    whole = spread(speed, 0, end)
    settled = spread(speed, int(_START_UP * end), end)
    late = spread(speed, int(_HALF * end), end)
    fall, rise = _fall_and_rise(speed, int(_START_UP * end), end)
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


def _fall_and_rise(speed: xr.DataArray, start: int, end: int) -> tuple[float, float]:
    """Largest fall below what had been reached before, and largest rise above the lowest until then."""
    top, bottom, fall, rise = -math.inf, math.inf, 0.0, 0.0
    for _, values in pieces(speed, start, end):
        highest = np.maximum.accumulate(np.maximum(values, top))
        lowest = np.minimum.accumulate(np.minimum(values, bottom))
        fall, rise = max(fall, float((highest - values).max())), max(rise, float((values - lowest).max()))
        top, bottom = float(highest[-1]), float(lowest[-1])
    return fall, rise


def _standstill(run: xr.Dataset, end: int) -> dict[str, float]:
    """Find where the speed first fell to zero in the place where the gear still is."""
    pitch = 2.0 * math.pi / int(scene_of(run)["gears"]["gear_teeth"])
    speed, angle = run["gear_speed"], run["gear_angle"]
    first, last = (float(angle.variable[k].values) / pitch for k in (0, end - 1))
    if not first_above(speed, 0.0) and float(speed.variable[0].values) <= 0.0:
        return {"stick_time": 0.0, "turned_back": max(first - last, 0.0)}
    # the sample where it came to stand, with its place, and how far it has been since
    held, farthest = None, -math.inf
    before = math.inf
    for start, values in pieces(speed, 0, end):
        places = angle.variable[start : start + values.size].values / pitch
        falls = np.flatnonzero((values <= 0.0) & (np.concatenate([[before], values[:-1]]) > 0.0))
        before, seen = float(values[-1]), 0
        for k in falls[falls + start > 0].tolist():
            farthest = max(farthest, float(places[seen:k].max(initial=-math.inf)))
            if held is None or farthest - held[1] > _HELD_WITHIN:
                held, farthest = (start + k, float(places[k])), -math.inf
            seen = k
        farthest = max(farthest, float(places[seen:].max(initial=-math.inf)))
    if held is None or farthest - held[1] > _HELD_WITHIN:
        return {"stick_time": math.nan, "turned_back": 0.0}
    return {
        "stick_time": float(run["time"].variable[held[0]].values),
        "turned_back": max(held[1] - last, 0.0),
    }
