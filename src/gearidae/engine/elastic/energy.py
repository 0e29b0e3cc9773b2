r"""Stored energy of an elastic contact, and its derivative in the contact length.

A contact of length l stores the energy of its asperities and that of its bodies,

.. math::

    E(g, \ell) = \ell \sum_i w_i \left( u(h_i, \zeta_i) + \tfrac12 p_i d_i \right), \qquad
    d_i = \sum_k \kappa_{ik}(\ell)\, p_k,

with the gaps, pressures and deflections of `gearidae.engine.elastic.nodes` and u the potential of the pressure
between two
planes (`gearidae.contact.kernels.energy`). As the influence coefficients are symmetric, E falls by W dg while the
gap opens
by dg and the length stays. While the gap stays and the length changes,

.. math::

    \frac{\partial E}{\partial \ell} = \frac E\ell - \frac\ell2 \sum_{ik} w_i\, p_i\, \kappa_{ik}'(\ell)\, p_k .
"""

from __future__ import annotations

import numpy as np

from gearidae.compiled import compiled
from gearidae.contact.kernels.energy import stretched_energy
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.elastic.nodes import farthest_joined, node_force, pressure_shares
from gearidae.engine.elastic.rows import (
    ADHERED_ENERGY,
    JOINED,
    PRESSURE,
    first_unknown,
    influence_powers,
    node_profile,
    node_weights,
    point_gaps,
    point_weights,
    row,
)
from gearidae.engine.model.state import MATERIALS, Floats, Model

__all__ = ["nodes_joining_loss", "nodes_length_force", "nodes_stored"]


@compiled(makes_arrays=True)
def nodes_stored(m: Model, k: int, t: float, y: Floats, gap: float, rate: float, length: float) -> float:
    """Energy of one pair per length at given deflections.

    What a closing contact has lost since its last turning point is still in it. The pressures that go with it are left
    in the pair's rows.
    """
    node_force(m, k, True, t, y, gap, rate, length)
    first, profile, weights = first_unknown(m, k), node_profile(m), node_weights(m)
    pressure = row(m, k, PRESSURE)
    energy = 0.0
    for i in range(m.scene.nodes):
        h = gap + profile[i] + y[first + i]
        own = loading_value(m.tables, m.scene.potential_at, h)[0] + 0.5 * pressure[i] * y[first + i]
        energy += weights[i] * own
    finer, gaps = point_weights(m), np.empty(m.scene.points)
    point_gaps(m, k, y, gap, gaps)
    for material in range(MATERIALS):
        if m.scene.material[material].stretch_limit == 0.0:
            continue
        own = m.scene.material[material]
        table = m.tables[own.energy_at :]
        scale, offset = own.force_scale, own.gap_offset
        heights, adhered_energy = row(m, k, JOINED + material), row(m, k, ADHERED_ENERGY + material)
        farthest = farthest_joined(heights[0], offset)
        for i in range(gaps.size):
            if heights[i] > farthest:
                break
            stored = stretched_energy(table, adhered_energy[i], gaps[i] + offset, heights[i] + offset)
            energy += scale * finer[i] * stored[0]
    return energy


@compiled(makes_arrays=True)
def nodes_joining_loss(m: Model, k: int, y: Floats, gap: float) -> float:
    """Adhesion loss per length of the asperities that came into contact since the last turning point."""
    finer, gaps = point_weights(m), np.empty(m.scene.points)
    point_gaps(m, k, y, gap, gaps)
    loss = 0.0
    for material in range(MATERIALS):
        if m.scene.material[material].stretch_limit == 0.0:
            continue
        own = m.scene.material[material]
        joining, scale, number = own.joining_energy, own.force_scale, own.number_at
        heights, adhered_energy = row(m, k, JOINED + material), row(m, k, ADHERED_ENERGY + material)
        for i in range(gaps.size):
            if gaps[i] < heights[i]:
                above = loading_value(m.tables, number, gaps[i] + own.gap_offset)[0]
                more = joining * above + adhered_energy[i]
                loss += scale * finer[i] * more
    return loss


@compiled(makes_arrays=True)
def nodes_length_force(
    m: Model, k: int, t: float, y: Floats, gap: float, rate: float, length: float
) -> tuple[float, float]:
    """The energy's slope in the contact length at fixed gap, and how fast that changes while the gap does."""
    n, orders = m.scene.nodes, m.scene.orders
    energy = nodes_stored(m, k, t, y, gap, rate, length)
    weights, kappa, pressure = node_weights(m), influence_powers(m), row(m, k, PRESSURE)
    moved = np.empty(n)
    pressure_shares(m, k, moved)
    x = (length - m.scene.length_middle) / m.scene.length_half_range
    bend = np.zeros(n)  # of the deflections with the length
    power = 1.0
    for order in range(1, orders):
        for j in range(n):
            p = order * power * pressure[j]
            for i in range(n):
                bend[i] += kappa[order, j, i] * p
        power *= x
    push = bodies = change = 0.0
    for i in range(n):
        push += weights[i] * pressure[i]
        bodies += weights[i] * pressure[i] * bend[i]
        change += 2.0 * weights[i] * bend[i] * moved[i]
    scale = 0.5 * length / m.scene.length_half_range
    return energy - scale * bodies, -(push + scale * change) * rate
