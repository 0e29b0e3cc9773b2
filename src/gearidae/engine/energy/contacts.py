"""Stored energy of contacts, and adhesion loss of their asperities."""

from __future__ import annotations

import math

from gearidae.compiled import compiled, compiled_once
from gearidae.contact.history import extreme_gap, joined_height
from gearidae.contact.kernels.energy import stretched_energy
from gearidae.contact.kernels.law import B_PIECES, branch_length, branch_value, loading_value, set_branch
from gearidae.engine.compiling import SOLVER
from gearidae.engine.elastic.energy import nodes_joining_loss, nodes_stored
from gearidae.engine.model.state import GEARS, MATERIALS, PHASE, Floats, Model, U, V, W
from gearidae.engine.pairs.coverage import Shares, note_shares, potential_of, shares_of
from gearidae.engine.pairs.tooth_pairs import (
    all_pairs,
    contact_length,
    energy_branch,
    history_of,
    pair_at,
    pair_gap,
)
from gearidae.engine.population.forces import population_energy

__all__ = [
    "free_energy",
    "free_material_energy",
    "joined_energy",
    "joining_loss",
    "material_energy",
    "stored_energy",
    "turning_point",
]


@compiled
def joined_energy(m: Model, k: int, gap: float, shares: Shares) -> tuple[float, float]:
    """Energy of a pair's stretched asperities beyond the loading branch, per length, and its slope in the gap."""
    energy = slope = 0.0
    for material in range(MATERIALS):
        scale = m.scene.material[material].force_scale * shares[material]
        if m.scene.material[material].stretch_limit != 0.0 and scale != 0.0:
            e, de = material_energy(m, k, gap, material)
            energy += scale * e
            slope += scale * de
    return energy, slope


@compiled
def material_energy(m: Model, k: int, gap: float, material: int) -> tuple[float, float]:
    """Energy of a material's stretched asperities beyond its loading branch, over its force scale, and its slope."""
    h, own = m.state.history[k], m.scene.material[material]
    stretch = gap - h.joined[material]
    if stretch <= 0.0:
        return h.adhered_energy[material], 0.0
    table, joined = m.tables[own.energy_at :], h.joined[material] + own.gap_offset
    if stretch < own.stretch_limit and m.scene.branch_length > 0 and branch_length(table) > 0:
        branch = m.rows[energy_branch(m, k, material) :]
        if branch[B_PIECES] == 0.0:
            set_branch(table, joined, branch)
        return branch_value(branch, stretch)
    return stretched_energy(table, h.adhered_energy[material], gap + own.gap_offset, joined)


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
    if m.scene.population.flanks != 0:
        return population_energy(m, y), 0.0
    stored = pending = 0.0
    reach = all_pairs(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        k = history_of(m, coast, pair)
        gap, rate, length, inside = y[U], y[V], 1.0, 0.0
        if m.scene.kind == GEARS:
            gap, rate, _, inside = pair_gap(m, coast, pair, y[U], y[V], y[PHASE], y[W])
            length = contact_length(m, inside)
        if gap >= m.scene.cutoff or m.state.history[k].pair != pair:
            continue
        if m.scene.nodes > 0:
            note_shares(m, k, coast, pair, inside)
            stored += length * nodes_stored(m, k, m.state.time, y, gap, rate, length)
            pending += length * nodes_joining_loss(m, k, y, gap)
            continue
        shares = shares_of(m, k, coast, pair, inside)
        energy, _ = joined_energy(m, k, gap, shares)
        stored += length * (potential_of(m, gap, shares) + energy)
        pending += length * joining_loss(m, k, gap, shares)
    return stored, pending


@compiled
def joining_loss(m: Model, k: int, gap: float, shares: Shares) -> float:
    """Adhesion loss per length of the asperities that came into contact since the last turning point."""
    loss, h = 0.0, m.state.history[k]
    for material in range(MATERIALS):
        own = m.scene.material[material]
        if own.stretch_limit > 0.0 and gap < h.joined[material]:
            number = loading_value(m.tables, own.number_at, gap + own.gap_offset)[0]
            scale = own.force_scale * shares[material]
            loss += scale * (own.joining_energy * number + h.adhered_energy[material])
    return loss


@compiled
def free_energy(m: Model, k: int, known: bool, t: float, gap: float, rate: float) -> tuple[float, float]:
    """Free energy of a pair of rigid bodies per length, and its slope in the gap.

    It is what `stored_energy` adds up less what is pending: zero where nothing is in contact, and for an asperity at
    its detachment. Within a step that has turned the pair round, the history first goes through the turning point.

    Parameters
    ----------
    m : Model
    k : int
        Index of the pair's history.
    known : bool
        Whether that is about this pair; if not, nothing is stretched.
    t : float
        Time over tau.
    gap, rate : float
        The pair's gap and gap rate.
    """
    energy, slope = loading_value(m.tables, m.scene.potential_at, gap)
    turning_gap = turning_point(m, k, known, t, gap, rate)
    for material in range(MATERIALS):
        e, de = free_material_energy(m, k, known, gap, turning_gap, material)
        energy += e
        slope += de
    return energy, slope


@compiled
def turning_point(m: Model, k: int, known: bool, t: float, gap: float, rate: float) -> float:
    """Gap of the turning point that a pair has gone through since the last accepted time; NaN if it has not."""
    h = m.state.history[k]
    if not known or h.direction * rate >= 0.0:
        return math.nan
    return extreme_gap(t - m.state.time, h.gap, h.gap_rate, gap, rate)


@compiled
def free_material_energy(
    m: Model, k: int, known: bool, gap: float, turning_gap: float, material: int
) -> tuple[float, float]:
    """Free energy of a material's asperities beyond the loading branch per length, and its slope in the gap.

    Parameters
    ----------
    m, k, known, gap
        As for `free_energy`.
    turning_gap : float
        From `turning_point`.
    material : int
    """
    h, own = m.state.history[k], m.scene.material[material]
    scale, offset = own.force_scale, own.gap_offset
    if own.stretch_limit == 0.0 or scale == 0.0:
        return 0.0, 0.0
    joined = h.joined[material] if known else gap
    if not math.isnan(turning_gap):
        joined = joined_height(joined, turning_gap, own.stretch_limit)
    number, falling = loading_value(m.tables, own.number_at, min(gap, joined) + offset)
    adhered = -own.joining_energy * number
    if gap <= joined:
        return scale * adhered, -(scale * own.joining_energy * falling)
    e, de = stretched_energy(m.tables[own.energy_at :], adhered, gap + offset, joined + offset)
    return scale * e, scale * de
