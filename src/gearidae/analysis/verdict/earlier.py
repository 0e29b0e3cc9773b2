"""Verdicts of archives of version 0.2, which have not kept what free gears would have done.

Where the drive exceeds the dry load at any time, or at none, the verdict follows from what they have kept. Else it is
that of their own rule, and is said to be old.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from gearidae.records import Extremes
from gearidae.records.standing import HALF_PITCH

OLD = "; judged by the rule of version 0.2, run it again for the present one"
"""What is added to the words of such a verdict."""


def is_earlier(extremes: Extremes) -> bool:
    """Whether a run of gears has been kept without what free gears would have done."""
    return math.isnan(extremes.followed_time)


def earlier_verdict(
    extremes: Extremes, status: str, scene: Mapping[str, Any], *, scheduled: bool
) -> tuple[str | None, bool]:
    """Judge a run of version 0.2.

    Parameters
    ----------
    extremes : Extremes
        Of the run; its `stick_time` is that of a fall of the speed to zero where the gear still is, or goes back from.
    status : str
        How the run ended.
    scene : mapping
        As `Scene.to_dict` gives it.
    scheduled : bool
        As for `gear_verdict`.

    Returns
    -------
    verdict : str or None
        None where the gear has turned on, which is judged as at present.
    old : bool
        Whether it is that of the rule of version 0.2.
    """
    if math.isnan(extremes.stick_time) or (scheduled and status != "finished"):
        return None, False
    weakest, strongest = _drive_beyond_load(scene)
    if extremes.turned_back > HALF_PITCH:
        return ("turns back", False) if weakest > 0.0 and _turns_back(scene) else ("runs back", scheduled)
    if weakest > 0.0:
        return "sticks", False
    if strongest <= 0.0:
        return "stops", False
    if scheduled and extremes.last_min_gear_speed > 0.0:
        return "runs", True
    return ("stops" if scheduled else "sticks"), True


def _drive_beyond_load(scene: Mapping[str, Any]) -> tuple[float, float]:
    """Least and largest torque of the drive at a gear at rest, without its sign, less the dry load [N m]."""
    gears, drive, load = (scene.get(name) or {} for name in ("gears", "drive", "load"))
    if drive.get("law") or load.get("law") or drive.get("speed") is not None:
        return -math.inf, math.inf
    ratio = gears["gear_teeth"] / gears["pinion_teeth"]
    low, high = _range(drive)
    least_dry, most_dry = (max(value, 0.0) for value in _range(load))
    size = 0.0 if low <= 0.0 <= high else min(abs(low), abs(high))
    return ratio * size - most_dry, ratio * max(abs(low), abs(high)) - least_dry


def _turns_back(scene: Mapping[str, Any]) -> bool:
    return _range(scene.get("drive") or {})[1] < 0.0


def _range(shaft: Mapping[str, Any]) -> tuple[float, float]:
    """Least and largest torque of a shaft [N m], of all times and angles."""
    constant = float(shaft.get("torque") or 0.0)
    amplitude = sum(abs(float(harmonic["amplitude"])) for harmonic in shaft.get("harmonic") or [])
    schedule = shaft.get("schedule") or []
    knots = schedule["knots"] if isinstance(schedule, Mapping) else schedule
    values = [float(value) for _, value in knots] or [0.0]
    return constant + min(values) - amplitude, constant + max(values) + amplitude
