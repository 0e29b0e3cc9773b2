"""What a checkpoint keeps of the nodes of an elastic contact: their gaps, shares and joined heights.

Pressures, slopes and stiffness are worked out anew at each evaluation, and the adhered energy follows from the joined
heights: none of them is kept. Of a history that is about no pair, nothing is.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.asperities.ranges import GAP_HIGH, GAP_LOW, STRETCH_HIGH
from gearidae.engine.elastic.histories import LARGEST_SHARE, book_points
from gearidae.engine.elastic.rows import (
    ADHERED_ENERGY,
    GAP,
    JOINED,
    NODE_ROWS,
    PRESSURE,
    SHARE,
    STIFFNESS,
    first_unknown,
    point_gaps,
    profile_of,
)
from gearidae.engine.model.state import EMPTY, MATERIALS, Floats, Model, Record

__all__ = ["DEFLECTION_HIGH", "KEPT_ROWS", "check_rows", "kept_rows", "restore_rows"]

KEPT_ROWS: Final = ("gap", "share", "joined")
"""Names of the kept rows, part of a checkpoint's layout."""

DEFLECTION_HIGH: Final = GAP_HIGH + STRETCH_HIGH - GAP_LOW
"""Deflection [roughnesses] that takes a node from the deepest tabulated gap to beyond the reach of any law."""

_SHARE_SLACK: Final = 1e-9  # of interpolation, where nodes have been laid out anew
_FOLLOWED: Final = 0.1
"""Roughnesses by which a node's gap may differ from that of its pair and its deflection: where a contact model has
taken over, deflections have been solved for after the gaps were noted."""
_TAKEN_OVER: Final = 1.0
"""Roughnesses by which the joined height in the middle may differ from that of the pair, for the same reason: by the
deflection at which the elastic model takes over, some hundredths, and more where a long step has led there."""

assert (GAP, SHARE, PRESSURE) == (0, 1, 2)  # what is kept lies together, of the nodes and of the points
assert STIFFNESS == JOINED + MATERIALS < ADHERED_ENERGY


def kept_rows(m: Model) -> Floats:
    """Return what is kept of all histories, one after the other, shape (histories * numbers,)."""
    if m.scene.nodes == 0:
        return np.empty(0)
    kept = _all_rows(m)[:, _kept_columns(m)]
    kept[_pairs(m, m.state) == EMPTY] = 0.0
    return np.ascontiguousarray(kept).ravel()


def restore_rows(m: Model, rows: Floats) -> None:
    """Take rows back that have been checked, and work out what follows from them; ``m.state`` is that of the rows."""
    if m.scene.nodes == 0:
        return
    own = _all_rows(m)
    own[:] = 0.0
    own[:, _kept_columns(m)] = rows.reshape(m.scene.histories, -1)
    for k in np.flatnonzero(_pairs(m, m.state) != EMPTY).tolist():
        for material in range(MATERIALS):
            book_points(m, k, material)


def check_rows(m: Model, state: Record, y: Floats, rows: Floats, current: NDArray[np.bool_]) -> str:
    """Compare rows of a checkpoint with the state that they belong to.

    Parameters
    ----------
    m : Model
        Of the scene.
    state : record
        ``STATE`` of the checkpoint, whose histories have been checked.
    y : ndarray, shape (n,)
        Its state vector.
    rows : ndarray
        Like those of `kept_rows`; finite.
    current : ndarray, shape (histories,)
        Pairs that were within reach at the last accepted time: their nodes stand where the state vector says.

    Returns
    -------
    str
        What they must be and are not; empty if they are.
    """
    if m.scene.nodes == 0:
        return ""
    n, count = int(m.scene.nodes), int(m.scene.histories)
    kept, used, histories = rows.reshape(count, -1), _pairs(m, state) != EMPTY, state.history[:count]
    if kept[~used].any():
        return "zero where there is no pair"
    first = int(first_unknown(m, 0))
    deflection = y[first : first + count * n].reshape(count, n)
    gap = np.where(used, histories["gap"], 0.0)[:, None]
    most = DEFLECTION_HIGH + np.abs(gap)  # a step may have gone below the tables before that was noticed
    if (np.abs(deflection) > most).any():
        return "deflections within the reach of the tables"
    gaps, shares, joined = np.split(kept, [n, 2 * n], axis=1)
    moved = gaps - (gap + profile_of(m, False))
    if (np.abs(moved) > most)[used].any():
        return "gaps within the reach of the tables"
    # of a pair that is out of reach by now, the deflection is no longer that of its last gap
    if (np.abs(moved - deflection)[current] > _FOLLOWED).any():
        return "the gaps of the nodes, from the pair's own and the deflection"
    if (shares < -_SHARE_SLACK).any() or (shares > LARGEST_SHARE + _SHARE_SLACK).any():
        return "shares in the pair's motion"
    heights = joined.reshape(count, MATERIALS, -1)
    if (np.abs(heights - profile_of(m, True)) > 2.0 * most[:, :, None])[used].any():
        return "joined heights within the reach of the tables"
    return next(
        filter(
            None, (_check_joined(m, k, histories[k], y, heights[k]) for k in np.flatnonzero(current).tolist())
        ),
        "",
    )


def _check_joined(m: Model, k: int, h: Record, y: Floats, heights: Floats) -> str:
    """Check the joined heights along a contact: of the play operator, next to the gaps of the last motion."""
    gaps = np.empty(int(m.scene.points))
    point_gaps(m, k, y, float(h.gap), gaps)
    slack = _FOLLOWED + 100.0 * float(m.scene.rtol) * (1.0 + abs(float(h.gap)))
    for material in range(MATERIALS):
        limit, joined = float(m.scene.material[material].stretch_limit), heights[material]
        if limit == 0.0:
            continue
        if abs(joined[0] - h.joined[material]) > _TAKEN_OVER + slack:
            return "joined heights, in the middle that of the pair"
        if h.direction > 0.0 and (joined > gaps + slack).any():
            return "joined heights, below the gaps of a contact that opens"
        if h.direction < 0.0 and (joined < gaps - limit - slack).any():
            return "joined heights, within reach of a contact that closes"
    return ""


def _pairs(m: Model, state: Record) -> NDArray[np.int64]:
    return np.asarray(state.history["pair"][: int(m.scene.histories)])


def _all_rows(m: Model) -> Floats:
    start, length, histories = (
        int(m.scene[name]) for name in ("node_rows_at", "node_row_length", "histories")
    )
    return m.rows[start : start + length * histories].reshape(histories, length)


def _kept_columns(m: Model) -> NDArray[np.int64]:
    """Places of the kept numbers in one history's rows: gap and share of the nodes, joined heights of the points."""
    n, points = int(m.scene.nodes), int(m.scene.points)
    first = NODE_ROWS * n
    return np.concatenate([np.arange(2 * n), np.arange(first, first + MATERIALS * points)])
