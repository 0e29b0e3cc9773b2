"""The pairs' histories between events: begun, followed from one accepted time to the next, and cleared."""

from __future__ import annotations

import numpy as np

from gearidae.compiled import compiled
from gearidae.engine.elastic.histories import follow_nodes, init_nodes
from gearidae.engine.elastic.nodes import middle_gap
from gearidae.engine.events.asperity_events import join_at_start
from gearidae.engine.events.cutoff import begin_within, watches_cutoff
from gearidae.engine.events.law_switches import set_shaft_sides
from gearidae.engine.events.mesh_marks import set_marks
from gearidae.engine.events.sliding import begin_sliding
from gearidae.engine.laws.statistical import set_joined
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import EMPTY, MATERIALS, PHASE, Floats, Model
from gearidae.engine.pairs.orbit import follow_orbit
from gearidae.engine.pairs.tooth_pairs import (
    gap_and_rate,
    history_of,
    nearest_gap,
    pair_at,
    pairs_touching,
)
from gearidae.engine.population.candidates import forget
from gearidae.laws.pair_law import in_reach


@compiled(inline=True)
def accept(m: Model, t: float, y: Floats) -> None:
    """Follow the histories to an accepted time; beyond the cut-off nothing is joined and nothing is remembered."""
    m.state.time = t
    follow_orbit(m, t)
    for flank in range(2):
        if in_reach(m, nearest_gap(m, flank, y)):
            m.state.flank_in_reach[flank] = 1
        elif m.state.flank_in_reach[flank] != 0:
            clear_history(m, flank)
    reach = pairs_touching(m, y)
    for i in range(reach.total):
        flank, pair = pair_at(reach, i)
        k = history_of(m, flank, pair)
        h = m.state.history[k]
        gap, rate = gap_and_rate(m, flank, pair, y)
        if h.pair != pair or not in_reach(m, gap):
            init_history(m, k, pair, gap, middle_gap(m, k, y, gap))
            if m.scene.nodes > 0:
                init_nodes(m, k, y, gap)
        elif m.scene.nodes > 0:
            follow_nodes(m, k, y, gap)
        if m.scene.nodes > 0 and middle_gap(m, k, y, gap) < m.scene.light_gap:
            m.state.deep_exits = m.state.extremes.mesh_exits
        h.gap, h.gap_rate = gap, rate
        if gap < m.scene.lowest_gap:
            m.state.bound_exceeded = 1
        if h.direction == 0.0 and m.scene.population.flanks == 0:
            h.direction = float(np.sign(rate))


@compiled
def clear_history(m: Model, flank: int) -> None:
    """Empty a flank's histories: none of its pairs is near."""
    m.state.flank_in_reach[flank] = 0
    for k in range(m.scene.slots):
        m.state.history[flank * m.scene.slots + k].pair = EMPTY
        m.state.history[flank * m.scene.slots + k].adhesion_lag = 0.0
        forget(m, flank * m.scene.slots + k)


@compiled
def init_history(m: Model, k: int, pair: int, gap: float, middle: float) -> None:
    """Start the history of a pair on which nothing is joined yet."""
    h = m.state.history[k]
    if h.pair != pair:
        h.pair = pair
        h.in_contact = 1 if gap < m.scene.contact_gap and m.scene.population.flanks == 0 else 0
        h.impact.begun = 0
        forget(m, k)
        for material in range(MATERIALS):
            if m.scene.material[material].stretch_limit > 0.0:
                set_joined(m, k, material, middle)
    for material in range(MATERIALS):
        h.joined[material] = middle  # beyond the cut-off its branch does not matter
        if not in_reach(m, gap):
            h.adhered_energy[material] = 0.0
        h.at_pull_off[material] = 0
    h.direction = h.adhesion_lag = h.adhesion_lag_power = h.adhesion_lag_power_rate = 0.0
    h.slide = 0
    m.work.exposing.pair[k].known = 0


@compiled(makes_arrays=True)
def begin(address: int, t: float, y: Floats) -> None:
    """Set the histories and mesh marks of the model at an address for a start at `y`."""
    m = model_at(address)
    for flank in range(2):
        clear_history(m, flank)
    accept(m, t, y)
    set_marks(m, y[PHASE])
    if m.scene.guarded != 0:
        set_shaft_sides(m, y)
    if watches_cutoff(m):
        begin_within(m, y)
    if m.scene.population.flanks != 0:
        join_at_start(m, y)
    if m.scene.friction.may_stick != 0:
        begin_sliding(m, t, y)
