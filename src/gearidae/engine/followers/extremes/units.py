"""The record of a run's extremes in SI units."""

from __future__ import annotations

import math
from array import array
from types import SimpleNamespace
from typing import Any

from gearidae.engine.followers.exposures.bins import ROWS, exposure_table
from gearidae.engine.followers.standing.units import standing_in_si
from gearidae.engine.model.state import PHASE, ROLLER, Floats, Model, V, W, plain
from gearidae.records import Extremes


def extremes_in_si(m: Model, place: int, time: float, y: Floats) -> Extremes:
    """Take the extremes out of a model.

    Parameters
    ----------
    m : Model
        Its extremes include the state at `time`.
    place : int
        Of the model, from `gearidae.engine.model.located.Located`.
    time : float
        Reached, over tau.
    y : ndarray, shape (n,)
        Scaled state there.
    """
    s, e = m.scene, plain(m.state.extremes)
    force, tau = float(s.force_unit), float(s.time_unit)
    forces: dict[str, Any] = {
        "asperity_onsets": int(m.state.asperity_onsets),
        "asperity_detachments": int(m.state.asperity_detachments),
        "largest_mesh_force": force * e.largest_force,
        "largest_mesh_force_time": tau * e.largest_force_time,
        "smallest_mesh_force": force * e.smallest_force,
        "smallest_mesh_force_time": tau * e.smallest_force_time,
        "smallest_separation": float(s.length_unit) * e.separation,
    }
    if s.kind == ROLLER:
        return Extremes(**forces, final_speed=float(y[V] * s.length_unit / s.time_unit))
    speed = float(s.length_unit / (s.time_unit * s.gear_radius))
    position = float(y[PHASE] + m.state.turns)
    rate, part = float(s.phase_rate), [plain(one) for one in e.part]
    means = [_mean(one, rate, time, position) for one in part]
    spreads = [speed * (one.highest - one.lowest) if one.begun else math.nan for one in part]
    settled = bool(part[0].begun)
    return Extremes(
        **forces,
        min_gear_speed=speed * e.lowest_speed,
        max_gear_speed=speed * e.highest_speed,
        settled_gear_speed=speed * means[0],
        settled_spread=spreads[0],
        speed_fall=speed * e.fall if settled else math.nan,
        speed_rise=speed * e.rise if settled else math.nan,
        late_gear_speed=speed * means[1],
        late_spread=spreads[1],
        last_min_gear_speed=speed * part[2].lowest if part[2].begun else math.nan,
        final_speed=speed * float(y[W]),
        **_time_adhering(e, tau, time),
        **standing_in_si(m, place, time, y),
        mesh_exits=e.mesh_exits,
        reversals=e.reversals,
        exposures=_exposures(m),
    )


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


def _time_adhering(e: SimpleNamespace, tau: float, time: float) -> dict[str, Any]:
    """How often adhesion has turned the gear back where it is, and how long it has held it."""
    turns = e.turn_backs if e.is_stuck else 0
    return {
        "turn_backs": turns,
        "time_adhering": tau * (e.adhering + (time - e.turn_back_time if turns > 1 else 0.0)),
    }


def _mean(part: SimpleNamespace, rate: float, time: float, position: float) -> float:
    """Mean speed over a part of the run, scaled; `rate` is that of the phase at the speed 1."""
    span = time - part.time
    if not part.begun:
        return math.nan
    return float((position - part.position) / (span * rate) if span > 0.0 else part.lowest)
