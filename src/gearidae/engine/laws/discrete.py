r"""Asperities one by one as a law of a pair: sums over those of a population that are joined.

A pair's asperities push with :math:`W = \sum P` along the line of action, and with :math:`T = -\sum P D` along the path
of contact, since the overlaps change with it: that of a stretched asperity behind the contact holds the rolling back.
Both are derivatives of the energy that the asperities store.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from gearidae.compiled import compiled, compiled_once
from gearidae.contact.kernels.single import asperity_energy, asperity_value
from gearidae.engine.compiling import POPULATION
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.pairs.tooth_pairs import PairState
from gearidae.engine.population.contact_point import overlap_slopes, spot_at
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
from gearidae.laws.pair_law import NO_PAIR_FORCE, PairForce, PairLaw, both_forces


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
def _sums(m: Model, k: int, now: PairState) -> Sums:
    """Sum over the joined asperities of the pair with the k-th history."""
    load = load_d = load_slope = stiffness = stiffness_d = stiffness_dd = 0.0
    limit = limit_stiffness = limit_stiffness_d = d = 0.0
    rubs = m.scene.friction.flanks != 0
    at, joined = spot_at(m, now.position, now.moves), column(m, k, JOINED)
    arcs, heights, kinds = column(m, k, ARC), column(m, k, HEIGHT), column(m, k, KIND)
    half_curvature = 0.5 * m.scene.population.steepness / at.radius
    for i in range(m.work.contact[k].joined):
        j = int(m.rows[joined + i])
        x = m.rows[arcs + j] - at.arc
        overlap = m.rows[heights + j] - now.gap - half_curvature * x * x
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


@compiled_once(POPULATION)
def asperity_force(m: Model, pair: PairState) -> PairForce:
    """Force of a pair's joined asperities, with the limit of their friction, scaled."""
    # what is joined belongs to the pair of the history
    if not pair.known or m.work.contact[pair.k].joined == 0:
        return NO_PAIR_FORCE
    s = _sums(m, pair.k, pair)
    return PairForce(
        s.load,
        -s.stiffness,
        0.0,
        s.stiffness_d,
        s.load,
        -s.stiffness,
        -s.load_d,
        s.stiffness_d,
        -(s.stiffness_dd + s.load_slope),
        s.limit,
        -s.limit_stiffness,
        s.limit_stiffness_d,
    )


@compiled_once(POPULATION)
def _stored(m: Model, pair: PairState) -> float:
    """Energy that a pair's joined asperities store, from free surfaces, scaled."""
    energy, k, joined = 0.0, pair.k, column(m, pair.k, JOINED)
    at = spot_at(m, pair.position, pair.moves)
    for n in range(m.work.contact[k].joined):
        j = int(m.rows[joined + n])
        x = m.rows[column(m, k, ARC) + j] - at.arc
        overlap = m.rows[column(m, k, HEIGHT) + j] - pair.gap
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


@compiled(inline=True)
def _force(m: Model, t: float, y: Floats, pair: PairState, settling: bool, value: PairForce) -> PairForce:
    return both_forces(value, asperity_force(m, pair))


@compiled
def _energy(m: Model, y: Floats, pair: PairState, value: tuple[float, float]) -> tuple[float, float]:
    return value[0] + _stored(m, pair), value[1]


def _acts(scene: Any) -> bool:
    return bool(scene.population.flanks != 0)


DISCRETE = PairLaw(name="discrete asperities", acts=_acts, force=_force, energy=_energy)
