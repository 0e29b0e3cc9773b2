r"""The mean law of many surfaces: force, energies and losses of a pair whose asperities are known by their statistics.

Each material has a loading branch, and a branch of stretched asperities from the joined height that the pair's history
remembers (`gearidae.contact.kernels.law`). Gaps and joined heights are those of the pair. A material whose gap is wider
by an offset has both wider by it where its tables are read, and nowhere else.
"""

from __future__ import annotations

import math
from typing import Any

from gearidae.compiled import compiled, compiled_once
from gearidae.contact.history import extreme_gap, joined_height
from gearidae.contact.kernels.energy import stretched_energy
from gearidae.contact.kernels.law import (
    B_PIECES,
    branch_length,
    branch_value,
    loading_value,
    set_branch,
    stretched_value,
)
from gearidae.engine.compiling import FRICTION, SOLVER
from gearidae.engine.model.state import MATERIALS, PHASE, Floats, Model
from gearidae.engine.pairs.coverage import (
    NONE,
    Shares,
    added,
    limit_of_loading,
    loading_of,
    potentials_of,
    shares_of,
    weighed,
)
from gearidae.engine.pairs.lengths import length_power, slopes_along_path
from gearidae.engine.pairs.tooth_pairs import PairState, contact_length, flank_of_history, is_on_path
from gearidae.laws.pair_law import NO_PAIR_FORCE, PairForce, PairLaw, both_forces, of_contact, of_path

# -- force -----------------------------------------------------------------------------------------------------------


@compiled(inline=True)
def pair_force(
    m: Model, k: int, known: bool, t: float, gap: float, rate: float, inside: float, shares: Shares
) -> tuple[float, float]:
    """Force of the mean law for one pair and its slope in the gap, scaled, with the pair's own history, the k-th.

    `shares` are those of the materials there, from `gearidae.engine.pairs.coverage.shares_of`. Within a step that has
    turned the pair round, the history first goes through the turning point.
    """
    force, slope = loading_of(m, gap, shares)
    if known:
        h = m.state.history[k]
        turned = h.direction * rate < 0.0
        turning_gap = gap
        if turned:
            turning_gap = extreme_gap(t - m.state.time, h.gap, h.gap_rate, gap, rate)
        for material in range(MATERIALS):
            surface = m.scene.material[material]
            limit = surface.stretch_limit
            if limit == 0.0:
                continue
            joined = h.joined[material]
            if turned:
                joined = joined_height(joined, turning_gap, limit)
            stretch = gap - joined
            if stretch <= 0.0:
                continue
            first = force_branch(m, k, material)
            kept = m.scene.branch_length > 0 and m.rows[first + B_PIECES] > 0.0
            if stretch < limit and not turned and kept:
                q, dq = branch_value(m.rows[first:], stretch)
            else:
                offset = surface.gap_offset
                q, dq = stretched_value(m.tables[surface.table_at :], gap + offset, joined + offset)
            scale = surface.force_scale * shares[material]
            force += scale * q
            slope += scale * dq
    length = contact_length(m, inside)
    return force * length, slope * length


@compiled_once(SOLVER)
def _along_path(m: Model, t: float, y: Floats, pair: PairState) -> PairForce:
    """Force along the path of contact that pays for the changing length, see `gearidae.engine.laws.pairs`."""
    if not is_on_path(m, pair.flank, pair.number):  # just within reach
        return NO_PAIR_FORCE
    energies, slopes = free_energies(m, pair.k, pair.known, t, pair.gap, pair.rate)
    path, by_gap, by_position = slopes_along_path(m, pair.flank, pair.number, y[PHASE], energies, slopes)
    return of_path(-path, -by_gap, -by_position)


@compiled(inline=True)
def _force(m: Model, t: float, y: Floats, pair: PairState, settling: bool, value: PairForce) -> PairForce:
    shares = shares_of(m, pair.flank, pair.number, pair.position)
    load, slope = pair_force(m, pair.k, pair.known, t, pair.gap, pair.rate, pair.position, shares)
    value = both_forces(value, of_contact(load, slope))
    return both_forces(value, _along_path(m, t, y, pair)) if m.scene.curvature_force != 0 else value


@compiled
def set_joined(m: Model, k: int, material: int, joined: float) -> None:
    """Store the joined height of a turning point, and work out the branch that starts from it."""
    h, surface = m.state.history[k], m.scene.material[material]
    h.joined[material] = joined
    number = loading_value(m.tables, surface.number_at, joined + surface.gap_offset)[0]
    h.adhered_energy[material] = -surface.joining_energy * number
    set_branches(m, k, material)


