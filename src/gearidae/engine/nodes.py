r"""Nodes of an elastic contact: their gaps, pressures and histories (Teodorescu et al. 2009, Eqs. 13-15).

Across a pair's contact lie nodes at ``x = s sqrt(2 R sigma)``, with s the same for every pair. The gap at a node is
that of the rigid profiles and the deflection of both bodies under all the pressures,

.. math::

    h_i = g + s_i^2 + d_i, \qquad d_i = \sum_k \kappa_{ik}(\ell)\, p(h_k, \zeta_k), \qquad
    W = \ell \sum_i w_i\, p(h_i, \zeta_i),

lengths in roughnesses, :math:`\ell` the length of the footprint, which changes along the path of contact with the
radius R. The deflections d are unknowns of the integration beside the motion. Each node remembers its own joined
heights. While a contact is stable every node's gap moves with the pair's, one way or the other together with it, so
that all of them turn round when the pair does: that instant is found as a root, and the joined heights taken there are
those of the play operator without an error of their own.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.contact.history import extreme_gap, joined_height
from gearidae.contact.law import GAP_HIGH, loading_value, stretched_value
from gearidae.engine import layout as at
from gearidae.engine.mesh import material_stretch

__all__ = [
    "first_unknown",
    "follow_nodes",
    "influence",
    "join_nodes",
    "meet_nodes",
    "middle_gap",
    "node_force",
    "node_rates",
    "node_residual",
    "row",
    "unload",
]

Floats = NDArray[np.float64]

_MOVED = 1e-5  # roughnesses; over less than this the share of a node in the motion cannot be told
_LARGEST_SHARE = 4.0


@compiled
def first_unknown(d: Floats, slot: int) -> int:
    """Place in the state of a history's first deflection, that of the middle."""
    motion = 2 if d[at.KIND] == at.ROLLER else 4
    block = (slot - int(d[at.HISTORIES])) // int(d[at.HISTORY])
    return motion + block * int(d[at.NODES])


@compiled
def row(d: Floats, slot: int, kind: int) -> int:
    """Offset of a row of numbers, one per node, in a pair's history."""
    return slot + at.NODE_ROWS + kind * int(d[at.NODES])


@compiled
def middle_gap(d: Floats, slot: int, y: Floats, gap: float) -> float:
    """Gap in the middle of a contact: the pair's own, opened by the deflection of an elastic one."""
    return gap if d[at.NODES] == 0.0 else gap + y[first_unknown(d, slot)]


@compiled
def unload(d: Floats) -> None:
    """Mark every pair as out of reach, before those within reach are evaluated."""
    for k in range(int(d[at.TOTAL_SLOTS])):
        d[int(d[at.HISTORIES]) + int(d[at.HISTORY]) * k + at.LOADED] = 0.0


@compiled
def node_force(
    d: Floats, slot: int, known: bool, t: float, y: Floats, gap: float, rate: float, length: float
) -> tuple[float, float]:
    """Force of one pair at given deflections and its slope in the pair's gap, scaled.

    The pressures and their slopes are left in the pair's history. Within a step that has turned the pair round, the
    nodes' histories first go through the turning point, each by its share in the motion.
    """
    n = int(d[at.NODES])
    first, grid = first_unknown(d, slot), int(d[at.GRID_AT])
    pressure, slope = row(d, slot, at.ROW_PRESSURE), row(d, slot, at.ROW_SLOPE)
    share = row(d, slot, at.ROW_SHARE)
    loading = int(d[at.LOADING_AT])
    turned = known and d[slot + at.WAY] * rate < 0.0
    back = 0.0
    if turned:
        span = t - d[at.LAST_TIME]
        back = extreme_gap(span, d[slot + at.LAST_GAP], d[slot + at.LAST_RATE], gap, rate) - gap
    force = 0.0
    stiffness = 0.0
    for i in range(n):
        h = gap + d[grid + i] + y[first + i]
        p = dp = 0.0
        if h < GAP_HIGH:
            p, dp = loading_value(d, loading, h)
            for material in range(2 if known else 0):
                limit = material_stretch(d, material)
                if limit == 0.0:
                    continue
                joined = d[row(d, slot, at.ROW_JOINED + material) + i]
                if turned:
                    joined = joined_height(joined, h + d[share + i] * back, limit)
                if h > joined:
                    record = at.MATERIALS + at.MATERIAL * material
                    q, dq = stretched_value(d[int(d[record + at.M_TABLE]) :], h, joined)
                    p += d[record + at.M_FORCE] * q
                    dp += d[record + at.M_FORCE] * dq
        d[pressure + i] = p
        d[slope + i] = dp
        force += d[grid + n + i] * p
        stiffness += d[grid + n + i] * dp
    d[slot + at.LOADED] = 1.0
    d[slot + at.LENGTH] = length
    return force * length, stiffness * length


