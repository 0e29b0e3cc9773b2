r"""What an elastic contact stores, and what its footprint's length has to do with it.

A contact on a footprint of length l stores the energy of its asperities and that of its bodies,

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
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.contact.kernels.energy import stretched_energy
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.elastic.nodes import (
    farthest_joined,
    first_unknown,
    node_force,
    point_count,
    point_gaps,
    point_weights,
    pressure_shares,
    row,
)
from gearidae.engine.model import layout as at
from gearidae.engine.model.tooth_pairs import material_stretch

__all__ = ["nodes_joining_loss", "nodes_length_force", "nodes_stored"]

Floats = NDArray[np.float64]


@compiled(makes_arrays=True)
def nodes_stored(d: Floats, slot: int, t: float, y: Floats, gap: float, rate: float, length: float) -> float:
    """Energy of one pair per length at given deflections.

    What a closing contact has lost since its last turning point is still in it. The pressures that go with it are left
    in the pair's history.
    """
    node_force(d, slot, True, t, y, gap, rate, length)
    n, first, grid = int(d[at.NODES]), first_unknown(d, slot), int(d[at.GRID_AT])
    pressure = row(d, slot, at.ROW_PRESSURE)
    energy = 0.0
    for i in range(n):
        h = gap + d[grid + i] + y[first + i]
        own = loading_value(d, int(d[at.POTENTIAL_AT]), h)[0] + 0.5 * d[pressure + i] * y[first + i]
        energy += d[grid + n + i] * own
    weights, gaps = point_weights(d), np.empty(point_count(n))
    point_gaps(d, slot, y, gap, gaps)
    for material in range(2):
        if material_stretch(d, material) == 0.0:
            continue
        record = at.ENERGIES + at.ENERGY * material
        table = d[int(d[record + at.E_TABLE]) :]
        scale = d[at.MATERIALS + at.MATERIAL * material + at.M_FORCE]
        heights, booked = row(d, slot, at.ROW_JOINED + material), row(d, slot, at.ROW_BOOKED + material)
        farthest = farthest_joined(d[heights])
        for k in range(gaps.size):
            if d[heights + k] > farthest:
                break
            stored = stretched_energy(table, d[booked + k], gaps[k], d[heights + k])[0]
            energy += scale * d[weights + k] * stored
    return energy


@compiled(makes_arrays=True)
def nodes_joining_loss(d: Floats, slot: int, y: Floats, gap: float) -> float:
    """What the asperities that a closing contact has joined since its last turning point have lost, per length."""
    weights, gaps = point_weights(d), np.empty(point_count(int(d[at.NODES])))
    point_gaps(d, slot, y, gap, gaps)
    number = int(d[at.NUMBER_AT])
    loss = 0.0
    for material in range(2):
        if material_stretch(d, material) == 0.0:
            continue
        joining = d[at.ENERGIES + at.ENERGY * material + at.E_JOINING]
        scale = d[at.MATERIALS + at.MATERIAL * material + at.M_FORCE]
        heights, booked = row(d, slot, at.ROW_JOINED + material), row(d, slot, at.ROW_BOOKED + material)
        for k in range(gaps.size):
            if gaps[k] < d[heights + k]:
                more = joining * loading_value(d, number, gaps[k])[0] + d[booked + k]
                loss += scale * d[weights + k] * more
    return loss


@compiled(makes_arrays=True)
def nodes_length_force(
    d: Floats, slot: int, t: float, y: Floats, gap: float, rate: float, length: float
) -> tuple[float, float]:
    """The energy's slope in the footprint's length at fixed gap, and how fast that changes while the gap does."""
    n, orders = int(d[at.NODES]), int(d[at.ORDERS])
    energy = nodes_stored(d, slot, t, y, gap, rate, length)
    weights, start = int(d[at.GRID_AT]) + n, int(d[at.GRID_AT]) + 2 * n
    kappa = d[start : start + orders * n * n].reshape(orders, n, n)
    pressure = row(d, slot, at.ROW_PRESSURE)
    moved = np.empty(n)
    pressure_shares(d, slot, moved)
    x = (length - d[at.LENGTH_MIDDLE]) / d[at.LENGTH_HALF]
    bend = np.zeros(n)  # of the deflections with the length
    power = 1.0
    for m in range(1, orders):
        for k in range(n):
            p = m * power * d[pressure + k]
            for i in range(n):
                bend[i] += kappa[m, k, i] * p
        power *= x
    push = bodies = change = 0.0
    for i in range(n):
        push += d[weights + i] * d[pressure + i]
        bodies += d[weights + i] * d[pressure + i] * bend[i]
        change += 2.0 * d[weights + i] * bend[i] * moved[i]
    scale = 0.5 * length / d[at.LENGTH_HALF]
    return energy - scale * bodies, -(push + scale * change) * rate
