"""The record of a run's extremes in SI units."""

from __future__ import annotations

import math
from array import array
from types import SimpleNamespace
from typing import Any

from gearidae.engine.model.state import PHASE, ROLLER, Floats, Model, V, W, plain
from gearidae.engine.observers.exposures.bins import ROWS, exposure_table
from gearidae.engine.observers.standing.judge import Judge
from gearidae.engine.observers.standing.units import standing_now
from gearidae.records import Extremes
from gearidae.records.extremes import ASPERITY_COUNTS, FORCE_EXTREMES, SPEED_EXTREMES, SPEEDS_NOW
from gearidae.records.quantity import in_si
from gearidae.records.standing import STANDING_NOW


def extremes_in_si(m: Model, judge: Judge, time: float, y: Floats) -> Extremes:
    """Take the extremes out of a model.

    Parameters
    ----------
    m : Model
        Its extremes include the state at `time`.
    judge : Judge
        Of the run.
    time : float
        Reached, over tau.
    y : ndarray, shape (n,)
        Scaled state there.
    """
    s, e = m.scene, plain(m.state.extremes)
    numbers = in_si(FORCE_EXTREMES, m.state.extremes, s) | in_si(ASPERITY_COUNTS, m.state, s)
    if s.kind == ROLLER:
        return Extremes(numbers, final_speed=float(-y[V] * s.length_unit / s.time_unit))
    numbers |= in_si(SPEED_EXTREMES, m.state.extremes, s)
    speeds = _speeds(e, float(s.phase_rate), time, float(y[PHASE] + m.state.whole_pitches))
    numbers |= in_si(SPEEDS_NOW, speeds | {"final_speed": float(y[W])}, s)
    numbers |= in_si(STANDING_NOW, standing := standing_now(m, judge, time, y), s)
    if not e.part[0]["begun"]:
        numbers["speed_fall"] = numbers["speed_rise"] = math.nan
    return Extremes(numbers, standstill_list=standing["standstill_list"], exposures=_exposures(m))


def _exposures(m: Model) -> array[float]:
    """What the flanks have been exposed to; see `gearidae.records.Extremes`."""
    if m.scene.bins == 0:
        return array("d")
    force, length = float(m.scene.force_unit), float(m.scene.length_unit)
    table = exposure_table(m).copy()
    table[:, ROWS.adhesion : ROWS.pressure] *= force * length
    table[:, ROWS.pressure] *= force
    table[:, ROWS.friction :] *= force * length
    return array("d", table.tobytes())


def _speeds(e: SimpleNamespace, rate: float, time: float, position: float) -> dict[str, Any]:
    """Means and spreads of the speed, and how long adhesion has held the gear, scaled; see `SPEEDS_NOW`."""
    parts = [plain(part) for part in e.part]
    means = [_mean(part, rate, time, position) for part in parts]
    spreads = [part.highest - part.lowest if part.begun else math.nan for part in parts]
    turns = e.turn_backs if e.is_stuck else 0
    return {
        "settled_gear_speed": means[0],
        "settled_spread": spreads[0],
        "late_gear_speed": means[1],
        "late_spread": spreads[1],
        "last_min_gear_speed": parts[2].lowest if parts[2].begun else math.nan,
        "turn_backs": turns,
        "time_adhering": e.adhering + (time - e.turn_back_time if turns > 1 else 0.0),
    }


def _mean(part: SimpleNamespace, rate: float, time: float, position: float) -> float:
    """Mean speed over the whole periods of harmonics in a part of the run, over all of it without one, scaled.

    `rate` is that of the phase at the speed 1.
    """
    if not part.begun:
        return math.nan
    if part.whole_time > part.time:
        time, position = part.whole_time, part.whole_position
    span = time - part.time
    return float((position - part.position) / (span * rate) if span > 0.0 else part.lowest)
