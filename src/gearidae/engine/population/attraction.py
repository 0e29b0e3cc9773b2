r"""Attraction of flanks whose asperities are real: between mean planes, as everywhere, and along the path of contact.

A pair's energy is :math:`\ell \sum_m s_m U_m(g)`, with its contact length and the shares of the materials at its place.
That gives the force along the line of action and, at fixed gap, the one along the path that `mesh.radius_force` stands
for.
"""

from __future__ import annotations

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import POPULATION
from gearidae.engine.model.state import PHASE, ROLLER, Floats, Model, U, W
from gearidae.engine.pairs.coverage import WHOLE, attraction_energies, attraction_of, shares_of, weighed
from gearidae.engine.pairs.lengths import length_and_rates, weighed_length
from gearidae.engine.pairs.tooth_pairs import contact_length, history_of, pair_at, pairs_near
from gearidae.engine.population.spots import Pair, pair_now


@compiled(inline=True)
def _inside(m: Model, now: Pair) -> float:
    """Path position of a pair, clipped to the path."""
    return min(max(now.place, 0.0), m.scene.contact_ratio)


@compiled
def pair_attraction(m: Model, y: Floats, coast: int, pair: int, now: Pair) -> tuple[float, float, float]:
    """Attraction of a gear pair, its slope in the gap, and its rate at that gap with the length, scaled."""
    if now.gap >= m.scene.cutoff:
        return 0.0, 0.0, 0.0
    inside = _inside(m, now)
    pull, slope = attraction_of(m, now.gap, shares_of(m, coast, pair, inside))
    length, rate = contact_length(m, inside), 0.0
    if now.moves:
        rate = length_and_rates(m, coast, pair, y[PHASE], y[W], 0.0)[1]
    return length * pull, length * slope, rate * pull


@compiled_once(POPULATION)
def attraction_sums(m: Model, y: Floats) -> tuple[float, float, float, float, float, float]:
    """Attraction of all gear pairs: what it adds to F and Fs, with slopes in u and phase; see `mesh_forces`."""
    force = relief = force_u = force_phase = relief_u = relief_phase = 0.0
    turn = m.scene.phase_rate
    reach = pairs_near(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        now = pair_now(m, coast, pair, y)
        if now.gap >= m.scene.cutoff or m.state.history[history_of(m, coast, pair)].pair != pair:
            continue
        sign, along = 1.0 - 2.0 * coast, now.slope / turn
        pull, slope, _ = pair_attraction(m, y, coast, pair, now)
        load, by_u = sign * pull, -slope
        by_phase = -by_u * along
        force += load
        force_u += by_u
        force_phase += by_phase
        if now.slope != 0.0:
            relief += load * now.slope
            relief_u += by_u * now.slope
            relief_phase += by_phase * now.slope + sign * load * m.scene.relief_slope
        if now.moves:
            energies, slopes = attraction_energies(m, now.gap)
            own = weighed_length(m, (coast, pair, y[PHASE]), 1.0, 0.0, energies, slopes)
            relief -= own.rate
            relief_u += sign * own.by_gap
            relief_phase -= own.bend / turn
    return force, relief, force_u, force_phase, relief_u, relief_phase


@compiled_once(POPULATION)
def roller_attraction(m: Model, y: Floats) -> tuple[float, float]:
    """Attraction of a roller and its slope in the height, scaled."""
    return attraction_of(m, y[U], WHOLE)


@compiled_once(POPULATION)
def attraction_energy(m: Model, y: Floats) -> float:
    """Energy of the attraction of all pairs at a state, scaled."""
    if m.scene.kind == ROLLER:
        return weighed(WHOLE, attraction_energies(m, y[U])[0])
    energy, reach = 0.0, pairs_near(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        now = pair_now(m, coast, pair, y)
        if now.gap < m.scene.cutoff and m.state.history[history_of(m, coast, pair)].pair == pair:
            inside = _inside(m, now)
            shares = shares_of(m, coast, pair, inside)
            energy += contact_length(m, inside) * weighed(shares, attraction_energies(m, now.gap)[0])
    return energy
