r"""Nodes of an elastic contact: their gaps, pressures and histories (Teodorescu et al. 2009, Eqs. 13-15).

Across a pair's contact lie nodes at ``x = s sqrt(2 R sigma)``, with s the same for every pair. The gap at a node is
that of the rigid profiles and the deflection of both bodies under all the pressures,

.. math::

    h_i = g + s_i^2 + d_i, \qquad d_i = \sum_k \kappa_{ik}(\ell)\, p(h_k, \zeta_k), \qquad
    W = \ell \sum_i w_i\, p(h_i, \zeta_i),

lengths in roughnesses, :math:`\ell` the contact length, which changes along the path of contact with the
radius R. The deflections d are unknowns of the integration beside the motion.

The pressure of a closing contact is smooth. The part of stretched asperities has a kink at their detachment, a point
that travels across the nodes and between them. Deflections stay smooth, so this part is taken at finer points, between
the nodes by interpolation of the deflections, :math:`h_m = g + s_m^2 + \sum_i A_{mi} d_i`, and carried to the nodes
by the same matrix, :math:`w_i p_i = \sum_m A_{mi} w_m t_m`: work and force stay as they are, and there is no
unknown more. Each point remembers its own joined heights.

Where shares of the materials change with tooth and position, those at the pair's position hold for all nodes of its
contact, as the pair's radius does: a contact is some hundredths of a pitch wide.

While a contact is stable every gap along it moves with the pair's, one way or the other together with it, so
that all of them turn round when the pair does: that instant is found as a root, and the joined heights taken there are
those of the play operator without an error of their own.
"""

from __future__ import annotations

import math

import numpy as np

from gearidae.compiled import compiled, compiled_once
from gearidae.contact.bulk import STENCIL
from gearidae.contact.history import extreme_gap, joined_height
from gearidae.contact.kernels.lanes import add_lanes
from gearidae.contact.kernels.law import (
    B_JOINED,
    B_PIECES,
    branch_length,
    branch_value,
    set_branch,
    stretched_value,
)
from gearidae.engine.compiling import ELASTIC
from gearidae.engine.elastic.node_rows import (
    GAP_SHARE,
    POINT_ADDED,
    POINT_GAPS,
    POINT_TURNS,
    PRESSURE,
    SLOPE,
    STIFFNESS,
    add_to_nodes,
    first_node,
    first_unknown,
    influence_powers,
    joined_at,
    node_profile,
    node_weights,
    point_gaps,
    point_weights,
    row,
    scratch,
    shares_of_nodes,
    to_points,
)
from gearidae.engine.model.state import EMPTY, MATERIALS, Floats, Model
from gearidae.engine.pairs.coverage import Shares, loading_of, noted_shares
from gearidae.engine.pairs.tooth_pairs import contact_length
from gearidae.laws.pair_law import in_reach

_CLOSING, _OPENING, _TURNED = 0, 1, 2
_BEGUN = 1e-9  # roughnesses of stretch
_NOTHING = 6.5  # standard deviations: beyond, heights have 1e-9 of the density in the middle


@compiled
def farthest_joined(middle: float, offset: float) -> float:
    """Joined height beyond which nothing counts beside the middle's, of a material with a gap offset."""
    return math.hypot(max(middle + offset, 0.0), _NOTHING) - offset


@compiled
def middle_gap(m: Model, k: int, y: Floats, gap: float) -> float:
    """Gap in the middle of a contact: the pair's own, opened by the deflection of an elastic one."""
    return gap if m.scene.nodes == 0 else gap + y[first_unknown(m, k)]


@compiled_once(ELASTIC, makes_arrays=True)
def node_force(
    m: Model, k: int, known: bool, t: float, y: Floats, gap: float, rate: float, length: float
) -> tuple[float, float]:
    """`force_of_nodes` for the rest of the engine."""
    return force_of_nodes(m, k, known, t, y, gap, rate, length)


@compiled(makes_arrays=True)
def force_of_nodes(
    m: Model, k: int, known: bool, t: float, y: Floats, gap: float, rate: float, length: float
) -> tuple[float, float]:
    """Force of one pair at given deflections and its slope in the pair's gap, scaled.

    The pressures and their slopes are left in the pair's rows. Within a step that has turned the pair round, the
    nodes' histories first go through the turning point, each by its share in the motion.

    Parameters
    ----------
    k : int
        Index of the pair's history.
    known : bool
        Whether that is about this pair.
    t : float
        Time over tau.
    y : ndarray
        State.
    gap, rate, length : float
        The pair's gap, gap rate and contact length.
    """
    n, first, shares = m.scene.nodes, first_unknown(m, k), noted_shares(m, k)
    profile, weights = node_profile(m), node_weights(m)
    pressure, slope, stiff = row(m, k, PRESSURE), row(m, k, SLOPE), row(m, k, STIFFNESS)
    for i in range(n):
        h = gap + profile[i] + y[first + i]
        pressure[i], slope[i] = loading_of(m, h, shares)
    stiff[:] = 0.0
    if known and is_stretched(m, k, rate):
        added = scratch(m, POINT_ADDED, m.scene.points)
        add_stretched(m, k, t, y, (gap, rate), force_scales(m, k), (added, stiff))
        add_to_nodes(m, added, pressure)
    force = 0.0
    stiffness = 0.0
    for i in range(n):
        force += weights[i] * pressure[i]
        stiffness += weights[i] * slope[i]
    finer = point_weights(m)
    for i in range(m.scene.points):
        stiffness += finer[i] * stiff[i]
    return force * length, stiffness * length


