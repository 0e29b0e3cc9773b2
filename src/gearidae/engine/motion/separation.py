"""Smallest distance of the flanks: of rigid ones in the gap, of elastic ones anywhere along a contact."""

from __future__ import annotations

import math

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.elastic.rows import first_unknown
from gearidae.engine.model.state import COAST, DRIVE, Floats, Model, U
from gearidae.engine.pairs.tooth_pairs import all_pairs, gap_and_rate, history_of, pair_at


@compiled_once(SOLVER)
def separation(m: Model, y: Floats) -> float:
    """Smallest distance of the flanks at a state, deflection included, scaled."""
    if m.scene.nodes == 0:
        return rigid_separation(m, y[U])
    least = math.inf
    reach = all_pairs(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        k = history_of(m, coast, pair)
        gap, _ = gap_and_rate(m, coast, pair, y)
        if gap >= m.scene.cutoff or m.state.history[k].pair != pair:
            least = min(least, gap)
            continue
        first = first_unknown(m, k)
        for node in range(m.scene.nodes):
            least = min(least, gap + m.tables[m.scene.profile_at + node] + y[first + node])
    return least


@compiled
def rigid_separation(m: Model, u: float) -> float:
    """Distance of the nearer flank of pairs on the path of contact."""
    return min(m.scene.clearance[DRIVE] - u, m.scene.clearance[COAST] + u)