@compiled
def set_branches(m: Model, k: int, material: int) -> None:
    """Work out the branch of a history's joined height.

    A law that is integrated on demand keeps no branches, nor does an elastic contact. The stored energy keeps none: a
    balance looks at it two or three times between turning points, which a branch of all its pieces does not pay for.
    """
    surface = m.scene.material[material]
    table = m.tables[surface.table_at :]
    if m.scene.branch_length > 0 and branch_length(table) > 0:
        joined = m.state.history[k].joined[material] + surface.gap_offset
        set_branch(table, joined, m.rows[force_branch(m, k, material) :])


def set_all_branches(m: Model) -> None:
    """Work out the branches of all histories, where these come from a checkpoint or from another model."""
    for k in range(m.scene.histories):
        for material in range(MATERIALS):
            set_branches(m, k, material)


@compiled
def force_branch(m: Model, k: int, material: int) -> int:
    """Index of a material's branch of the force law at a history's joined height, among the rows."""
    return m.scene.branches_at + (MATERIALS * k + material) * m.scene.branch_length


@compiled_once(FRICTION)
def limit_of_materials(m: Model, t: float, i: int) -> tuple[float, float]:
    """Limit of the i-th pair of the notes and its slope in the gap, as its force is computed, with other laws."""
    noted = m.work.pair_forces.pair[i]
    friction, k, gap = m.scene.friction, noted.history, noted.gap
    h = m.state.history[k]
    shares = shares_of(m, flank_of_history(m, k), noted.pair, noted.position)
    limit, slope = limit_of_loading(m, gap, shares)
    if h.pair == noted.pair:
        turned = h.direction * noted.gap_rate < 0.0
        turning_gap = gap
        if turned:
            turning_gap = extreme_gap(t - m.state.time, h.gap, h.gap_rate, gap, noted.gap_rate)
        for material in range(MATERIALS):
            stretch_limit, offset = (
                m.scene.material[material].stretch_limit,
                m.scene.material[material].gap_offset,
            )
            if stretch_limit == 0.0 or friction.scale[material] == 0.0:
                continue
            joined = h.joined[material]
            if turned:
                joined = joined_height(joined, turning_gap, stretch_limit)
            if gap > joined:
                table = m.tables[friction.table_at[material] :]
                q, dq = stretched_value(table, gap + offset, joined + offset)
                limit += friction.scale[material] * shares[material] * q
                slope += friction.scale[material] * shares[material] * dq
    length = contact_length(m, noted.position)
    return limit * length, slope * length


# -- energies by material --------------------------------------------------------------------------------------------


@compiled
def stored_energies(m: Model, k: int, gap: float) -> tuple[Shares, Shares]:
    """Energy that each material of a rigid pair would store per length if it covered everything; slopes in the gap.

    What joining has lost since the last turning point is still in it.
    """
    (a, b, c), (a1, b1, c1) = potentials_of(m, gap)
    a2, a3 = _stretched(m, k, gap, 0)
    b2, b3 = _stretched(m, k, gap, 1)
    c2, c3 = _stretched(m, k, gap, 2)
    return (a + a2, b + b2, c + c2), (a1 + a3, b1 + b3, c1 + c3)


@compiled(inline=True)
def _stretched(m: Model, k: int, gap: float, material: int) -> tuple[float, float]:
    """Energy of a material's stretched asperities beyond its loading branch, and its slope."""
    h, surface = m.state.history[k], m.scene.material[material]
    scale, stretch = surface.force_scale, gap - h.joined[material]
    if surface.stretch_limit == 0.0:
        return 0.0, 0.0
    if stretch <= 0.0:
        return scale * h.adhered_energy[material], 0.0
    table, offset = m.tables[surface.energy_at :], surface.gap_offset
    e, de = stretched_energy(table, h.adhered_energy[material], gap + offset, h.joined[material] + offset)
    return scale * e, scale * de


