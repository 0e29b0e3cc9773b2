"""The record of a run's extremes in SI units."""

from __future__ import annotations

import math
from array import array
from typing import Any

from gearidae.engine.energy.exposures import PRESSURE, QUANTITIES
from gearidae.engine.model.checkpoint import exposures_of
from gearidae.engine.model.state import MATERIALS, PHASE, ROLLER, Floats, Model, Record, V, W
from gearidae.records import Extremes

__all__ = ["extremes_in_si"]


def extremes_in_si(m: Model, time: float, y: Floats) -> Extremes:
    """Take the extremes out of a model.

    Parameters
    ----------
    m : Model
        Its extremes include the state at `time`.
    time : float
        Reached, over tau.
    y : ndarray, shape (n,)
        Scaled state there.
    """
    s, e = m.scene, m.state.extremes
    force, tau = float(s.force_unit), float(s.time_unit)
    forces: dict[str, Any] = {
        "largest_mesh_force": force * float(e.largest_force),
        "largest_mesh_force_time": tau * float(e.largest_force_time),
        "smallest_mesh_force": force * float(e.smallest_force),
        "smallest_mesh_force_time": tau * float(e.smallest_force_time),
        "smallest_separation": float(s.length_unit * e.separation),
    }
    if s.kind == ROLLER:
        return Extremes(**forces, final_speed=float(y[V] * s.length_unit / s.time_unit))
    speed = float(s.length_unit / (s.time_unit * s.gear_radius))
    place = float(y[PHASE] + m.state.turns)
    means = [_mean(m, part, time, place) for part in e.part]
    spreads = [speed * float(part.highest - part.lowest) if part.begun else math.nan for part in e.part]
    settled = bool(e.part[0].begun)
    return Extremes(
        **forces,
        min_gear_speed=speed * float(e.lowest_speed),
        max_gear_speed=speed * float(e.highest_speed),
        settled_gear_speed=speed * means[0],
        settled_spread=spreads[0],
        speed_fall=speed * float(e.fall) if settled else math.nan,
        speed_rise=speed * float(e.rise) if settled else math.nan,
        late_gear_speed=speed * means[1],
        late_spread=spreads[1],
        last_min_gear_speed=speed * float(e.part[2].lowest) if e.part[2].begun else math.nan,
        final_speed=speed * float(y[W]),
        **_standstill(e, tau, time, place),
        mesh_exits=int(e.mesh_exits),
        reversals=int(e.reversals),
        exposures=_exposures(m),
    )


def _exposures(m: Model) -> array[float]:
    """What the flanks have been exposed to; see `gearidae.records.Extremes`."""
    if m.scene.places == 0:
        return array("d")
    force, length = float(m.scene.force_unit), float(m.scene.length_unit)
    table = exposures_of(m).reshape(-1, QUANTITIES, int(m.scene.places)).copy()
    table[:, MATERIALS:PRESSURE] *= force * length
    table[:, PRESSURE] *= force
    return array("d", table.tobytes())


def _standstill(e: Record, tau: float, time: float, place: float) -> dict[str, Any]:
    """Where and when the gear came to stand, and how long adhesion has held it."""
    if e.held:
        return {
            "stick_time": tau * float(e.held_time),
            "stick_exits": int(e.held_exits),
            "turned_back": max(float(e.held_place) - place, 0.0),
            "turn_backs": int(e.turn_backs),
            "time_adhering": tau * float(e.adhering + (time - e.turn_back_time if e.turn_backs > 1 else 0.0)),
        }
    never_moved = bool(e.highest_speed <= 0.0)
    return {
        "stick_time": 0.0 if never_moved else math.nan,
        "stick_exits": int(e.mesh_exits),
        "turned_back": max(-place, 0.0) if never_moved else 0.0,
        "turn_backs": 0,
        "time_adhering": tau * float(e.adhering),
    }


def _mean(m: Model, part: Record, time: float, place: float) -> float:
    """Mean speed over a part of the run, scaled."""
    span = time - float(part.time)
    if not part.begun:
        return math.nan
    if span <= 0.0:
        return float(part.lowest)
    return (place - float(part.place)) / float(span * m.scene.phase_rate)
