"""Where a gear stands, in SI units and pitches."""

from __future__ import annotations

import math
from array import array
from types import SimpleNamespace
from typing import Any

import numpy as np

from gearidae.engine.model.record_types import HELD_GEAR
from gearidae.engine.model.state import Floats, Model, plain
from gearidae.engine.observers.standing.follow import STANDING_NUMBERS, standing_at
from gearidae.records.standing import NOTICED, SHARE, Holding


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
    numbers, before = np.empty(STANDING_NUMBERS), m.state.standing.copy()
    standing_at(place, time, y, numbers)
    stands, since, exits, advance, free, driven, held, rest, begin, _, *back, period, at_rest, settled = (
        numbers.tolist()
    )
    s, e, now = plain(m.state.standing.copy()), m.state.extremes, time * float(m.scene.time_unit)
    _forget(m.state.standing, before)
    turned, free_turned, back_time, back_exits, turn_time = back
    settled = int(settled)
    gone = turned > 0.0 and (turn_time == 0.0 or turn_time <= now - period)
    holding = (
        _holding(m, bool(at_rest) or rest > 0.5 * (now - begin), held, _in_well(advance, free, settled))
        if stands or at_rest
        else Holding(0)
    )
    if at_rest and m.state.hold == HELD_GEAR:
        holding &= ~Holding.FLANK_FRICTION  # the pinion moves
    ended = [plain(standstill) for standstill in s.standstill[: s.stand_count]]
    counted = [standstill for standstill in ended if _counts(standstill, now)]
    short = [standstill for standstill in ended if not _counts(standstill, now)]
    last_end, breakaway = s.last_end, s.breakaway
    if short and short[-1].end == last_end:
        last = counted[-1] if counted else SimpleNamespace(end=0.0, breakaway=s.start_torque)
        last_end, breakaway = last.end, last.breakaway
    rows = [_row(m, standstill) for standstill in counted]
    if stands:
        rows.append([begin, math.nan, advance, free, held, float(holding), driven, rest, float(settled)])
    known = s.zero_count > 0
    return {
        "stick_time": since if stands else math.nan,
        "stick_exits": int(exits if stands else back_exits if gone else e.mesh_exits),
        "advance": advance if known else math.nan,
        "free_advance": free if known else math.nan,
        "driven_time": driven if known else math.nan,
        "held_torque": held if known else math.nan,
        "settled": settled if known else 0,
        "holding": int(holding),
        "turned_back": turned if gone else 0.0,
        "free_turned_back": free_turned if gone else 0.0,
        "back_time": back_time if gone else math.nan,
        "standstills": s.standstills + int(stands) - len(short),
        "standing_time": s.standing_time
        + (now - begin if stands else 0.0)
        - sum(standstill.end - standstill.begin for standstill in short),
        "standing_rest_time": s.standing_rest
        + (rest if stands else 0.0)
        - sum(standstill.rest_time for standstill in short),
        "start_time": math.nan if not s.left else last_end,
        "breakaway_torque": breakaway if s.left else math.nan,
        "rest_time": s.rest_time,
        "followed_time": now,
        "standstill_list": array("d", [number for row in rows for number in row]),
    }


def _forget(s: Any, before: Any) -> None:
    """Forget a standstill that has been noted as for the end of a run: where it goes on it may end otherwise."""
    for name in (
        "stand_count",
        "standstill",
        "standstills",
        "standing_time",
        "standing_rest",
        "last_end",
        "breakaway",
    ):
        s[name] = before[name]
    s["zero"]["spent"] = before["zero"]["spent"]


def _counts(standstill: Any, until: float) -> bool:
    """Whether a standstill that has ended is one of a chain so far: its hundredth has grown since it was noted."""
    return bool(
        standstill.free_advance >= NOTICED or standstill.end - standstill.since > SHARE * until * (1.0 - 1e-9)
    )


def _in_well(advance: float, free_advance: float, settled: int) -> bool:
    """Whether a gear lies where free gears do: in a well of the torque that drives both."""
    return settled == 2 and 0.0 < 0.5 * free_advance <= advance


def _row(m: Model, standstill: Any) -> list[float]:
    """Return the `COLUMNS` of a standstill that has ended."""
    well = _in_well(standstill.advance, standstill.free_advance, standstill.settled)
    at_rest = standstill.rest_time > 0.5 * (standstill.end - standstill.begin)
    holding = _holding(m, at_rest, standstill.excess, well)
    kept = (
        standstill.begin,
        standstill.end,
        standstill.advance,
        standstill.free_advance,
        standstill.excess,
        holding,
        standstill.driven_time,
        standstill.rest_time,
        standstill.settled,
    )
    return [float(number) for number in kept]


def _holding(m: Model, at_rest: bool, held: float, in_well: bool) -> Holding:
    """What holds a gear that stands: dry friction, if it is at rest; adhesion or its well, if that is not enough."""
    dry = Holding(int(m.scene.friction.holding))
    if in_well:
        if at_rest:
            return dry
        return Holding.SHAFT_TIE if m.scene.tied != 0 else Holding.DRIVE_WELL
    holding = dry if at_rest else Holding(0)
    if not at_rest or (held > 0.0 and not dry & ~Holding.DRY_RESISTANCE):
        holding |= Holding.ADHESION
    return holding