@compiled
def influence(d: Floats, length: float, factor: Floats, out: Floats) -> None:
    """Influence coefficients times a factor per column, column by column.

    Parameters
    ----------
    d : ndarray
        See `layout`.
    length : float
        Length of the footprint.
    factor : ndarray, shape (n,)
    out : ndarray, shape (n, n)
        ``out[k, i]`` becomes ``kappa_ik factor_k``.
    """
    n, orders = int(d[at.NODES]), int(d[at.ORDERS])
    first = int(d[at.GRID_AT]) + 2 * n
    kappa = d[first : first + orders * n * n].reshape(orders, n, n)
    x = (length - d[at.LENGTH_MIDDLE]) / d[at.LENGTH_HALF]
    for k in range(n):
        for i in range(n):
            out[k, i] = kappa[orders - 1, k, i]
        for m in range(orders - 2, -1, -1):
            for i in range(n):
                out[k, i] = out[k, i] * x + kappa[m, k, i]
        for i in range(n):
            out[k, i] *= factor[k]


@compiled
def node_residual(d: Floats, y: Floats, out: Floats) -> None:
    """Equations of the nodes, from the pressures that the forces have just left: deflections are those they cause."""
    n, orders = int(d[at.NODES]), int(d[at.ORDERS])
    start = int(d[at.GRID_AT]) + 2 * n
    kappa = d[start : start + orders * n * n].reshape(orders, n, n)
    for block in range(int(d[at.TOTAL_SLOTS])):
        slot = int(d[at.HISTORIES]) + int(d[at.HISTORY]) * block
        first = first_unknown(d, slot)
        own = out[first : first + n]
        for i in range(n):
            own[i] = y[first + i]
        if d[slot + at.LOADED] == 0.0:
            continue
        pressure = row(d, slot, at.ROW_PRESSURE)
        x = (d[slot + at.LENGTH] - d[at.LENGTH_MIDDLE]) / d[at.LENGTH_HALF]
        power = 1.0
        for m in range(orders):
            for k in range(n):
                p = power * d[pressure + k]
                if p != 0.0:
                    for i in range(n):
                        own[i] -= kappa[m, k, i] * p
            power *= x


@compiled
def node_rates(d: Floats, yp: Floats) -> None:
    """Rates of the deflections at an accepted time, as far as the nodes' shares in the last motion tell."""
    n = int(d[at.NODES])
    for block in range(int(d[at.TOTAL_SLOTS])):
        slot = int(d[at.HISTORIES]) + int(d[at.HISTORY]) * block
        first, share = first_unknown(d, slot), row(d, slot, at.ROW_SHARE)
        near = d[slot + at.PAIR] == d[slot + at.PAIR] and d[slot + at.LAST_GAP] < d[at.CUTOFF]
        for i in range(n):
            yp[first + i] = (d[share + i] - 1.0) * d[slot + at.LAST_RATE] if near else 0.0


# -- histories -------------------------------------------------------------------------------------------------


@compiled
def meet_nodes(d: Floats, slot: int, y: Floats, gap: float) -> None:
    """Start the nodes' histories: nothing is joined yet."""
    n, first, grid = int(d[at.NODES]), first_unknown(d, slot), int(d[at.GRID_AT])
    start = slot + at.NODE_ROWS
    for i in range(n):
        h = gap + d[grid + i] + y[first + i]
        d[start + i] = d[start + n + i] = d[start + at.ROW_GAP * n + i] = h
        d[start + at.ROW_SHARE * n + i] = 1.0


@compiled
def follow_nodes(d: Floats, slot: int, y: Floats, gap: float) -> None:
    """Note the nodes' gaps at an accepted time, before the pair's own, and how far they have moved with it."""
    n, first, grid = int(d[at.NODES]), first_unknown(d, slot), int(d[at.GRID_AT])
    start = slot + at.NODE_ROWS
    moved = gap - d[slot + at.LAST_GAP]
    for i in range(n):
        h = gap + d[grid + i] + y[first + i]
        if abs(moved) > _MOVED:
            share = (h - d[start + at.ROW_GAP * n + i]) / moved
            d[start + at.ROW_SHARE * n + i] = min(max(share, 0.0), _LARGEST_SHARE)
        d[start + at.ROW_GAP * n + i] = h


@compiled
def join_nodes(d: Floats, slot: int, y: Floats, gap: float) -> None:
    """Take the joined heights at a turning point."""
    n, first, grid = int(d[at.NODES]), first_unknown(d, slot), int(d[at.GRID_AT])
    for material in range(2):
        limit = material_stretch(d, material)
        joined = row(d, slot, at.ROW_JOINED + material)
        for i in range(n if limit > 0.0 else 0):
            d[joined + i] = joined_height(d[joined + i], gap + d[grid + i] + y[first + i], limit)
