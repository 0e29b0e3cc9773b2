"""Joined asperities taken back from a checkpoint."""

from __future__ import annotations

from gearidae.compiled import compiled_once
from gearidae.engine.compiling import POPULATION
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.pairs.tooth_pairs import history_of, pair_at, pairs_near
from gearidae.engine.population.candidates import choose_beside, forget
from gearidae.engine.population.layout import REMEMBERED, column, flank_of
from gearidae.engine.population.spots import pair_now


@compiled_once(POPULATION)
def take_joined(m: Model, y: Floats, joined: Floats) -> int:
    """Let asperities be joined, given by their places among all in rising order; how many of them pairs have."""
    taken, reach = 0, pairs_near(m, y)
    for k in range(m.scene.histories):
        forget(m, k)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        k = history_of(m, coast, pair)
        if m.state.history[k].pair != pair:
            continue
        own, kept = m.work.contact[k], column(m, k, REMEMBERED)
        starts = m.scene.population.starts_at + flank_of(m, coast, pair)
        for n in range(joined.size):
            if m.tables[starts] <= joined[n] < m.tables[starts + 1]:
                m.rows[kept + own.joined] = joined[n]
                own.joined += 1
        taken += own.joined
        now = pair_now(m, coast, pair, y)
        choose_beside(m, k, coast, pair, now.gap, now.place, now.place)
    return taken