@compiled(inline=True)
def is_stretched(m: Model, k: int, rate: float) -> bool:
    """Whether any point of a contact may be stretched."""
    h = m.state.history[k]
    return bool(h.direction * rate < 0.0 or h.direction >= 0.0 or h.stretched != 0)


@compiled(inline=True)
def force_scales(m: Model, k: int) -> Shares:
    """Force scales of the materials of a pair, with their shares there."""
    (a, b, c), materials = noted_shares(m, k), m.scene.material
    return materials[0].force_scale * a, materials[1].force_scale * b, materials[2].force_scale * c


@compiled(makes_arrays=True)
def add_stretched(
    m: Model,
    k: int,
    t: float,
    y: Floats,
    there: tuple[float, float],
    scales: Shares,
    out: tuple[Floats, Floats],
) -> None:
    """Set the pressure of stretched asperities at the points by the materials' scales, and add its slopes.

    Parameters
    ----------
    m, k, t, y
        As for `force_of_nodes`.
    there : tuple of float
        The pair's gap and gap rate.
    scales : tuple of float
        Of the materials' pressures.
    out : tuple of two ndarrays, shape (points,)
        Pressures, and slopes.
    """
    (gap, rate), (added, _) = there, out
    h = m.state.history[k]
    turned = h.direction * rate < 0.0
    points = m.scene.points
    # bodies that part stretch what is joined: where they seem not to, the errors of the deflection say so, and Newton's
    # iteration must not take the soft slope of closing on for that of what comes
    opening = h.direction > 0.0 and not turned
    gaps, turning = scratch(m, POINT_GAPS, points), scratch(m, POINT_TURNS, points)
    added[:] = 0.0
    point_gaps(m, k, y, gap, gaps)
    if turned:
        back = extreme_gap(t - m.state.time, h.gap, h.gap_rate, gap, rate) - gap
        to_points(m, row(m, k, GAP_SHARE), turning)
        for i in range(points):
            turning[i] = gaps[i] + turning[i] * back
    way = _TURNED if turned else _OPENING if opening else _CLOSING
    for material in range(MATERIALS):
        if m.scene.material[material].stretch_limit != 0.0:
            _add_material(m, k, (material, way), scales[material], (gaps, turning), out)


@compiled
def _add_material(
    m: Model,
    k: int,
    which: tuple[int, int],
    scale: float,
    at: tuple[Floats, Floats],
    out: tuple[Floats, Floats],
) -> None:
    """Add the pressure of stretched asperities at the points, and its slopes; `which` is a material and a way."""
    (material, way), (gaps, turning), (added, stiff) = which, at, out
    surface, points = m.scene.material[material], m.scene.points
    limit, offset = surface.stretch_limit, surface.gap_offset
    table, heights = m.tables[surface.table_at :], joined_at(m, k, material)
    farthest = farthest_joined(m.rows[heights], offset)
    kept = way != _TURNED and m.scene.point_branch_length > 0 and branch_length(table) > 0
    for i in range(points):
        joined = m.rows[heights + i]
        if joined > farthest:
            break
        if way == _TURNED:
            joined = joined_height(joined, turning[i], limit)
        stretch = gaps[i] - joined
        if stretch > 0.0:
            if kept and stretch < limit:
                branch = point_branch(m, k, material, i)
                if m.rows[branch + B_PIECES] == 0.0 or m.rows[branch + B_JOINED] != joined + offset:
                    set_branch(table, joined + offset, m.rows[branch:])
                q, dq = branch_value(m.rows[branch:], stretch)
            else:
                q, dq = stretched_value(table, gaps[i] + offset, joined + offset)
            added[i] += scale * q
            stiff[i] += scale * dq
        elif way == _OPENING:
            stiff[i] += scale * stretched_value(table, gaps[i] + offset + _BEGUN, gaps[i] + offset)[1]


@compiled
def point_branch(m: Model, k: int, material: int, point: int) -> int:
    """Index of the branch of stretched asperities at a point, among the rows; it knows the joined height it is of."""
    index = (k * MATERIALS + material) * m.scene.points + point
    return m.scene.point_branches_at + index * m.scene.point_branch_length


