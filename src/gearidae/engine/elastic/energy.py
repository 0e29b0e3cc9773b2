r"""Stored energy of an elastic contact, and its derivative in the contact length.

A contact of length l stores the energy of its asperities and that of its bodies,

.. math::

    E(g, \ell) = \ell \sum_i w_i \left( u(h_i, \zeta_i) + \tfrac12 p_i d_i \right), \qquad
    d_i = \sum_k \kappa_{ik}(\ell)\, p_k,

with the gaps, pressures and deflections of `gearidae.engine.elastic.nodes` and u the potential of the pressure
between two planes (`gearidae.contact.kernels.energy`). As :math:`w_i \kappa_{ik} = w_k \kappa_{ki}` (see
`gearidae.engine.elastic.layout`), E falls by W dg while the gap opens by dg and the length stays. While the gap stays
and the length changes,

.. math::

    \frac{\partial E}{\partial \ell} = \frac E\ell - \frac\ell2 \sum_{ik} w_i\, p_i\, \kappa_{ik}'(\ell)\, p_k .
"""

from __future__ import annotations

import numpy as np

from gearidae.compiled import compiled, compiled_once
from gearidae.contact.history import joined_height
from gearidae.contact.kernels.energy import stretched_energy
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.compiling import ELASTIC
from gearidae.engine.elastic.node_rows import (
    ADHERED_ENERGY,
    GAP_SHARE,
    JOINED,
    PRESSURE,
    first_unknown,
    influence_powers,
    node_profile,
    node_weights,
    point_gaps,
    point_weights,
    row,
    to_points,
)
from gearidae.engine.elastic.nodes import farthest_joined, force_of_nodes, pressure_shares
from gearidae.engine.model.state import MATERIALS, Floats, Model
from gearidae.engine.pairs.coverage import Shares, noted_shares, potential_of, potentials_of


@compiled_once(ELASTIC, makes_arrays=True)
def nodes_stored(m: Model, k: int, t: float, y: Floats, gap: float, rate: float, length: float) -> float:
    """Energy of one pair per length at given deflections.

    What a closing contact has lost since its last turning point is still in it. The pressures that go with it are left
    in the pair's rows.
    """
    force_of_nodes(m, k, True, t, y, gap, rate, length)
    first, profile, weights = first_unknown(m, k), node_profile(m), node_weights(m)
    pressure, shares = row(m, k, PRESSURE), noted_shares(m, k)
    energy = 0.0
    for i in range(m.scene.nodes):
        h = gap + profile[i] + y[first + i]
        at_node = potential_of(m, h, shares) + 0.5 * pressure[i] * y[first + i]
        energy += weights[i] * at_node
    gaps = np.empty(m.scene.points)
    point_gaps(m, k, y, gap, gaps)
    for material in range(MATERIALS):
        energy += shares[material] * _stretched(m, k, gaps, gaps, material)[0]
    return energy


@compiled_once(ELASTIC, makes_arrays=True)
def nodes_losses(m: Model, k: int, y: Floats, gap: float) -> Shares:
    """Loss per length of the asperities that have joined since the last turning point, of each material.

    As if it covered everything.
    """
    gaps = np.empty(m.scene.points)
    point_gaps(m, k, y, gap, gaps)
    return _loss(m, k, gaps, 0), _loss(m, k, gaps, 1), _loss(m, k, gaps, 2)


@compiled(makes_arrays=True)
def _loss(m: Model, k: int, gaps: Floats, material: int) -> float:
    """Joining loss of a material; 0 of one without hysteresis."""
    finer, surface, loss = point_weights(m), m.scene.material[material], 0.0
    heights, adhered_energy = row(m, k, JOINED + material), row(m, k, ADHERED_ENERGY + material)
    for i in range(gaps.size if surface.stretch_limit != 0.0 else 0):
        if gaps[i] < heights[i]:
            above = loading_value(m.tables, surface.number_at, gaps[i] + surface.gap_offset)[0]
            more = surface.joining_energy * above + adhered_energy[i]
            loss += surface.force_scale * finer[i] * more
    return loss


