"""Smallest distance of the flanks: of rigid ones in the gap, of elastic ones anywhere along a contact."""

from __future__ import annotations

import math

from gearidae.compiled import compiled, compiled_once
from gearidae.contact.history import extreme_gap
from gearidae.engine.compiling import SOLVER
from gearidae.engine.elastic.rows import first_unknown
from gearidae.engine.model.state import ROLLER, Floats, Model, Record, U
from gearidae.engine.model.tooth_pairs import all_pairs, gap_and_rate, history_of, pair_at

__all__ = ["follow_separation", "note_separation", "separation"]


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
    """Distance of a roller, or of the nearer flank of pairs on the path of contact."""
    return u if m.scene.kind == ROLLER else m.scene.half_backlash - abs(u)


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
