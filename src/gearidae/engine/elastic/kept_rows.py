"""What a checkpoint keeps of the nodes of an elastic contact: their gaps, shares and joined heights.

Pressures, slopes and stiffness are worked out anew at each evaluation, and the adhered energy follows from the joined
heights: none of them is kept. Of a history that is about no pair, nothing is.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.engine.elastic.histories import accumulate_points
from gearidae.engine.elastic.node_rows import (
    ADHERED_ENERGY,
    GAP,
    GAP_SHARE,
    JOINED,
    NODE_ROWS,
    PRESSURE,
    STIFFNESS,
)
from gearidae.engine.model.state import EMPTY, MATERIALS, Floats, Model

KEPT_ROWS: Final = ("gap", "share", "joined")
"""Names of the kept rows, part of a checkpoint's layout."""

assert (GAP, GAP_SHARE, PRESSURE) == (0, 1, 2)  # what is kept lies together, of the nodes and of the points
assert STIFFNESS == JOINED + MATERIALS < ADHERED_ENERGY


def kept_rows(m: Model) -> Floats:
    """Return what is kept of all histories, one after the other, shape (histories * numbers,)."""
    if m.scene.nodes == 0:
        return np.empty(0)
    kept = _all_rows(m)[:, _kept_columns(m)]
    kept[_pairs(m) == EMPTY] = 0.0
    return np.ascontiguousarray(kept).ravel()


def restore_rows(m: Model, rows: Floats) -> None:
    """Take rows back that have been checked, and work out what follows from them; ``m.state`` belongs to the rows."""
    if m.scene.nodes == 0:
        return
    all_rows = _all_rows(m)
    all_rows[:] = 0.0
    all_rows[:, _kept_columns(m)] = rows.reshape(m.scene.histories, -1)
    for k in np.flatnonzero(_pairs(m) != EMPTY).tolist():
        for material in range(MATERIALS):
            accumulate_points(m, k, material)


def _pairs(m: Model) -> NDArray[np.int64]:
    return np.asarray(m.state.history["pair"][: int(m.scene.histories)])


def _all_rows(m: Model) -> Floats:
    start, length, histories = (
        int(m.scene[name]) for name in ("node_rows_at", "node_row_length", "histories")
    )
    return m.rows[start : start + length * histories].reshape(histories, length)


def _kept_columns(m: Model) -> NDArray[np.int64]:
    """Indices of the kept numbers in one history's rows: gap and share of the nodes, joined heights of the points."""
    n, points = int(m.scene.nodes), int(m.scene.points)
    first = NODE_ROWS * n
    return np.concatenate([np.arange(2 * n), np.arange(first, first + MATERIALS * points)])
