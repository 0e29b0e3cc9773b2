"""The record of events in a driver's block of output."""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled
from gearidae.engine.friction.forces import has_element
from gearidae.engine.model.record_types import STUCK
from gearidae.engine.model.state import LOAD, Floats, Model
from gearidae.engine.motion.pair_forces import force_of_one
from gearidae.engine.pairs.tooth_pairs import flank_of_history
from gearidae.records import EVENT, EventKind, Flank

_TIME, _KIND, _PAIR, _FLANK, _GAP_RATE, _ASPERITY, _FORCE = EVENT
_ONSET: Final = float(EventKind.ONSET)
_REVERSAL, _STICK = float(EventKind.SLIDING_REVERSAL), float(EventKind.FLANK_STICK)
_SLIP, _GEAR_STICK = float(EventKind.FLANK_SLIP), float(EventKind.STICK)
_GEAR_SLIP, _NO_FLANK = float(EventKind.SLIP), float(Flank.NONE)
EVENT_NUMBERS: Final = len(EVENT)
"""Numbers of an event."""
EVENTS_AT_ONCE: Final = 8 * 64 + 64
"""More than can be recorded at one accepted time: four for each pair, and those of mesh, gear and schedules."""


@compiled
def record(
    m: Model, events: Floats, count: int, t: float, kind: float, pair: float, flank: float, rate: float
) -> int:
    """Write an event in SI units, and return the new count.

    Parameters
    ----------
    events : ndarray, shape (n, EVENT_NUMBERS)
        Columns of `gearidae.records.Events`, in SI units; asperity -1 where an event is of no single one, force NaN
        but for onsets and separations. Where it is full nothing is written; drivers keep `EVENTS_AT_ONCE` free before
        they look for events.
    count : int
        Events already there.
    t, kind, pair, flank, rate : float
        Time over tau, what has happened where, and the pair's gap rate, scaled.
    """
    if count >= events.shape[0]:
        return count
    events[count, _TIME] = t * m.scene.time_unit
    events[count, _KIND] = kind
    events[count, _PAIR] = pair + (m.state.whole_pitches if flank >= 0.0 else 0.0)
    events[count, _FLANK] = flank
    events[count, _GAP_RATE] = rate * m.scene.length_unit / m.scene.time_unit
    events[count, _ASPERITY] = -1.0
    events[count, _FORCE] = math.nan
    return count + 1


@compiled
def record_contact(
    m: Model, y: Floats, events: Floats, count: int, what: tuple[float, float, int, int, float]
) -> int:
    """Write an onset or a separation, with the force of the pair at a state; count impacts of its flank."""
    t, kind, pair, flank, rate = what
    if kind == _ONSET:
        m.state.passage[flank].impacts += 1
    after = record(m, events, count, t, kind, pair, flank, rate)
    if after > count:
        events[count, _FORCE] = force_of_one(m, t, y, flank, pair) * m.scene.force_unit
    return after


@compiled
def record_asperity(
    m: Model, events: Floats, count: int, what: tuple[float, float, int, int, float], asperity: float
) -> int:
    """Write an event of a single asperity, given by its index among those of its flank."""
    t, kind, pair, flank, rate = what
    after = record(m, events, count, t, kind, pair, flank, rate)
    if after > count:
        events[count, _ASPERITY] = asperity
    return after


@compiled
def note_directions(m: Model) -> None:
    """Note all directions of slip before the decisions of one time."""
    before = m.work.friction
    before.before_slip = m.state.slip
    for k in range(m.scene.histories):
        before.before_pair[k], before.before_slide[k] = m.state.history[k].pair, m.state.history[k].slide


@compiled
def record_changes(m: Model, t: float, events: Floats, count: int) -> int:
    """Record in what directions of slip have changed by all decisions of one time; the new number of events."""
    before = m.work.friction
    for k in range(m.scene.histories):
        h, last = m.state.history[k], before.before_slide[k]
        if h.pair != before.before_pair[k] or h.slide == last or h.slide == 0 or last == 0:
            continue
        kind = _STICK if h.slide == STUCK else _SLIP if last == STUCK else _REVERSAL
        count = record(m, events, count, t, kind, h.pair, flank_of_history(m, k), h.gap_rate)
    if has_element(m, LOAD) and (m.state.slip == 0.0) != (before.before_slip == 0.0):
        kind = _GEAR_STICK if m.state.slip == 0.0 else _GEAR_SLIP
        count = record(m, events, count, t, kind, 0, _NO_FLANK, 0.0)
    return count
