"""Rows of numbers of an elastic contact: one number per node, or per point between the nodes.

Among the rows that change lie, pair by pair, gap, share, pressure, slope and deflections of every node, then joined
heights, stiffness and adhered energy of every point. Constants (profile, weights, influence coefficients, the points'
shares of the nodes) lie among the tables. Functions here return views of them, with their true lengths.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from gearidae.compiled import compiled
from gearidae.contact.bulk import STENCIL
from gearidae.contact.kernels.lanes import LANES, add_lanes, product_of_lanes
from gearidae.engine.model.state import MATERIALS, MOTION, Floats, Model

FINER: Final = 4
"""Steps from point to point in one from node to node."""

GAP: Final = 0  # at the last accepted time
GAP_SHARE: Final = 1  # how far the node's gap moves with the pair's
PRESSURE: Final = 2  # of the last evaluation
SLOPE: Final = 3  # slope of the loading branch in the node's gap
DEFLECTION: Final = 4  # where nodes are eliminated: of the last evaluation, with its slope in the pair's gap,
TANGENT: Final = 5
LAST: Final = 6  # the same at the end of the last step,
LAST_TANGENT: Final = 7
BEFORE: Final = 8  # and of the one before
BEFORE_TANGENT: Final = 9
NODE_ROWS: Final = 10
JOINED: Final = NODE_ROWS  # rows of points, one per material: joined height
STIFFNESS: Final = JOINED + MATERIALS  # slope of what stretched asperities add, in the point's gap
ADHERED_ENERGY: Final = STIFFNESS + 1  # one per material: energy of what is joined, when nothing is stretched
_POINT_ROWS: Final = 2 * MATERIALS + 1


assert STENCIL == LANES  # the shares of a point are those of so many nodes

SUMS: Final = 0  # parts of the scratch space, in use at once: sums at the nodes,
POINT_GAPS: Final = 1  # numbers at the points,
POINT_TURNS: Final = 2
POINT_ADDED: Final = 3
MATRICES: Final = 4  # and the linear equations of Newton's method


@compiled
def padded(nodes: int) -> int:
    """Length of a row of the nodes' linear equations with two right-hand sides, in whole lanes."""
    return (nodes + 2 + LANES - 1) // LANES * LANES


def scratch_size(nodes: int) -> int:
    """Numbers in the scratch space of a contact with so many nodes."""
    points = FINER * (nodes - 1) + 1
    return MATRICES * points + (3 * nodes + 5) * ((nodes + 2 + LANES - 1) // LANES * LANES)


@compiled(makes_arrays=True)
def scratch(m: Model, part: int, size: int) -> Floats:
    """Scratch space of a size; what is in it is anything."""
    start = m.scene.scratch_at + part * m.scene.points
    return m.rows[start : start + size]


@compiled
def point_count(nodes: int) -> int:
    """Points of a contact with so many nodes, the nodes among them."""
    return FINER * (nodes - 1) + 1


def row_numbers(nodes: int) -> int:
    """Numbers in the rows of a pair with so many nodes."""
    return NODE_ROWS * nodes + _POINT_ROWS * (FINER * (nodes - 1) + 1)


# Python code takes views by `row_of` and `profile_of`: compiled functions can hand views to each other only.
def row_of(m: Model, k: int, kind: int) -> Floats:
    """One row of a history's pair, shape (nodes,) or (points,)."""
    n, points = m.scene.nodes, m.scene.points
    start = m.scene.node_rows_at + k * m.scene.node_row_length
    if kind < NODE_ROWS:
        start += kind * n
        return m.rows[start : start + n]
    start += NODE_ROWS * n + (kind - NODE_ROWS) * points
    return m.rows[start : start + points]


def profile_of(m: Model, finer: bool) -> Floats:
    """Return the profile ``s^2`` of the nodes, or of the points."""
    start, count = m.scene.profile_at, m.scene.nodes
    if finer:
        start, count = m.scene.point_profile_at, m.scene.points
    return m.tables[start : start + count]


row = compiled(makes_arrays=True)(row_of)
_profile = compiled(makes_arrays=True)(profile_of)


@compiled
def joined_at(m: Model, k: int, material: int) -> int:
    """Index of the joined heights of a pair's points, among the rows."""
    start = m.scene.node_rows_at + k * m.scene.node_row_length
    return start + NODE_ROWS * m.scene.nodes + material * m.scene.points


@compiled
def first_unknown(m: Model, k: int) -> int:
    """Index in the state of the first deflection of a history's pair, of the middle node."""
    return MOTION + k * m.scene.nodes


@compiled(makes_arrays=True)
def node_profile(m: Model) -> Floats:
    """Return the nodes' profile ``s^2``."""
    return _profile(m, False)


@compiled(makes_arrays=True)
def node_weights(m: Model) -> Floats:
    """Return the nodes' weights."""
    return m.tables[m.scene.weights_at : m.scene.weights_at + m.scene.nodes]


@compiled(makes_arrays=True)
def influence_powers(m: Model) -> Floats:
    """Return the influence coefficients, column by column for each power of the length, shape (orders, n, n)."""
    n, orders, start = m.scene.nodes, m.scene.orders, m.scene.influence_at
    return m.tables[start : start + orders * n * n].reshape(orders, n, n)


@compiled(makes_arrays=True)
def point_profile(m: Model) -> Floats:
    """Return the points' profile."""
    return _profile(m, True)


@compiled(makes_arrays=True)
def point_weights(m: Model) -> Floats:
    """Return the points' weights."""
    return m.tables[m.scene.point_weights_at : m.scene.point_weights_at + m.scene.points]


@compiled(makes_arrays=True)
def shares_of_nodes(m: Model) -> Floats:
    """Return the points' shares of the nodes around them, `STENCIL` for each point."""
    return m.tables[m.scene.shares_at : m.scene.shares_at + STENCIL * m.scene.points]


@compiled
def first_node(point: int, n: int) -> int:
    """First of the nodes that have shares in a point."""
    return min(max(point // FINER - STENCIL // 2 + 1, 0), n - STENCIL)


@compiled(makes_arrays=True)
def to_points(m: Model, values: Floats, out: Floats) -> None:
    """Interpolate from nodes to points."""
    n, shares = m.scene.nodes, shares_of_nodes(m)
    for k in range(m.scene.points):
        out[k] = product_of_lanes(shares, np.uintp(STENCIL * k), values, np.uintp(first_node(k, n)))


@compiled(makes_arrays=True)
def add_to_nodes(m: Model, values: Floats, out: Floats) -> None:
    """Add to the nodes what points have, such that both weigh the same."""
    n, shares = m.scene.nodes, shares_of_nodes(m)
    weights, finer = node_weights(m), point_weights(m)
    total = scratch(m, SUMS, n)
    for i in range(n):
        total[i] = 0.0
    for k in range(m.scene.points):
        value = finer[k] * values[k]
        if value != 0.0:
            add_lanes(total, np.uintp(first_node(k, n)), shares, np.uintp(STENCIL * k), value)
    for i in range(n):
        out[i] += total[i] / weights[i]


@compiled(makes_arrays=True)
def point_gaps(m: Model, k: int, y: Floats, gap: float, out: Floats) -> None:
    """Gaps at the points of a history's pair."""
    first, profile = first_unknown(m, k), point_profile(m)
    to_points(m, y[first : first + m.scene.nodes], out)
    for i in range(m.scene.points):
        out[i] += gap + profile[i]
