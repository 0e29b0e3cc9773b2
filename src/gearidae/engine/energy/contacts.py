"""Stored energy of contacts, and adhesion loss of their asperities."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.contact.kernels.energy import stretched_energy
from gearidae.contact.kernels.law import B_PIECES, branch_length, branch_value, loading_value, set_branch
from gearidae.engine.elastic.calls import nodes_joining_loss, nodes_stored
from gearidae.engine.model.coverage import Shares, potential_of, shares_of
from gearidae.engine.model.state import GEARS, MATERIALS, PHASE, Floats, Model, U, V, W
from gearidae.engine.model.tooth_pairs import (
    all_pairs,
    contact_length,
    energy_branch,
    history_of,
    pair_at,
    pair_gap,
)

__all__ = ["joined_energy", "joining_loss", "stored_energy"]


@compiled
def joined_energy(m: Model, k: int, gap: float, shares: Shares) -> tuple[float, float]:
    """Energy of a pair's stretched asperities beyond the loading branch, per length, and its slope in the gap."""
    energy = slope = 0.0
    for material in range(MATERIALS):
        own = m.scene.material[material]
        limit, scale, offset = own.stretch_limit, own.force_scale * shares[material], own.gap_offset
        if limit == 0.0 or scale == 0.0:
            continue
        stretch = gap - m.state.history[k].joined[material]
        if stretch <= 0.0:
            energy += scale * m.state.history[k].adhered_energy[material]
            continue
        table = m.tables[own.energy_at :]
        joined = m.state.history[k].joined[material] + offset
        if stretch < limit and m.scene.branch_length > 0 and branch_length(table) > 0:
            branch = m.rows[energy_branch(m, k, material) :]
            if branch[B_PIECES] == 0.0:
                set_branch(table, joined, branch)
            e, de = branch_value(branch, stretch)
        else:
            e, de = stretched_energy(table, m.state.history[k].adhered_energy[material], gap + offset, joined)
        energy += scale * e
        slope += scale * de
    return energy, slope


@compiled
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
            stored += length * nodes_stored(m, k, m.state.time, y, gap, rate, length)
            pending += length * nodes_joining_loss(m, k, y, gap)
            continue
        shares = shares_of(m, coast, pair, inside)
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
