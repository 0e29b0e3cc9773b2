"""Events of a tooth pair: contact onset and separation, turning point of the gap, full stretch of a material.

For each kind, its guard (positive while the event is to come) and what is done when the guard has fallen.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from gearidae.compiled import compiled
from gearidae.contact.history import joined_height
from gearidae.engine.elastic.histories import join_nodes
from gearidae.engine.elastic.nodes import middle_gap
from gearidae.engine.events.record import record, record_contact
from gearidae.engine.laws.statistical import set_joined
from gearidae.engine.model.state import MATERIALS, Floats, Model
from gearidae.engine.pairs.tooth_pairs import gap_and_rate
from gearidae.laws.pair_law import in_reach
from gearidae.records import EventKind

_ONSET: Final = float(EventKind.ONSET)
_SEPARATION: Final = float(EventKind.SEPARATION)
_TURNING_POINT: Final = float(EventKind.TURNING_POINT)
_FULL_STRETCH: Final = float(EventKind.FULL_STRETCH)
_FLANK_CHANGE: Final = float(EventKind.FLANK_CHANGE)


@compiled
def pair_guard(m: Model, k: int, gap: float, rate: float, middle: float) -> float:
    """Least of one pair's guards; asperities stretch with the gap in the middle, which deflection has its part in."""
    h = m.state.history[k]
    touch = gap - m.scene.contact_gap
    least = -touch if h.in_contact != 0 else touch
    if not in_reach(m, gap):
        return least
    if h.direction != 0.0:
        least = min(least, rate * h.direction)
    if h.direction > 0.0:
        for material in range(MATERIALS):
            limit = m.scene.material[material].stretch_limit
            if limit > 0.0 and h.at_pull_off[material] == 0:
                least = min(least, h.joined[material] + limit - middle)
    return least


class PairEvent(NamedTuple):
    """What has happened to a tooth pair at a root of the guard, before its history knows.

    Attributes
    ----------
    flank, pair, k : int
        Flank and number of the pair, and index of its history.
    gap, rate, middle : float
        Its gap, the gap's rate, and the gap in the middle of its contact.
    touches, stretches, turns : bool
        Whether contact has begun or ended, a material is stretched in full, and the gap has turned round.
    """

    flank: int
    pair: int
    k: int
    gap: float
    rate: float
    middle: float
    touches: bool
    stretches: bool
    turns: bool


@compiled(inline=True)
def find_event(m: Model, y: Floats, flank: int, pair: int, k: int) -> PairEvent:
    """Say which guards of a pair have fallen at a state."""
    gap, rate = gap_and_rate(m, flank, pair, y)
    h = m.state.history[k]
    inside = gap <= m.scene.contact_gap if h.in_contact == 0 else gap < m.scene.contact_gap
    touches, stretches, turns, middle = inside != (h.in_contact != 0), False, False, gap
    if in_reach(m, gap):
        middle = middle_gap(m, k, y, gap)
        for material in range(MATERIALS):
            stretches |= newly_stretched(m, k, material, middle)
        turns = h.direction != 0.0 and h.direction * rate <= 0.0
    return PairEvent(flank, pair, k, gap, rate, middle, touches, stretches, turns)


@compiled
def take_event(m: Model, t: float, y: Floats, event: PairEvent, events: Floats, count: int) -> int:
    """Have a pair's history take what has happened, which disarms its guards, and return the new number of events.

    Parameters
    ----------
    t : float
        Time over tau.
    y : ndarray, shape (n,)
        State there.
    events : ndarray, shape (n, EVENT_NUMBERS)
    count : int
        See `gearidae.engine.events.record`.
    """
    flank, pair, k, rate = event.flank, event.pair, event.k, event.rate
    if event.touches:
        count = _change_contact(m, t, y, event, events, count)
    for material in range(MATERIALS if event.stretches else 0):
        if newly_stretched(m, k, material, event.middle):
            m.state.history[k].at_pull_off[material] = 1
            count = record(m, events, count, t, _FULL_STRETCH, pair, flank, rate)
    if event.turns:
        _turn_round(m, y, k, event.gap, event.middle)
        count = record(m, events, count, t, _TURNING_POINT, pair, flank, rate)
    return count


@compiled
def _change_contact(m: Model, t: float, y: Floats, event: PairEvent, events: Floats, count: int) -> int:
    """Contact onset or separation, and a change of flank with it."""
    flank, pair, rate = event.flank, event.pair, event.rate
    h = m.state.history[event.k]
    h.in_contact = 1 - h.in_contact
    onset = h.in_contact != 0
    count = record_contact(m, y, events, count, (t, _ONSET if onset else _SEPARATION, pair, flank, rate))
    if onset:
        if m.state.last_flank == 1 - flank:
            count = record(m, events, count, t, _FLANK_CHANGE, pair, flank, rate)
        m.state.last_flank = flank
    return count


@compiled
def newly_stretched(m: Model, k: int, material: int, middle: float) -> bool:
    """Whether a material's asperities have been stretched in full since that was last recorded."""
    h, limit = m.state.history[k], m.scene.material[material].stretch_limit
    waiting = limit > 0.0 and h.direction > 0.0 and h.at_pull_off[material] == 0
    return bool(waiting and h.joined[material] + limit <= middle)


@compiled
def _turn_round(m: Model, y: Floats, k: int, gap: float, middle: float) -> None:
    """Take the joined heights at a turning point of the gap; joining has lagged up to there."""
    h = m.state.history[k]
    h.adhesion_lag = h.adhesion_lag_power = h.adhesion_lag_power_rate = 0.0
    for material in range(MATERIALS):
        limit = m.scene.material[material].stretch_limit
        if limit > 0.0:
            set_joined(m, k, material, joined_height(h.joined[material], middle, limit))
            h.at_pull_off[material] = 0
    if m.scene.nodes > 0:
        join_nodes(m, k, y, gap)
    h.direction = -h.direction
    h.gap, h.gap_rate = gap, 0.0
