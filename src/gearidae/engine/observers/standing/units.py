"""Where a gear stands, in SI units and pitches."""

from __future__ import annotations

import math
from array import array
from typing import Any

from gearidae.engine.model.record_types import AT_REST, HELD_GEAR
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.observers.standing.judge import Judge, Standstill
from gearidae.laws.frictions import HELD_BY_LAWS
from gearidae.records.standing import NOTICED, SHORT_STANDSTILL, Holding


def standing_now(m: Model, judge: Judge, time: float, y: Floats) -> dict[str, Any]:
    """Return the numbers of `STANDING_NOW`, and the list of standstills.

    Parameters
    ----------
    m : Model
    judge : Judge
        Of the run.
    time : float
        Reached, over tau.
    y : ndarray, shape (n,)
        Scaled state there.
    """
    said, now = judge.now(time, y), time * float(m.scene.time_unit)
    stood, last, stands, at_rest = said.stood, said.row, said.stands, m.state.hold in (AT_REST, HELD_GEAR)
    turned, free_turned, back_time, back_exits, turn_time = said.back
    gone = turned > 0.0 and (turn_time == 0.0 or turn_time <= now - said.period)
    rests = at_rest or last.rest_time > 0.5 * (now - last.begin)
    well = _in_well(last.advance, last.free_advance, last.settled)
    holding = _holding(m, rests, last.excess, well) if stands or at_rest else Holding(0)
    if at_rest and m.state.hold == HELD_GEAR:
        holding &= ~Holding.FLANK_FRICTION  # the pinion moves
    counted = [row for row in stood.rows if _counts(row, now)]
    short = [row for row in stood.rows if not _counts(row, now)]
    last_end, breakaway = stood.last_end, stood.breakaway
    if short and short[-1].end == last_end:
        last_end, breakaway = (
            (counted[-1].end, counted[-1].breakaway) if counted else (0.0, stood.start_torque)
        )
    rows = [_row(m, row) for row in counted]
    if stands:
        rows.append(_numbers(last, holding))
    return {
        "stick_time": said.since if stands else math.nan,
        "stick_exits": said.exits if stands else back_exits if gone else int(m.state.extremes.mesh_exits),
        "advance": last.advance,
        "free_advance": last.free_advance,
        "driven_time": last.driven_time,
        "held_torque": last.excess,
        "settled": last.settled,
        "holding": int(holding),
        "turned_back": turned if gone else 0.0,
        "free_turned_back": free_turned if gone else 0.0,
        "back_time": back_time if gone else math.nan,
        "standstills": stood.number + int(stands) - len(short),
        "standing_time": stood.standing_time
        + (now - last.begin if stands else 0.0)
        - sum(row.end - row.begin for row in short),
        "standing_rest_time": stood.standing_rest
        + (last.rest_time if stands else 0.0)
        - sum(row.rest_time for row in short),
        "start_time": last_end if m.state.standing.left else math.nan,
        "breakaway_torque": breakaway if m.state.standing.left else math.nan,
        "rest_time": float(m.state.standing.rest_time),
        "followed_time": now,
        "standstill_list": array("d", [number for row in rows for number in row]),
    }


def _counts(standstill: Standstill, until: float) -> bool:
    """Whether a standstill that has ended is one of a chain that lasts until now.

    A share of the chain is what a standstill takes at least, and that has grown since the standstill was noted.
    """
    return bool(
        standstill.free_advance >= NOTICED
        or standstill.end - standstill.since > SHORT_STANDSTILL * until * (1.0 - 1e-9)
    )


def _in_well(advance: float, free_advance: float, settled: int) -> bool:
    """Whether a gear lies where free gears do: in a well of the torque that drives both."""
    return settled == 2 and 0.0 < 0.5 * free_advance <= advance


def _row(m: Model, row: Standstill) -> list[float]:
    """Return the `COLUMNS` of a standstill that has ended."""
    well = _in_well(row.advance, row.free_advance, row.settled)
    return _numbers(row, _holding(m, row.rest_time > 0.5 * (row.end - row.begin), row.excess, well))


def _numbers(row: Standstill, holding: Holding) -> list[float]:
    kept = (row.begin, row.end, row.advance, row.free_advance, row.excess, holding)
    return [float(number) for number in (*kept, row.driven_time, row.rest_time, row.settled)]


def _holding(m: Model, at_rest: bool, held: float, in_well: bool) -> Holding:
    """What holds a gear that stands: friction, if it is at rest; adhesion or its well, if that is not enough."""
    rubbing = Holding(int(m.scene.friction.holding))
    if in_well:
        if at_rest:
            return rubbing
        return Holding.SHAFT_TIE if m.scene.tied != 0 else Holding.DRIVE_WELL
    holding = rubbing if at_rest else Holding(0)
    if not at_rest or (held > 0.0 and not rubbing & ~Holding(HELD_BY_LAWS)):
        holding |= Holding.ADHESION
    return holding
