"""Deflections that go with a given motion: consistent starts, and how near a contact is to a fold."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearidae.engine.elastic.nodes import first_unknown, influence, node_force, row, stiffness_matrix
from gearidae.engine.model import layout as at
from gearidae.engine.model.residual import residual

__all__ = ["SETTLED", "fold_gap", "settle_nodes"]

Floats = NDArray[np.float64]

SETTLED = 1e-12  # roughnesses
_TRIES = 60
_STRIDE = 0.25  # longest step of Newton's, in roughnesses
_NUDGE = 1e-6  # of a deflection, for differences
_AHEAD = (1e-4, 1e-3)  # roughnesses to look on for a fold
_FOLLOWED = 1e-9
_ASIDE = 0.1  # roughnesses; deflections so far from an equilibrium never were in one: a start beyond a fold
_FOLD_SHARE = 30.0
"""A node that moves so many times as fast as the bodies is about to jump: the static curve folds."""


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
        if largest <= SETTLED:
            return True
    return False


def fold_gap(d: Floats, t: float) -> float:
    """Gap of a pair whose static contact does not go on the way it was going, at the last accepted time; NaN if none.

    A pair is moved on a little with the bodies' deflections following. Where these no longer do, or move many times as
    fast as the pair, or the equations of its nodes have a determinant that is not positive, the static curve folds. So
    it does where a run begins with a contact for which no equilibrium was found.

    Parameters
    ----------
    d : ndarray
        The scene, see `layout`.
    t : float
        Time over tau.

    Returns
    -------
    float
        In roughnesses.
    """
    n, grid = int(d[at.NODES]), int(d[at.GRID_AT])
    for k in range(int(d[at.TOTAL_SLOTS])):
        slot = int(d[at.HISTORIES] + d[at.HISTORY] * k)
        gap, way, before = float(d[slot + at.LAST_GAP]), float(d[slot + at.WAY]), row(d, slot, at.ROW_GAP)
        if math.isnan(d[slot + at.PAIR]) or gap >= d[at.CUTOFF] or d[slot + at.LENGTH] == 0.0:
            continue
        kept = d[before : before + n] - gap - d[grid : grid + n]
        here = _follow(d, t, slot, kept, gap)
        if here is not None and np.max(np.abs(here - kept)) > _ASIDE:
            return gap
        for ahead in _AHEAD:
            there = None if here is None else _follow(d, t, slot, here, gap + way * ahead)
            if here is None or there is None or np.max(np.abs(there - here)) > _FOLD_SHARE * ahead:
                return gap
    return math.nan


def _follow(d: Floats, t: float, slot: int, deflection: Floats, gap: float) -> Floats | None:
    """Deflections of one pair at a gap, on the stable branch next to given ones; None if there are none."""
    n, length = int(d[at.NODES]), float(d[slot + at.LENGTH])
    first, pressure = first_unknown(d, slot), row(d, slot, at.ROW_PRESSURE)
    y, slopes, kappa = np.zeros(int(d[at.STATES])), np.empty((n, n)), np.empty((n, n))
    influence(d, length, kappa)
    for _ in range(_TRIES):
        y[first : first + n] = deflection
        node_force(d, slot, True, t, y, gap, float(d[slot + at.WAY]), length)
        stiffness_matrix(d, slot, slopes)
        matrix = np.eye(n) - kappa.T @ slopes
        if not np.all(np.isfinite(matrix)) or np.linalg.det(matrix) <= 0.0:
            return None
        change = np.linalg.solve(matrix, deflection - d[pressure : pressure + n] @ kappa)
        deflection = deflection - change
        if np.max(np.abs(change)) <= _FOLLOWED:
            return deflection
    return None
