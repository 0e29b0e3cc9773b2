"""The record of an event in a driver's block of output."""

from __future__ import annotations

from typing import Final

from gearidae.compiled import compiled
from gearidae.engine.model.state import Floats, Model

EVENT_NUMBERS: Final = 6
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
        Time [s], kind, pair, flank, gap rate [m/s], asperity or -1. Where it is full nothing is written;
        drivers keep `EVENTS_AT_ONCE` free before they look for events.
    count : int
        Events already there.
    t, kind, pair, flank, rate : float
        Time over tau, what has happened where, and the pair's gap rate, scaled.
    """
    if count >= events.shape[0]:
        return count
    events[count, 0] = t * m.scene.time_unit
    events[count, 1] = kind
    events[count, 2] = pair + (m.state.turns if flank >= 0.0 else 0.0)
    events[count, 3] = flank
    events[count, 4] = rate * m.scene.length_unit / m.scene.time_unit
    events[count, 5] = -1.0
    return count + 1


@compiled
def record_asperity(
    m: Model, events: Floats, count: int, what: tuple[float, float, int, int, float], asperity: float
) -> int:
    """Write an event of a single asperity, given by its place among those of its flank, likewise."""
    t, kind, pair, flank, rate = what
    after = record(m, events, count, t, kind, pair, flank, rate)
    if after > count:
        events[count, 5] = asperity
    return after
