"""Deflections that go with a given motion: consistent starts, and how near a contact is to a fold."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearidae.engine import layout as at
from gearidae.engine.residual import residual

__all__ = ["fastest_node", "settle_nodes"]

Floats = NDArray[np.float64]

_SETTLED = 1e-12  # roughnesses
_TRIES = 60
_STRIDE = 0.25  # longest step of Newton's, in roughnesses
_NUDGE = 1e-6  # of a deflection, for differences
_AHEAD = 1e-3  # and for those that look beyond a bend


def _deviation(d: Floats, t: float, y: Floats) -> Floats:
    """Residual of the nodes, shape (pairs, nodes)."""
    out = np.empty(y.size)
    residual(d, t, y, np.zeros(y.size), out)
    return out[-int(d[at.NODES] * d[at.TOTAL_SLOTS]) :].reshape(int(d[at.TOTAL_SLOTS]), int(d[at.NODES]))


def _slopes(d: Floats, t: float, y: Floats) -> Floats:
    """Slopes of the nodes' residual in the deflections, pair by pair, shape (pairs, nodes, nodes)."""
    pairs, n = int(d[at.TOTAL_SLOTS]), int(d[at.NODES])
    slopes = np.empty((pairs, n, n))
    for k in range(n):  # the same node of all pairs at once: they do not see each other
        nudge = np.zeros((pairs, n))
        nudge[:, k] = _NUDGE
        step = np.concatenate([np.zeros(y.size - pairs * n), nudge.ravel()])
        slopes[:, :, k] = (_deviation(d, t, y + step) - _deviation(d, t, y - step)) / (2.0 * _NUDGE)
    return slopes


def settle_nodes(d: Floats, t: float, y: Floats) -> bool:
    """Solve for the deflections at a given motion, in place; whether that succeeded.

    Parameters
    ----------
    d : ndarray
        The scene, see `layout`.
    t : float
        Time over tau.
    y : ndarray
        State; the deflections in it are where the search begins.
    """
    pairs, n = int(d[at.TOTAL_SLOTS]), int(d[at.NODES])
    for _ in range(_TRIES):
        change = np.linalg.solve(_slopes(d, t, y), _deviation(d, t, y)[:, :, None])[:, :, 0]
        largest = float(np.max(np.abs(change)))
        if not math.isfinite(largest):
            return False
        y[-pairs * n :] -= (change * min(1.0, _STRIDE / max(largest, _STRIDE))).ravel()
        if largest <= _SETTLED:
            return True
    return False


def fastest_node(d: Floats, t: float, y: Floats) -> float:
    """How many times as fast as the bodies the gap of a node moves at most: without bound at a fold.

    Infinite beyond a fold, where the equations of a pair's nodes have a determinant that is not positive. Pressures
    bend where asperities begin to stretch and to let go, and a fold may lie in a bend: so it is looked for a little
    ahead to either side as well.
    """
    largest = 0.0
    for ahead in (0.0, _AHEAD, -_AHEAD):
        there = y.copy()
        there[-int(d[at.NODES] * d[at.TOTAL_SLOTS]) :] += ahead
        slopes = _slopes(d, t, there)
        if not np.all(np.linalg.det(slopes) > 0.0):
            return math.inf
        shares = np.linalg.solve(slopes, np.ones((*slopes.shape[:2], 1)))
        largest = max(largest, float(np.max(np.abs(shares))))
    return largest
