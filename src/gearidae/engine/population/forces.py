r"""Forces and energy of a population: sums over the joined asperities of all pairs.

A pair's asperities push with :math:`W = \sum P` along the line of action, and with :math:`T = -\sum P D` along the path
of contact, since the overlaps change with it: that of a stretched asperity behind the contact holds the rolling back.
Both are derivatives of the energy that the asperities store.
"""

from __future__ import annotations

from typing import NamedTuple

from gearidae.compiled import compiled, compiled_once
from gearidae.contact.kernels.single import asperity_energy, asperity_value
from gearidae.engine.compiling import POPULATION
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.pairs.notes import note_force
from gearidae.engine.pairs.tooth_pairs import history_of, pair_at, pairs_near
from gearidae.engine.population.attraction import attraction_sums, pair_attraction, roller_attraction
from gearidae.engine.population.layout import (
    ARC,
    HEIGHT,
    JOINED,
    K_AREA,
    K_ENERGY,
    K_FRICTION,
    K_LOAD,
    K_SCALE,
    K_TABLE,
    KIND,
    column,
)
from gearidae.engine.population.spots import Pair, overlap_slopes, pair_now, spot_at


class Sums(NamedTuple):
    """Sums over the joined asperities of a pair: loads P and stiffnesses K, alone and with D, its square and slope.

    The last are limits of friction and their stiffnesses, alone and with D.
    """

    load: float
    load_d: float
    load_slope: float
    stiffness: float
    stiffness_d: float
    stiffness_dd: float
    limit: float
    limit_stiffness: float
    limit_stiffness_d: float


@compiled(inline=True)
def candidate_load(m: Model, kind: int, overlap: float) -> tuple[float, float]:
    """Load and stiffness of a joined asperity of a kind at an overlap, scaled."""
    scale = m.tables[kind + K_SCALE]
    load, slope = asperity_value(m.tables, int(m.tables[kind + K_TABLE]), scale * overlap)
    unit = m.tables[kind + K_LOAD]
    return unit * load, unit * scale * slope


@compiled(inline=True)
def candidate_energy(m: Model, kind: int, overlap: float) -> float:
    """Energy that a joined asperity of a kind stores at an overlap, from free surfaces, scaled."""
    at = int(m.tables[kind + K_TABLE])
    return m.tables[kind + K_ENERGY] * asperity_energy(m.tables, at, m.tables[kind + K_SCALE] * overlap)


@compiled(inline=True)
def _sums(m: Model, k: int, now: Pair) -> Sums:
    """Sum over the joined asperities of the pair with the k-th history."""
    load = load_d = load_slope = stiffness = stiffness_d = stiffness_dd = 0.0
    limit = limit_stiffness = limit_stiffness_d = d = 0.0
    rubs = m.scene.friction.flanks != 0
    at, joined = spot_at(m, now.place, now.moves), column(m, k, JOINED)
    arcs, heights, kinds = column(m, k, ARC), column(m, k, HEIGHT), column(m, k, KIND)
    bend = 0.5 * m.scene.population.steepness / at.radius
    for i in range(m.work.contact[k].joined):
        j = int(m.rows[joined + i])
        x = m.rows[arcs + j] - at.arc
        overlap = m.rows[heights + j] - now.gap - bend * x * x
        p, s = candidate_load(m, int(m.rows[kinds + j]), overlap)
        load += p
        stiffness += s
        if now.moves:
            d, slope = overlap_slopes(m, at, x)
            load_d += p * d
            load_slope += p * slope
            stiffness_d += s * d
            stiffness_dd += s * d * d
        if rubs:
            p, s = candidate_limit(m, int(m.rows[kinds + j]), overlap, p, s)
            limit += p
            limit_stiffness += s
            if now.moves:
                limit_stiffness_d += s * d
    return Sums(
        load,
        load_d,
        load_slope,
        stiffness,
        stiffness_d,
        stiffness_dd,
        limit,
        limit_stiffness,
        limit_stiffness_d,
    )


@compiled(inline=True)
def candidate_limit(
    m: Model, kind: int, overlap: float, load: float, stiffness: float
) -> tuple[float, float]:
    """Limit of the friction of a joined asperity and its stiffness, from its load or its area, as its kind has it."""
    share = m.tables[kind + K_FRICTION]
    if m.scene.friction.shear != 0:
        scale = m.tables[kind + K_SCALE]
        area, slope = asperity_value(m.tables, int(m.tables[kind + K_AREA]), scale * overlap)
        return share * area, share * scale * slope
    return share * load, share * stiffness


