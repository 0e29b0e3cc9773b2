r"""Nodes of an elastic contact: their gaps, pressures and histories (Teodorescu et al. 2009, Eqs. 13-15).

Across a pair's contact lie nodes at ``x = s sqrt(2 R sigma)``, with s the same for every pair. The gap at a node is
that of the rigid profiles and the deflection of both bodies under all the pressures,

.. math::

    h_i = g + s_i^2 + d_i, \qquad d_i = \sum_k \kappa_{ik}(\ell)\, p(h_k, \zeta_k), \qquad
    W = \ell \sum_i w_i\, p(h_i, \zeta_i),

lengths in roughnesses, :math:`\ell` the length of the footprint, which changes along the path of contact with the
radius R. The deflections d are unknowns of the integration beside the motion.

The pressure of a closing contact is smooth. What stretched asperities add to it has a kink where they let go, a place
that travels across the nodes and between them. Deflections stay smooth, so this part is taken at finer points, between
the nodes by interpolation of the deflections, :math:`h_m = g + s_m^2 + \sum_i A_{mi} d_i`, and carried to the nodes
by the same matrix, :math:`w_i p_i = \sum_m A_{mi} w_m t_m`: work and force stay as they are, and there is no
unknown more. Each point remembers its own joined heights.

While a contact is stable every gap along it moves with the pair's, one way or the other together with it, so
that all of them turn round when the pair does: that instant is found as a root, and the joined heights taken there are
those of the play operator without an error of their own.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.contact.bulk import STENCIL
from gearidae.contact.history import extreme_gap, joined_height
from gearidae.contact.kernels.law import loading_value, stretched_value
from gearidae.engine.model import layout as at
from gearidae.engine.model.tooth_pairs import material_stretch

__all__ = [
    "book_points",
    "farthest_joined",
    "first_unknown",
    "follow_nodes",
    "history_size",
    "influence",
    "join_nodes",
    "meet_nodes",
    "middle_gap",
    "node_force",
    "node_rates",
    "node_residual",
    "point_count",
    "point_gaps",
    "point_weights",
    "pressure_shares",
    "row",
    "stiffness_matrix",
    "unload",
]

Floats = NDArray[np.float64]

_MOVED = 1e-5  # roughnesses; over less than this the share of a node in the motion cannot be told
_LARGEST_SHARE = 4.0
_BEGUN = 1e-9  # roughnesses of stretch
_NOTHING = 6.5  # standard deviations: beyond, heights have 1e-9 of the density in the middle


@compiled
def first_unknown(d: Floats, slot: int) -> int:
    """Place in the state of a history's first deflection, that of the middle."""
    motion = 2 if d[at.KIND] == at.ROLLER else 4
    block = (slot - int(d[at.HISTORIES])) // int(d[at.HISTORY])
    return motion + block * int(d[at.NODES])


@compiled
def point_count(nodes: int) -> int:
    """Points of a contact with so many nodes, the nodes among them."""
    return at.FINER * (nodes - 1) + 1


@compiled
def history_size(nodes: int) -> int:
    """Numbers in the history of a pair with so many nodes."""
    return at.NODE_ROWS + at.ROWS * nodes + at.POINT_ROWS * point_count(nodes)


@compiled
def row(d: Floats, slot: int, kind: int) -> int:
    """Offset of a row of numbers, one per node or one per point, in a pair's history."""
    n = int(d[at.NODES])
    if kind < at.ROWS:
        return slot + at.NODE_ROWS + kind * n
    return slot + at.NODE_ROWS + at.ROWS * n + (kind - at.ROWS) * point_count(n)


@compiled
def point_weights(d: Floats) -> int:
    """Offset of the weights of the points, between their profile and their shares of the nodes."""
    n = int(d[at.NODES])
    return int(d[at.GRID_AT]) + 2 * n + int(d[at.ORDERS]) * n * n + point_count(n)


@compiled
def point_gaps(d: Floats, slot: int, y: Floats, gap: float, out: Floats) -> None:
    """Gaps at the points of a pair."""
    n, weights = int(d[at.NODES]), point_weights(d)
    points, first = point_count(n), first_unknown(d, slot)
    _to_points(d, y[first : first + n], out)
    for k in range(points):
        out[k] += gap + d[weights - points + k]


@compiled
def farthest_joined(middle: float) -> float:
    """Joined height beyond which nothing counts beside the middle's."""
    return math.hypot(max(middle, 0.0), _NOTHING)


