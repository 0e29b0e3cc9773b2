"""Stops of a run: knots where a torque's schedule enters its next segment, and the end before its time (``run.stop``).

The end before its time, where the gear sticks or has made its turns, is the root of a guard, so that the run ends where
the condition is met, whatever its steps, blocks and samples are.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled
from gearidae.engine.events.law_switches import set_law_window
from gearidae.engine.events.record import record
from gearidae.engine.model.state import PHASE, SCHEDULES, STOPS, Floats, Model
from gearidae.laws.shaft.schedule import enter_segment
from gearidae.records import EventKind, Flank

_SCHEDULE_KNOT, _NO_FLANK = float(EventKind.SCHEDULE_KNOT), float(Flank.NONE)


@compiled
def next_stop(m: Model) -> float:
    """Time of the coming knot, or the end of the run."""
    if m.state.next_knot < m.scene.knot_count:
        return m.tables[m.scene.knots_at + m.state.next_knot]
    return m.scene.end


@compiled
def keeps_checkpoint(m: Model) -> bool:
    """Whether the run keeps a checkpoint at the coming stop."""
    return bool(m.tables[m.scene.checkpoints_at + m.state.next_knot] != 0.0)


@compiled
def pass_knot(m: Model, t: float, events: Floats, count: int) -> int:
    """Enter the next segment of every schedule that has a knot here; a checkpoint alone is no event."""
    entered = 0
    for which in range(SCHEDULES):
        entered -= m.state.segment[which]
        enter_segment(m, which, t)
        entered += m.state.segment[which]
    m.state.next_knot += 1
    set_law_window(m)
    if entered == 0:
        return count
    return record(m, events, count, t, _SCHEDULE_KNOT, 0, _NO_FLANK, 0.0)


_STICKS: Final = STOPS.index("sticks")


@compiled
def stop_guard(m: Model, t: float, y: Floats) -> float:
    """Time until a gear that stays within half a pitch has stuck, or the pitches that its turns still lack."""
    if m.scene.stop == _STICKS:
        return m.work.track.stop_time - t if m.work.track.stop_time > 0.0 else math.inf
    return m.scene.stop_pitches - abs(y[PHASE] + m.state.whole_pitches - m.scene.stop_from)
