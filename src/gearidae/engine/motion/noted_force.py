"""Forces of pairs at the end of the step that is tried, kept for what flanks are exposed to.

The force law is what a step costs most. Newton's iteration evaluates it near the state that is accepted: from there the
slope leads to the force.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.state import Model

__all__ = ["begin_notes", "note_force"]


@compiled(inline=True)
def begin_notes(m: Model, t: float, travel: float) -> None:
    """Note that all forces are evaluated at a time and a transmission error; so far of no pair."""
    notes = m.work.notes
    notes.time, notes.travel, notes.count = t, travel, 0


@compiled(inline=True)
def note_force(
    m: Model, k: int, pair: int, place: float, gap: tuple[float, float], force: tuple[float, float]
) -> None:
    """Note a pair with the k-th history: place, gap with its rate, force with its slope in the gap."""
    notes = m.work.notes
    noted = notes.pair[notes.count]
    noted.history, noted.pair, noted.place = k, pair, place
    noted.gap, noted.gap_rate = gap
    noted.force, noted.slope = force
    notes.count += 1
