"""Joined asperities taken back from a checkpoint, and the candidates that a run has from there on."""

from __future__ import annotations

from gearidae.compiled import compiled_once
from gearidae.engine.compiling import POPULATION
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.pairs.tooth_pairs import list_known
from gearidae.engine.population.candidates import choose, choose_beside, forget
from gearidae.engine.population.contact_point import pair_of
from gearidae.engine.population.layout import REMEMBERED, column, flank_of


@compiled_once(POPULATION)
def take_joined(m: Model, y: Floats, joined: Floats) -> int:
    """Let asperities be joined, given by their indices among all in rising order; how many of them pairs have."""
    taken = 0
    for k in range(m.scene.histories):
        forget(m, k)
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        contact, now, kept = m.work.contact[k], pair_of(m, k, y), column(m, k, REMEMBERED)
        starts = m.scene.population.starts_at + flank_of(m, now.flank, now.number)
        for n in range(joined.size):
            if m.tables[starts] <= joined[n] < m.tables[starts + 1]:
                m.rows[kept + contact.joined] = joined[n]
                contact.joined += 1
        taken += contact.joined
        choose_beside(m, k, now.flank, now.number, now.gap, now.position, now.position)
    return taken


@compiled_once(POPULATION)
def choose_anew(m: Model, y: Floats) -> None:
    """Choose the candidates of all pairs as `take_joined` does, with what is joined: they keep nothing of the way here.

    A run that is taken up here goes on with the same candidates.
    """
    for k in range(m.scene.histories):
        m.work.contact[k].known = m.work.contact[k].started = 0
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        now = pair_of(m, k, y)
        choose(m, k, now.flank, now.number, now.gap, now.position, now.position)
