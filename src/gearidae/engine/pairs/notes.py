"""Forces of single pairs, noted where they are evaluated: for exposures and friction."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.state import Model


@compiled(inline=True)
def begin_notes(m: Model, t: float, travel: float) -> None:
    """Note that all forces are evaluated at a time and a transmission error; so far of no pair."""
    notes = m.work.notes
    notes.time, notes.travel, notes.count = t, travel, 0


@compiled(inline=True)
def note_force(
    m: Model, k: int, pair: int, position: float, gap: tuple[float, float], force: tuple[float, float]
) -> None:
    """Note a pair with the k-th history: path position, gap with its rate, force with its slope in the gap."""
    notes = m.work.notes
    noted = notes.pair[notes.count]
    noted.history, noted.pair, noted.position = k, pair, position
    noted.gap, noted.gap_rate = gap
    noted.force, noted.slope = force
    noted.drift = 0.0
    notes.count += 1
