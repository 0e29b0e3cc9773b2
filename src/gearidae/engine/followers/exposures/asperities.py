"""Asperities of a population that have joined, and the energy that they have lost, tooth by tooth and place by place.

Each counts at its own place on the flank, and loses when it joins and when it detaches, as in the energy balance.
"""

from __future__ import annotations

from gearidae.compiled import compiled_once
from gearidae.engine.compiling import EXPOSURES
from gearidae.engine.followers.exposures.bins import ROWS, bin_at, row_of
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.pairs.tooth_pairs import list_known
from gearidae.engine.population.forces import candidate_energy
from gearidae.engine.population.layout import ARC, HEIGHT, K_MATERIAL, KIND, REMEMBERED, SIGN, column
from gearidae.engine.population.spots import pair_of, place_of_arc, spot_at


@compiled_once(EXPOSURES)
def add_flips(m: Model, y: Floats) -> None:
    """Add what has joined or detached at a root, after `flip_asperities` has found it and before it is recorded."""
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        own, now = m.work.contact[k], pair_of(m, k, y)
        row = row_of(m, now.coast, now.number)
        at = spot_at(m, now.place, now.moves)
        bend = 0.5 * m.scene.population.steepness / at.radius
        for n in range(own.flips):
            j = int(m.rows[column(m, k, REMEMBERED) + n])
            arc, kind = m.rows[column(m, k, ARC) + j], int(m.rows[column(m, k, KIND) + j])
            x = arc - at.arc
            energy = candidate_energy(m, kind, m.rows[column(m, k, HEIGHT) + j] - now.gap - bend * x * x)
            here = row + bin_at(m, place_of_arc(m, arc))
            material = int(m.tables[kind + K_MATERIAL])
            lost = here + (ROWS.adhesion + material) * m.scene.bins
            if m.rows[column(m, k, SIGN) + j] > 0.0:
                m.rows[here + (ROWS.contacts + material) * m.scene.bins] += 1.0
                m.rows[lost] -= energy
            else:
                m.rows[lost] += energy