@compiled
def _first_node(point: int, n: int) -> int:
    """First of the nodes that have shares in a point."""
    return min(max(point // at.FINER - STENCIL // 2 + 1, 0), n - STENCIL)


@compiled
def _to_points(d: Floats, values: Floats, out: Floats) -> None:
    """Interpolate from nodes to points."""
    n = values.size
    points = point_count(n)
    shares = point_weights(d) + points
    for k in range(points):
        first = _first_node(k, n)
        total = 0.0
        for i in range(STENCIL):
            total += d[shares + STENCIL * k + i] * values[first + i]
        out[k] = total


@compiled(makes_arrays=True)
def _to_nodes(d: Floats, values: Floats, out: Floats) -> None:
    """Add to the nodes what points have, such that both weigh the same."""
    n = out.size
    points, weights = point_count(n), point_weights(d)
    total = np.zeros(n)
    for k in range(points):
        value = d[weights + k] * values[k]
        if value != 0.0:
            first = _first_node(k, n)
            for i in range(STENCIL):
                total[first + i] += d[weights + points + STENCIL * k + i] * value
    node_weights = int(d[at.GRID_AT]) + n
    for i in range(n):
        out[i] += total[i] / d[node_weights + i]


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
    stiff, weights = row(d, slot, at.ROW_STIFFNESS), point_weights(d)
    loading, points = int(d[at.LOADING_AT]), point_count(n)
    for i in range(n):
        h = gap + d[grid + i] + y[first + i]
        d[pressure + i], d[slope + i] = loading_value(d, loading, h)
    d[stiff : stiff + points] = 0.0
    if known:
        _add_stretched(d, slot, t, y, gap, rate)
    force = 0.0
    stiffness = 0.0
    for i in range(n):
        force += d[grid + n + i] * d[pressure + i]
        stiffness += d[grid + n + i] * d[slope + i]
    for k in range(points):
        stiffness += d[weights + k] * d[stiff + k]
    d[slot + at.LOADED] = 1.0
    d[slot + at.LENGTH] = length
    return force * length, stiffness * length


@compiled(makes_arrays=True)
def _add_stretched(d: Floats, slot: int, t: float, y: Floats, gap: float, rate: float) -> None:
    """Add the pressure of stretched asperities to that of the nodes, and note its slopes at the points."""
    n, way = int(d[at.NODES]), d[slot + at.WAY]
    turned = way * rate < 0.0
    if not turned and way < 0.0 and d[slot + at.STRETCHED] == 0.0:
        return
    points, stiff = point_count(n), row(d, slot, at.ROW_STIFFNESS)
    # bodies that part stretch what is joined: where they seem not to, the errors of the deflection say so, and Newton's
    # iteration must not take the soft slope of closing on for that of what comes
    opening = way > 0.0 and not turned
    gaps, turning, added = np.empty(points), np.empty(points), np.zeros(points)
    point_gaps(d, slot, y, gap, gaps)
    if turned:
        span = t - d[at.LAST_TIME]
        back = extreme_gap(span, d[slot + at.LAST_GAP], d[slot + at.LAST_RATE], gap, rate) - gap
        share = row(d, slot, at.ROW_SHARE)
        _to_points(d, d[share : share + n], turning)
        for k in range(points):
            turning[k] = gaps[k] + turning[k] * back
    for material in range(2):
        limit = material_stretch(d, material)
        if limit == 0.0:
            continue
        record = at.MATERIALS + at.MATERIAL * material
        table, scale = d[int(d[record + at.M_TABLE]) :], d[record + at.M_FORCE]
        heights = row(d, slot, at.ROW_JOINED + material)
        farthest = farthest_joined(d[heights])
        for k in range(points):
            joined = d[heights + k]
            if joined > farthest:
                break
            if turned:
                joined = joined_height(joined, turning[k], limit)
            if gaps[k] > joined:
                q, dq = stretched_value(table, gaps[k], joined)
                added[k] += scale * q
                d[stiff + k] += scale * dq
            elif opening:
                d[stiff + k] += scale * stretched_value(table, gaps[k] + _BEGUN, gaps[k])[1]
    pressure = row(d, slot, at.ROW_PRESSURE)
    _to_nodes(d, added, d[pressure : pressure + n])


@compiled
def stiffness_matrix(d: Floats, slot: int, out: Floats) -> None:
    """Slopes of a pair's pressures in the gaps of its nodes, after `node_force`.

    Parameters
    ----------
    d : ndarray
        See `layout`.
    slot : int
        The pair's history.
    out : ndarray, shape (n, n)
        ``out[k, j]`` becomes the slope of the pressure at k in the gap at j.
    """
    n = int(d[at.NODES])
    points, weights, stiff = point_count(n), point_weights(d), row(d, slot, at.ROW_STIFFNESS)
    slope, node_weights = row(d, slot, at.ROW_SLOPE), int(d[at.GRID_AT]) + n
    out[:] = 0.0
    for k in range(points):
        stiffness = d[weights + k] * d[stiff + k]
        if stiffness != 0.0:
            first, shares = _first_node(k, n), weights + points + STENCIL * k
            for i in range(STENCIL):
                factor = d[shares + i] * stiffness
                for j in range(STENCIL):
                    out[first + i, first + j] += factor * d[shares + j]
    for k in range(n):
        for j in range(n):
            out[k, j] /= d[node_weights + k]
        out[k, k] += d[slope + k]


@compiled(makes_arrays=True)
def pressure_shares(d: Floats, slot: int, out: Floats) -> None:
    """Slopes of the nodes' pressures in the pair's gap along its last motion, after `node_force`."""
    n = int(d[at.NODES])
    share, slope, stiff = (
        row(d, slot, at.ROW_SHARE),
        row(d, slot, at.ROW_SLOPE),
        row(d, slot, at.ROW_STIFFNESS),
    )
    moved = np.empty(point_count(n))
    _to_points(d, d[share : share + n], moved)
    for k in range(moved.size):
        moved[k] *= d[stiff + k]
    for i in range(n):
        out[i] = d[slope + i] * d[share + i]
    _to_nodes(d, moved, out)


@compiled(makes_arrays=True)
def influence(d: Floats, length: float, out: Floats) -> None:
    """Influence coefficients, column by column.

    Parameters
    ----------
    d : ndarray
        See `layout`.
    length : float
        Length of the footprint.
    out : ndarray, shape (n, n)
        ``out[k, i]`` becomes ``kappa_ik``.
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


@compiled(makes_arrays=True)
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
    """Start the histories along a contact: nothing is joined yet."""
    n, first, grid = int(d[at.NODES]), first_unknown(d, slot), int(d[at.GRID_AT])
    before, share = row(d, slot, at.ROW_GAP), row(d, slot, at.ROW_SHARE)
    for i in range(n):
        d[before + i] = gap + d[grid + i] + y[first + i]
        d[share + i] = 1.0
    d[slot + at.STRETCHED] = 0.0
    for material in range(2):
        joined = row(d, slot, at.ROW_JOINED + material)
        point_gaps(d, slot, y, gap, d[joined : joined + point_count(n)])
        book_points(d, slot, material)


@compiled
def follow_nodes(d: Floats, slot: int, y: Floats, gap: float) -> None:
    """Note the nodes' gaps at an accepted time, before the pair's own, and how far they have moved with it."""
    n, first, grid = int(d[at.NODES]), first_unknown(d, slot), int(d[at.GRID_AT])
    before, share = row(d, slot, at.ROW_GAP), row(d, slot, at.ROW_SHARE)
    moved = gap - d[slot + at.LAST_GAP]
    for i in range(n):
        h = gap + d[grid + i] + y[first + i]
        if abs(moved) > _MOVED:
            d[share + i] = min(max((h - d[before + i]) / moved, 0.0), _LARGEST_SHARE)
        d[before + i] = h


@compiled(makes_arrays=True)
def join_nodes(d: Floats, slot: int, y: Floats, gap: float) -> None:
    """Take the joined heights at a turning point."""
    points = point_count(int(d[at.NODES]))
    gaps = np.empty(points)
    point_gaps(d, slot, y, gap, gaps)
    d[slot + at.STRETCHED] = 0.0
    for material in range(2):
        limit = material_stretch(d, material)
        joined = row(d, slot, at.ROW_JOINED + material)
        for k in range(points if limit > 0.0 else 0):
            d[joined + k] = joined_height(d[joined + k], gaps[k], limit)
            if gaps[k] > d[joined + k]:
                d[slot + at.STRETCHED] = 1.0
        book_points(d, slot, material)


@compiled
def book_points(d: Floats, slot: int, material: int) -> None:
    """Note the energy of what is joined at the points, which changes when the joined heights do."""
    joined, booked = row(d, slot, at.ROW_JOINED + material), row(d, slot, at.ROW_BOOKED + material)
    joining, number = d[at.ENERGIES + at.ENERGY * material + at.E_JOINING], int(d[at.NUMBER_AT])
    for k in range(point_count(int(d[at.NODES])) if joining != 0.0 else 0):
        d[booked + k] = -joining * loading_value(d, number, d[joined + k])[0]
