"""Rows of numbers of an elastic contact: one number per node, or per point between the nodes.

Among the rows that change lie, pair by pair, gap, share, pressure and slope of every node, then joined heights,
stiffness and adhered energy of every point. Constants (profile, weights, influence coefficients, the points' shares of
the nodes) lie among the tables. Functions here hand out views of them, with their true lengths.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from gearidae.compiled import compiled
from gearidae.contact.bulk import STENCIL
from gearidae.engine.model.state import MATERIALS, ROLLER, Floats, Model

__all__ = [
    "ADHERED_ENERGY",
    "FINER",
    "GAP",
    "JOINED",
    "PRESSURE",
    "SHARE",
    "SLOPE",
    "STIFFNESS",
    "add_to_nodes",
    "first_node",
    "first_unknown",
    "influence_powers",
    "node_profile",
    "node_weights",
    "point_count",
    "point_gaps",
    "point_profile",
    "point_weights",
    "profile_of",
    "row",
    "row_numbers",
    "row_of",
    "shares_of_nodes",
    "to_points",
]

FINER: Final = 4
"""Steps from point to point in one from node to node."""

GAP: Final = 0  # at the last accepted time
SHARE: Final = 1  # how far the node's gap moves with the pair's
PRESSURE: Final = 2  # of the last evaluation
SLOPE: Final = 3  # slope of the loading branch in the node's gap
_NODE_ROWS: Final = 4
JOINED: Final = 4  # rows of points, one per material: joined height
STIFFNESS: Final = JOINED + MATERIALS  # slope of what stretched asperities add, in the point's gap
ADHERED_ENERGY: Final = STIFFNESS + 1  # one per material: energy of what is joined, when nothing is stretched
_POINT_ROWS: Final = 2 * MATERIALS + 1


@compiled
def point_count(nodes: int) -> int:
    """Points of a contact with so many nodes, the nodes among them."""
    return FINER * (nodes - 1) + 1


def row_numbers(nodes: int) -> int:
    """Numbers in the rows of a pair with so many nodes."""
    return _NODE_ROWS * nodes + _POINT_ROWS * (FINER * (nodes - 1) + 1)


# Python code takes views by `row_of` and `profile_of`: compiled functions can hand views to each other only.
def row_of(m: Model, k: int, kind: int) -> Floats:
    """One row of a history's pair, shape (nodes,) or (points,)."""
    n, points = m.scene.nodes, m.scene.points
    start = m.scene.node_rows_at + k * m.scene.node_row_length
    if kind < _NODE_ROWS:
        start += kind * n
        return m.rows[start : start + n]
    start += _NODE_ROWS * n + (kind - _NODE_ROWS) * points
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
def first_unknown(m: Model, k: int) -> int:
    """Place in the state of the first deflection of a history's pair, that of the middle."""
    motion = 2 if m.scene.kind == ROLLER else 4
    return motion + k * m.scene.nodes


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
        first = first_node(k, n)
        total = 0.0
        for i in range(STENCIL):
            total += shares[STENCIL * k + i] * values[first + i]
        out[k] = total


@compiled(makes_arrays=True)
def add_to_nodes(m: Model, values: Floats, out: Floats) -> None:
    """Add to the nodes what points have, such that both weigh the same."""
    n, shares = m.scene.nodes, shares_of_nodes(m)
    weights, finer = node_weights(m), point_weights(m)
    total = np.zeros(n)
    for k in range(m.scene.points):
        value = finer[k] * values[k]
        if value != 0.0:
            first = first_node(k, n)
            for i in range(STENCIL):
                total[first + i] += shares[STENCIL * k + i] * value
    for i in range(n):
        out[i] += total[i] / weights[i]


@compiled(makes_arrays=True)
def point_gaps(m: Model, k: int, y: Floats, gap: float, out: Floats) -> None:
    """Gaps at the points of a history's pair."""
    first, profile = first_unknown(m, k), point_profile(m)
    to_points(m, y[first : first + m.scene.nodes], out)
    for i in range(m.scene.points):
        out[i] += gap + profile[i]
