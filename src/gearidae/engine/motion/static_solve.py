"""Deflections that go with a given motion: consistent starts, and how near a contact is to a fold."""

from __future__ import annotations

import math

import numpy as np

from gearidae.engine.elastic.node_rows import GAP, PRESSURE, first_unknown, profile_of, row_of
from gearidae.engine.elastic.nodes import influence, node_force, stiffness_matrix
from gearidae.engine.model.state import EMPTY, PHASE, Floats, Model
from gearidae.engine.motion.residual import residual
from gearidae.engine.pairs.coverage import path_position
from gearidae.engine.pairs.tooth_pairs import contact_length, flank_of_history
from gearidae.laws.pair_law import in_reach

SETTLED = 1e-12  # roughnesses
_TRIES = 60
_STRIDE = 0.25  # longest step of Newton's, in roughnesses
_NUDGE = 1e-6  # of a deflection, for differences
_AHEAD = (1e-4, 1e-3)  # roughnesses to look on for a fold
_FOLLOWED = 1e-9
_ASIDE = 0.1  # roughnesses; deflections so far from an equilibrium never were in one: a start beyond a fold
_FOLD_SHARE = 30.0
"""A node that moves so many times as fast as the bodies is about to jump: the static curve folds."""


def _deviation(m: Model, t: float, y: Floats) -> Floats:
    """Residual of the nodes, shape (pairs, nodes)."""
    out = np.empty(y.size)
    residual(m, t, y, np.zeros(y.size), out)
    return out[-(m.scene.nodes * m.scene.histories) :].reshape(m.scene.histories, m.scene.nodes)


def _slopes(m: Model, t: float, y: Floats) -> Floats:
    """Slopes of the nodes' residual in the deflections, pair by pair, shape (pairs, nodes, nodes)."""
    pairs, n = m.scene.histories, m.scene.nodes
    slopes = np.empty((pairs, n, n))
    for k in range(n):  # the same node of all pairs at once: they do not see each other
        nudge = np.zeros((pairs, n))
        nudge[:, k] = _NUDGE
        step = np.concatenate([np.zeros(y.size - pairs * n), nudge.ravel()])
        slopes[:, :, k] = (_deviation(m, t, y + step) - _deviation(m, t, y - step)) / (2.0 * _NUDGE)
    return slopes


def settle_nodes(m: Model, t: float, y: Floats) -> bool:
    """Solve for the deflections at a given motion, in place; whether that succeeded.

    Parameters
    ----------
    t : float
        Time over tau.
    y : ndarray
        State; the deflections in it are where the search begins.
    """
    pairs, n = m.scene.histories, m.scene.nodes
    for _ in range(_TRIES):
        try:
            change = np.linalg.solve(_slopes(m, t, y), _deviation(m, t, y)[:, :, None])[:, :, 0]
        except np.linalg.LinAlgError:  # a fold, to the last bit
            return False
        largest = float(np.max(np.abs(change)))
        if not math.isfinite(largest):
            return False
        y[-pairs * n :] -= (change * min(1.0, _STRIDE / max(largest, _STRIDE))).ravel()
        if largest <= SETTLED:
            return True
    return False


def fold_gap(m: Model, t: float, y: Floats) -> float:
    """Gap of a pair whose static contact does not go on the way it was going, at the last accepted time; NaN if none.

    A pair is moved on a little with the bodies' deflections following. Where these no longer do, or move many times as
    fast as the pair, or the equations of its nodes have a determinant that is not positive, the static curve folds. So
    it does where a run begins with a contact for which no equilibrium was found.

    Parameters
    ----------
    t : float
        Time over tau.
    y : ndarray
        State there.

    Returns
    -------
    float
        In roughnesses.
    """
    profile = profile_of(m, False)
    for k in range(m.scene.histories):
        h = m.state.history[k]
        gap, direction = float(h.gap), float(h.direction)
        if h.pair == EMPTY or not in_reach(m, gap):
            continue
        length = contact_length(m, path_position(m, flank_of_history(m, k), int(h.pair), float(y[PHASE])))
        kept = row_of(m, k, GAP) - gap - profile
        here = _follow(m, t, k, length, kept, gap)
        if here is not None and np.max(np.abs(here - kept)) > _ASIDE:
            return gap
        for ahead in _AHEAD:
            there = None if here is None else _follow(m, t, k, length, here, gap + direction * ahead)
            if here is None or there is None or np.max(np.abs(there - here)) > _FOLD_SHARE * ahead:
                return gap
    return math.nan


def _follow(m: Model, t: float, k: int, length: float, deflection: Floats, gap: float) -> Floats | None:
    """Deflections of one pair at a gap, on the stable branch next to given ones; None if there are none."""
    n = m.scene.nodes
    first, pressure = first_unknown(m, k), row_of(m, k, PRESSURE)
    y, slopes, kappa = np.zeros(m.scene.states), np.empty((n, n)), np.empty((n, n))
    influence(m, length, kappa)
    for _ in range(_TRIES):
        y[first : first + n] = deflection
        node_force(m, k, True, t, y, gap, float(m.state.history[k].direction), length)
        stiffness_matrix(m, k, slopes)
        matrix = np.eye(n) - kappa.T @ slopes
        if not np.all(np.isfinite(matrix)) or np.linalg.det(matrix) <= 0.0:
            return None
        change = np.linalg.solve(matrix, deflection - pressure @ kappa)
        deflection = deflection - change
        if np.max(np.abs(change)) <= _FOLLOWED:
            return deflection
    return None