@compiled(inline=True)
def _note_sums(m: Model, k: int, pair: int, now: Pair, sums: Sums) -> None:
    """Note force and limit of friction of a pair, with their rates."""
    noted = m.work.notes.pair[m.work.notes.count]
    note_force(m, k, pair, now.place, (now.gap, now.rate), (sums.load, -sums.stiffness))
    noted.force_rate = sums.stiffness_d * now.place_rate - sums.stiffness * now.rate
    noted.limit, noted.limit_slope = sums.limit, -sums.limit_stiffness
    noted.limit_rate = sums.limit_stiffness_d * now.place_rate - sums.limit_stiffness * now.rate


@compiled_once(POPULATION)
def mesh_sums(m: Model, y: Floats) -> tuple[float, float, float, float, float, float]:
    """Forces F and Fs of a population and its attraction, with their slopes; see `mesh_forces` of the residual."""
    force = relief = force_u = force_phase = relief_u = relief_phase = 0.0
    turn = m.scene.phase_rate
    if m.scene.friction.on != 0:  # no notes of a time that exposures might take for their own
        m.work.notes.count, m.work.notes.time = 0, -1.0
    reach = pairs_near(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        k = history_of(m, coast, pair)
        if m.work.contact[k].joined == 0 or m.state.history[k].pair != pair:
            continue
        sign, now = 1.0 - 2.0 * coast, pair_now(m, coast, pair, y)
        sums, slope = _sums(m, k, now), now.slope
        if m.scene.friction.on != 0:
            _note_sums(m, k, pair, now, sums)
        force += sign * sums.load
        force_u += sums.stiffness
        force_phase += sums.stiffness_d - sums.stiffness * slope / turn
        relief += sign * (sums.load * slope - turn * sums.load_d)
        relief_u += sums.stiffness * slope - turn * sums.stiffness_d
        relief_phase += 2.0 * slope * sums.stiffness_d - sums.stiffness * slope * slope / turn
        relief_phase -= turn * (sums.stiffness_dd + sums.load_slope)
        if slope != 0.0:
            relief_phase += sums.load * m.scene.relief_slope
    if m.scene.attracts != 0:
        a, b, a_u, a_phase, b_u, b_phase = attraction_sums(m, y)
        return (
            force + a,
            relief + b,
            force_u + a_u,
            force_phase + a_phase,
            relief_u + b_u,
            relief_phase + b_phase,
        )
    return force, relief, force_u, force_phase, relief_u, relief_phase


@compiled_once(POPULATION)
def roller_sum(m: Model, y: Floats) -> tuple[float, float]:
    """Force of a population on a roller, its attraction included, and its slope in the height, scaled."""
    load = slope = 0.0
    if m.work.contact[0].joined != 0:
        sums = _sums(m, 0, pair_now(m, 0, 0, y))
        load, slope = sums.load, -sums.stiffness
    if m.scene.attracts != 0:
        pull, change = roller_attraction(m, y)
        return load + pull, slope + change
    return load, slope


@compiled_once(POPULATION)
def pair_load(m: Model, y: Floats, coast: int, pair: int) -> tuple[float, float, float]:
    """Force of a pair along the line of action, its slope in the gap, and its rate at that gap, scaled."""
    now = pair_now(m, coast, pair, y)
    sums = _sums(m, history_of(m, coast, pair), now)
    load, slope, rate = sums.load, -sums.stiffness, sums.stiffness_d * now.place_rate
    if m.scene.attracts != 0:
        pull, change, growth = pair_attraction(m, y, coast, pair, now)
        return load + pull, slope + change, rate + growth
    return load, slope, rate


@compiled_once(POPULATION)
def population_energy(m: Model, y: Floats) -> float:
    """Energy that all joined asperities store at a state, from free surfaces, scaled."""
    energy, reach = 0.0, pairs_near(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        k = history_of(m, coast, pair)
        if m.work.contact[k].joined == 0 or m.state.history[k].pair != pair:
            continue
        now, joined = pair_now(m, coast, pair, y), column(m, k, JOINED)
        at = spot_at(m, now.place, now.moves)
        for n in range(m.work.contact[k].joined):
            j = int(m.rows[joined + n])
            x = m.rows[column(m, k, ARC) + j] - at.arc
            overlap = m.rows[column(m, k, HEIGHT) + j] - now.gap
            overlap -= 0.5 * m.scene.population.steepness / at.radius * x * x
            energy += candidate_energy(m, int(m.rows[column(m, k, KIND) + j]), overlap)
    return energy


@compiled_once(POPULATION)
def asperities_joined(m: Model) -> tuple[float, float]:
    """Asperities that are joined, and pairs that have any."""
    asperities = pairs = 0.0
    for k in range(m.scene.histories):
        asperities += m.work.contact[k].joined
        pairs += 1.0 if m.work.contact[k].joined > 0 else 0.0
    return asperities, pairs