@compiled_once(ELASTIC, makes_arrays=True)
def nodes_energies(m: Model, k: int, y: Floats, gap: float) -> tuple[Shares, Shares]:
    """Energy of each material's asperities per length as if it covered everything, and its slope in the pair's gap.

    It is the slope of a pair's energy in the material's share, at fixed gap and length: by symmetry of the influence
    coefficients what changes of the deflections leaves the energy as it is.
    """
    first, profile, weights, share = (
        first_unknown(m, k),
        node_profile(m),
        node_weights(m),
        row(m, k, GAP_SHARE),
    )
    a = b = c = a1 = b1 = c1 = 0.0
    for i in range(m.scene.nodes):
        potentials, pushes = potentials_of(m, gap + profile[i] + y[first + i])
        moved = weights[i] * share[i]
        a, a1 = a + weights[i] * potentials[0], a1 + moved * pushes[0]
        b, b1 = b + weights[i] * potentials[1], b1 + moved * pushes[1]
        c, c1 = c + weights[i] * potentials[2], c1 + moved * pushes[2]
    gaps, moves = np.empty(m.scene.points), np.empty(m.scene.points)
    point_gaps(m, k, y, gap, gaps)
    to_points(m, share, moves)
    a2, a3 = _stretched(m, k, gaps, moves, 0)
    b2, b3 = _stretched(m, k, gaps, moves, 1)
    c2, c3 = _stretched(m, k, gaps, moves, 2)
    return (a + a2, b + b2, c + c2), (a1 + a3, b1 + b3, c1 + c3)


@compiled(makes_arrays=True)
def _stretched(m: Model, k: int, gaps: Floats, moves: Floats, material: int) -> tuple[float, float]:
    """Energy of a material's stretched asperities, and its slope where the points move so far with the pair's gap."""
    surface, finer, energy, slope = m.scene.material[material], point_weights(m), 0.0, 0.0
    heights, adhered_energy = row(m, k, JOINED + material), row(m, k, ADHERED_ENERGY + material)
    offset, table = surface.gap_offset, m.tables[surface.energy_at :]
    farthest = farthest_joined(heights[0], offset)
    for i in range(gaps.size if surface.stretch_limit != 0.0 else 0):
        if heights[i] > farthest:
            break
        e, de = stretched_energy(table, adhered_energy[i], gaps[i] + offset, heights[i] + offset)
        energy += surface.force_scale * finer[i] * e
        slope += surface.force_scale * finer[i] * moves[i] * de
    return energy, slope


@compiled_once(ELASTIC, makes_arrays=True)
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
    by_length = np.zeros(n)  # of the deflections with the length
    power = 1.0
    for order in range(1, orders):
        for j in range(n):
            p = order * power * pressure[j]
            for i in range(n):
                by_length[i] += kappa[order, j, i] * p
        power *= x
    push = bodies = change = 0.0
    for i in range(n):
        push += weights[i] * pressure[i]
        bodies += weights[i] * pressure[i] * by_length[i]
        change += 2.0 * weights[i] * by_length[i] * moved[i]
    scale = 0.5 * length / m.scene.length_half_range
    return energy - scale * bodies, -(push + scale * change) * rate


@compiled_once(ELASTIC, makes_arrays=True)
def nodes_number(m: Model, k: int, y: Floats, gap: float, material: int) -> float:
    """Asperities of a material in contact per length, over their density."""
    finer, gaps = point_weights(m), np.empty(m.scene.points)
    point_gaps(m, k, y, gap, gaps)
    surface, heights = m.scene.material[material], row(m, k, JOINED + material)
    number = 0.0
    for i in range(gaps.size):
        height = joined_height(heights[i], gaps[i], surface.stretch_limit)
        number += finer[i] * loading_value(m.tables, surface.number_at, height + surface.gap_offset)[0]
    return number