@compiled
def free_energies(m: Model, k: int, known: bool, t: float, gap: float, rate: float) -> tuple[Shares, Shares]:
    """Free energy of each material of a rigid pair per length if it covered everything, and its slope in the gap.

    It is what the material stores less what is pending: zero where nothing is in contact, and for an asperity at its
    detachment. Within a step that has turned the pair round, the history first goes through the turning point.

    Parameters
    ----------
    k : int
        Index of the pair's history.
    known : bool
        Whether that is about this pair; if not, nothing is stretched.
    t : float
        Time over tau.
    gap, rate : float
        The pair's gap and gap rate.
    """
    h, turning_gap = m.state.history[k], math.nan
    if known and h.direction * rate < 0.0:
        turning_gap = extreme_gap(t - m.state.time, h.gap, h.gap_rate, gap, rate)
    (a, b, c), (a1, b1, c1) = potentials_of(m, gap)
    a2, a3 = _free(m, k, known, gap, turning_gap, 0)
    b2, b3 = _free(m, k, known, gap, turning_gap, 1)
    c2, c3 = _free(m, k, known, gap, turning_gap, 2)
    return (a + a2, b + b2, c + c2), (a1 + a3, b1 + b3, c1 + c3)


@compiled
def _free(
    m: Model, k: int, known: bool, gap: float, turning_gap: float, material: int
) -> tuple[float, float]:
    """Free energy of a material's asperities beyond its loading branch, and its slope; no turning point is NaN."""
    surface = m.scene.material[material]
    scale, offset = surface.force_scale, surface.gap_offset
    if surface.stretch_limit == 0.0 or scale == 0.0:
        return 0.0, 0.0
    joined = m.state.history[k].joined[material] if known else gap
    if not math.isnan(turning_gap):
        joined = joined_height(joined, turning_gap, surface.stretch_limit)
    number, falling = loading_value(m.tables, surface.number_at, min(gap, joined) + offset)
    adhered = -surface.joining_energy * number
    if gap <= joined:
        return scale * adhered, -(scale * surface.joining_energy * falling)
    e, de = stretched_energy(m.tables[surface.energy_at :], adhered, gap + offset, joined + offset)
    return scale * e, scale * de


# -- what it is asked ------------------------------------------------------------------------------------------------


# put into the sums, like all that is asked in every step: called, it took 10 ns a pair where laws stand behind it
@compiled(inline=True)
def _joining(m: Model, k: int, y: Floats, gap: float, value: tuple[Shares, Shares]) -> tuple[Shares, Shares]:
    joined = m.state.history[k].joined
    if gap >= max(joined[0], joined[1], joined[2]):
        return value
    a, a1 = _loss(m, k, gap, 0)
    b, b1 = _loss(m, k, gap, 1)
    c, c1 = _loss(m, k, gap, 2)
    return added(value, ((a, b, c), (a1, b1, c1)))


@compiled(inline=True)
def _loss(m: Model, k: int, gap: float, material: int) -> tuple[float, float]:
    """Loss of one material by joining, and its slope."""
    surface, h = m.scene.material[material], m.state.history[k]
    if surface.stretch_limit == 0.0 or gap >= h.joined[material]:
        return 0.0, 0.0
    number, slope = loading_value(m.tables, surface.number_at, gap + surface.gap_offset)
    scale = surface.force_scale
    return (
        scale * (surface.joining_energy * number + h.adhered_energy[material]),
        scale * surface.joining_energy * slope,
    )


@compiled
def _energy(m: Model, y: Floats, pair: PairState, value: tuple[float, float]) -> tuple[float, float]:
    length, shares = contact_length(m, pair.position), shares_of(m, pair.flank, pair.number, pair.position)
    stored = length * weighed(shares, stored_energies(m, pair.k, pair.gap)[0])
    lost = length * weighed(shares, _joining(m, pair.k, y, pair.gap, (NONE, NONE))[0])
    return value[0] + stored, value[1] + lost


@compiled(inline=True)
def _power(
    m: Model, t: float, y: Floats, k: int, gap: float, w_rate: float, value: tuple[float, float]
) -> tuple[float, float]:
    energies, slopes = stored_energies(m, k, gap)
    power, rate = length_power(m, k, y, w_rate, energies, slopes)
    return value[0] + power, value[1] + rate


@compiled(inline=True)
def _in_contact(m: Model, k: int, y: Floats, gap: float, material: int, value: float) -> float:
    surface = m.scene.material[material]
    height = joined_height(m.state.history[k].joined[material], gap, surface.stretch_limit)
    return value + loading_value(m.tables, surface.number_at, height + surface.gap_offset)[0]


def _acts(scene: Any) -> bool:
    return bool(scene.nodes == 0 and scene.population.flanks == 0)


STATISTICAL = PairLaw(
    name="statistical asperities",
    acts=_acts,
    force=_force,
    energy=_energy,
    joining=_joining,
    in_contact=_in_contact,
    power=_power,
)