@compiled(makes_arrays=True)
def stiffness_matrix(m: Model, k: int, out: Floats) -> None:
    """Slopes of a pair's pressures in the gaps of its nodes, after `force_of_nodes`.

    Parameters
    ----------
    k : int
        Index of the pair's history.
    out : ndarray, shape (n, n)
        ``out[i, j]`` becomes the slope of the pressure at i in the gap at j.
    """
    n, weights = m.scene.nodes, node_weights(m)
    flat = out.reshape(n * n)
    weighed_stiffness(m, k, flat, n)
    for i in range(n):
        for j in range(n):
            flat[n * i + j] /= weights[i]


@compiled(makes_arrays=True)
def weighed_stiffness(m: Model, k: int, out: Floats, width: int) -> None:
    """Stiffness matrix of the nodes times the weight of the node at i, which makes it symmetric.

    Parameters
    ----------
    k : int
        Index of the pair's history.
    out : ndarray, shape (n * width,)
        Filled in, row by row.
    width : int
        Length of a row, of which the first n numbers are set and the others made zero.
    """
    n, finer, shares, weights = m.scene.nodes, point_weights(m), shares_of_nodes(m), node_weights(m)
    slope, stiff = row(m, k, SLOPE), row(m, k, STIFFNESS)
    for i in range(n * width):
        out[i] = 0.0
    for point in range(m.scene.points):
        stiffness = finer[point] * stiff[point]
        if stiffness != 0.0:
            first, at = first_node(point, n), STENCIL * point
            for i in range(STENCIL):
                index = np.uintp((first + i) * width + first)
                add_lanes(out, index, shares, np.uintp(at), shares[at + i] * stiffness)
    for i in range(n):
        out[(width + 1) * i] += weights[i] * slope[i]


@compiled(makes_arrays=True)
def pressure_shares(m: Model, k: int, out: Floats) -> None:
    """Slopes of the nodes' pressures in the pair's gap along its last motion, after `force_of_nodes`."""
    share, slope, stiff = row(m, k, GAP_SHARE), row(m, k, SLOPE), row(m, k, STIFFNESS)
    moved = np.empty(m.scene.points)
    to_points(m, share, moved)
    for i in range(moved.size):
        moved[i] *= stiff[i]
    for i in range(m.scene.nodes):
        out[i] = slope[i] * share[i]
    add_to_nodes(m, moved, out)


@compiled(makes_arrays=True)
def influence(m: Model, length: float, out: Floats) -> None:
    """Influence coefficients, column by column.

    Parameters
    ----------
    length : float
        Contact length.
    out : ndarray, shape (n, n)
        ``out[k, i]`` becomes ``kappa_ik``.
    """
    n, orders = m.scene.nodes, m.scene.orders
    flat, size, first = out.reshape(n * n), n * n, m.scene.influence_at
    x = (length - m.scene.length_middle) / m.scene.length_half_range
    kappa = m.tables[first + (orders - 1) * size : first + orders * size]
    for i in range(size):
        flat[i] = kappa[i]
    for order in range(orders - 2, -1, -1):
        kappa = m.tables[first + order * size : first + (order + 1) * size]
        for i in range(size):
            flat[i] = flat[i] * x + kappa[i]


@compiled_once(ELASTIC, makes_arrays=True)
def node_residual(m: Model, y: Floats, out: Floats) -> None:
    """Equations of the nodes, for the pairs whose forces have just been noted: deflections are those they cause."""
    n, orders = m.scene.nodes, m.scene.orders
    kappa = influence_powers(m)
    for i in range(first_unknown(m, 0), first_unknown(m, m.scene.histories)):
        out[i] = y[i]
    for j in range(m.work.pair_forces.count):
        noted = m.work.pair_forces.pair[j]
        first, pressure = first_unknown(m, noted.history), row(m, noted.history, PRESSURE)
        deviation = out[first : first + n]
        x = (contact_length(m, noted.position) - m.scene.length_middle) / m.scene.length_half_range
        power = 1.0
        for order in range(orders):
            for k in range(n):
                p = power * pressure[k]
                if p != 0.0:
                    for i in range(n):
                        deviation[i] -= kappa[order, k, i] * p
            power *= x


@compiled_once(ELASTIC, makes_arrays=True)
def node_rates(m: Model, yp: Floats) -> None:
    """Rates of the deflections at an accepted time, from the nodes' shares in the last motion."""
    for k in range(m.scene.histories):
        first, share, h = first_unknown(m, k), row(m, k, GAP_SHARE), m.state.history[k]
        near = h.pair != EMPTY and in_reach(m, h.gap)
        for i in range(m.scene.nodes):
            yp[first + i] = (share[i] - 1.0) * h.gap_rate if near else 0.0
