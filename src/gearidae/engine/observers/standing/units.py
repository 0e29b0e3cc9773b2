"""Where a gear stands, in SI units and pitches."""

from __future__ import annotations

import math
from array import array
from typing import Any

import numpy as np

from gearidae.engine.model.record_types import HELD_GEAR
from gearidae.engine.model.state import Floats, Model, plain
from gearidae.engine.observers.standing.follow import STANDING_NUMBERS, standing_at
from gearidae.records.standing import Holding


def standing_now(m: Model, place: int, time: float, y: Floats) -> dict[str, Any]:
    """Return the numbers of `STANDING_NOW`, and the list of standstills.

    Parameters
    ----------
    m : Model
    place : int
        Of the model, from `gearidae.engine.model.addresses.Addresses`.
    time : float
        Reached, over tau.
    y : ndarray, shape (n,)
        Scaled state there.
    """
    numbers = np.empty(STANDING_NUMBERS)
    standing_at(place, time, y, numbers)
    stands, since, exits, advance, free, driven, held, rest, begin, _, *back, period, at_rest = (
        numbers.tolist()
    )
    s, e, now = plain(m.state.standing), m.state.extremes, time * float(m.scene.time_unit)
    turned, free_turned, back_time, back_exits, turn_time = back
    gone = turned > 0.0 and (turn_time == 0.0 or turn_time <= now - period)
    holding = (
        _holding(m, bool(at_rest) or rest > 0.5 * (now - begin), held) if stands or at_rest else Holding(0)
    )
    if at_rest and m.state.hold == HELD_GEAR:
        holding &= ~Holding.FLANK_FRICTION  # the pinion moves
    rows = [_row(m, plain(standstill)) for standstill in s.standstill[: s.stand_count]]
    if stands:
        rows.append([begin, math.nan, advance, free, held, float(holding), driven, rest])
    known = s.zero_count > 0
    return {
        "stick_time": since if stands else math.nan,
        "stick_exits": int(exits if stands else back_exits if gone else e.mesh_exits),
        "advance": advance if known else math.nan,
        "free_advance": free if known else math.nan,
        "driven_time": driven if known else math.nan,
        "held_torque": held if known else math.nan,
        "holding": int(holding),
        "turned_back": turned if gone else 0.0,
        "free_turned_back": free_turned if gone else 0.0,
        "back_time": back_time if gone else math.nan,
        "standstills": s.standstills + int(stands),
        "standing_time": s.standing_time + (now - begin if stands else 0.0),
        "standing_rest_time": s.standing_rest + (rest if stands else 0.0),
        "start_time": math.nan if not s.left else s.last_end,
        "breakaway_torque": s.breakaway if s.left else math.nan,
        "rest_time": s.rest_time,
        "followed_time": now,
        "standstill_list": array("d", [number for row in rows for number in row]),
    }


def _row(m: Model, standstill: Any) -> list[float]:
    """Return the `COLUMNS` of a standstill that has ended."""
    holding = _holding(m, standstill.rest_time > 0.5 * (standstill.end - standstill.begin), standstill.excess)
    kept = (
        standstill.begin,
        standstill.end,
        standstill.advance,
        standstill.free_advance,
        standstill.excess,
        holding,
        standstill.driven_time,
        standstill.rest_time,
    )
    return [float(number) for number in kept]


def _holding(m: Model, at_rest: bool, held: float) -> Holding:
    """What holds a gear that stands: dry friction, if it is at rest, and adhesion, if that is not enough."""
    dry = Holding(int(m.scene.friction.holding))
    holding = dry if at_rest else Holding(0)
    if not at_rest or (held > 0.0 and not dry & ~Holding.DRY_RESISTANCE):
        holding |= Holding.ADHESION
    return holding
