"""Forces of single pairs at the state that `mesh_forces` has been asked for last, for what needs more than sums."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.state import Model
from gearidae.engine.pairs.pair_force import PairForce
from gearidae.engine.pairs.tooth_pairs import PairState


@compiled(inline=True)
def note_force(m: Model, pair: PairState, f: PairForce) -> None:
    """Note a pair and its force."""
    notes = m.work.notes
    noted = notes.pair[notes.count]
    noted.history, noted.pair, noted.position = pair.k, pair.number, pair.place
    noted.gap, noted.gap_rate, noted.relief = pair.gap, pair.rate, pair.slope
    noted.force, noted.slope, noted.drift = f.load, f.by_gap, f.by_place * pair.place_rate
    noted.contact, noted.contact_slope = f.contact, f.contact_by_gap
    noted.limit, noted.limit_slope = f.limit, f.limit_by_gap
    noted.limit_rate = f.limit_by_place * pair.place_rate + f.limit_by_gap * pair.rate
    notes.count += 1
