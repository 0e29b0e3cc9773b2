"""Least separation of a run: at accepted times, and where rigid bodies turn round between two of them."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.contact.history import extreme_gap
from gearidae.engine.model.state import Floats, Model, Record
from gearidae.engine.motion.separation import rigid_separation, separation


@compiled(inline=True)
def follow_separation(m: Model, last: Record, now: Record, y: Floats) -> None:
    """Follow the separation to an accepted time, given as ``POINT`` beside the one before.

    Elastic contacts turn round at events, which are accepted times.
    """
    if m.scene.nodes > 0:
        note_separation(m, separation(m, y))
    elif now.travel_rate * last.travel_rate <= 0.0 and now.travel_rate != last.travel_rate:
        h = now.time - last.time
        extreme = extreme_gap(h, last.travel, last.travel_rate, now.travel, now.travel_rate)
        note_separation(m, rigid_separation(m, extreme))


@compiled
def note_separation(m: Model, distance: float) -> None:
    """Note a distance."""
    m.state.extremes.separation = min(m.state.extremes.separation, distance)
