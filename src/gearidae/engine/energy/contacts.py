"""Energies of contacts by material: what they store, their free energy, and what joining has lost."""

from __future__ import annotations

import math

from gearidae.compiled import compiled, compiled_once
from gearidae.contact.history import extreme_gap, joined_height
from gearidae.contact.kernels.energy import stretched_energy
from gearidae.contact.kernels.law import B_PIECES, branch_length, branch_value, loading_value, set_branch
from gearidae.engine.compiling import SOLVER
from gearidae.engine.elastic.energy import nodes_losses, nodes_stored
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.pairs.attraction_force import attraction_energy
from gearidae.engine.pairs.coverage import NONE, Shares, note_shares, potentials_of, shares_of, weighed
from gearidae.engine.pairs.tooth_pairs import (
    PairState,
    acts,
    contact_length,
    energy_branch,
    flank_of_history,
    list_known,
)
from gearidae.engine.population.contact_point import state_of_pair
from gearidae.engine.population.forces import asperities_energy


@compiled_once(SOLVER)
def stored_energy(m: Model, y: Floats) -> tuple[float, float]:
    """Stored energy of all contacts, and the part lost by asperities in contact since the last turning point.

    Parameters
    ----------
    m : Model
        With the histories as they are at `y`.
    y : ndarray
        State.

    Returns
    -------
    stored, pending : float
        Scaled; the true stored energy is their difference.
    """
    stored = pending = 0.0
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        pair = state_of_pair(m, flank_of_history(m, k), m.state.history[k].pair, y)
        if acts(m, pair):
            energy, lost = _pair_energies(m, y, pair)
            stored += energy
            pending += lost
    return stored, pending


@compiled
def _pair_energies(m: Model, y: Floats, pair: PairState) -> tuple[float, float]:
    """Stored energy of a pair, and the part lost by asperities in contact since its last turning point."""
    stored = pending = 0.0
    if m.scene.population.flanks != 0:
        stored = asperities_energy(m, pair)
    else:
        k, gap, length = pair.k, pair.gap, contact_length(m, pair.place)
        shares = shares_of(m, pair.coast, pair.number, pair.place)
        if m.scene.nodes > 0:
            note_shares(m, k, pair.coast, pair.number, pair.place)
            stored = length * nodes_stored(m, k, m.state.time, y, gap, pair.rate, length)
        else:
            stored = length * weighed(shares, stored_energies(m, k, gap)[0])
        pending = length * weighed(shares, joining_losses(m, k, y, gap)[0])
    return (stored + attraction_energy(m, pair) if m.scene.attracts != 0 else stored), pending


# -- of a rigid pair, by material ------------------------------------------------------------------------------------


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
    table, joined = m.tables[surface.energy_at :], h.joined[material] + surface.gap_offset
    if stretch < surface.stretch_limit and m.scene.branch_length > 0 and branch_length(table) > 0:
        branch = m.rows[energy_branch(m, k, material) :]
        if branch[B_PIECES] == 0.0:
            set_branch(table, joined, branch)
        e, de = branch_value(branch, stretch)
    else:
        e, de = stretched_energy(table, h.adhered_energy[material], gap + surface.gap_offset, joined)
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


# -- of any pair -----------------------------------------------------------------------------------------------------


@compiled
def joining_losses(m: Model, k: int, y: Floats, gap: float) -> tuple[Shares, Shares]:
    """What each material of a pair has lost per length by joining since the last turning point, and slopes in the gap.

    Of each as if it covered everything. Of an elastic contact the slopes are those of a rigid one in proportion.
    """
    joined, losses = m.state.history[k].joined, NONE
    if m.scene.nodes > 0:
        losses = nodes_losses(m, k, y, gap)
    elif gap >= max(joined[0], joined[1], joined[2]):
        return NONE, NONE
    a, a1 = _loss(m, k, gap, 0, losses[0])
    b, b1 = _loss(m, k, gap, 1, losses[1])
    c, c1 = _loss(m, k, gap, 2, losses[2])
    return (a, b, c), (a1, b1, c1)


@compiled(inline=True)
def _loss(m: Model, k: int, gap: float, material: int, loss: float) -> tuple[float, float]:
    """Loss of one material and its slope; that of an elastic contact is `loss`."""
    surface, h = m.scene.material[material], m.state.history[k]
    elastic, scale = m.scene.nodes > 0, surface.force_scale
    if surface.stretch_limit == 0.0 or (gap >= h.joined[material] and not elastic):
        return 0.0, 0.0
    number, slope = loading_value(m.tables, surface.number_at, gap + surface.gap_offset)
    if elastic:
        return loss, (loss * slope / number if number > 0.0 else 0.0)
    return (
        scale * (surface.joining_energy * number + h.adhered_energy[material]),
        scale * surface.joining_energy * slope,
    )
