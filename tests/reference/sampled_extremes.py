"""Extremes of a run worked out from its samples, as a reference for what the engine keeps at its own steps."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from gearidae.records import Extremes

__all__ = ["with_extremes"]

START_UP, LAST, HELD_WITHIN = 0.05, 0.95, 0.5


def with_extremes(scene, solution):
    """Put the extremes of its samples into a solution; parts of a run are shares of what has been sampled."""
    x = solution.samples
    force, speed = (x["force"], x["speed"]) if scene.roller else (x["mesh_force"], x["gear_speed"])
    extremes = {
        "largest_mesh_force": force.max(),
        "smallest_mesh_force": force.min(),
        "final_speed": speed[-1],
    }
    if not scene.roller:
        extremes |= _of_gear(solution.time, speed, x["gear_angle"] * scene.gears.gear_teeth / (2.0 * math.pi))
    return dataclasses.replace(solution, extremes=Extremes(**extremes))


def _of_gear(time, speed, place):
    end = len(speed)
    settled, late = speed[int(START_UP * end) :], speed[end // 2 :]
    return {
        "min_gear_speed": speed.min(),
        "max_gear_speed": speed.max(),
        "settled_gear_speed": settled.mean(),
        "settled_spread": np.ptp(settled),
        "speed_fall": (np.maximum.accumulate(settled) - settled).max(),
        "speed_rise": (settled - np.minimum.accumulate(settled)).max(),
        "late_gear_speed": late.mean(),
        "late_spread": np.ptp(late),
        "last_min_gear_speed": speed[min(int(LAST * end), end - 1) :].min(),
        **_standing(time, **_standstill(time, speed, place)),
    }


def _standing(time, stick_time, turned_back):
    """What follows of a driven gear: free gears have turned on by three pitches."""
    back = turned_back > HELD_WITHIN
    stands = not math.isnan(stick_time) and not back
    return {
        "stick_time": stick_time if stands else math.nan,
        "back_time": stick_time if back else math.nan,
        "turned_back": turned_back if back else 0.0,
        "free_turned_back": 0.0,
        "free_advance": 3.0,
        "driven_time": time[-1],
        "followed_time": time[-1],
    }


def _standstill(time, speed, place):
    """Where the speed first fell to zero in the place where the gear still is."""
    if (speed <= 0.0).all():
        return {"stick_time": 0.0, "turned_back": max(place[0] - place[-1], 0.0)}
    held = None
    for k in 1 + np.flatnonzero((speed[1:] <= 0.0) & (speed[:-1] > 0.0)):
        if held is None or place[held:k].max() - place[held] > HELD_WITHIN:
            held = k
    if held is None or place[held:].max() - place[held] > HELD_WITHIN:
        return {"stick_time": math.nan, "turned_back": 0.0}
    return {"stick_time": time[held], "turned_back": max(place[held] - place[-1], 0.0)}
