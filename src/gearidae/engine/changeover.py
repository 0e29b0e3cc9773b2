"""From one contact model, or one layout of nodes, to another in the middle of a run."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearidae.engine.elastic.nodes import (
    book_points,
    first_unknown,
    meet_nodes,
    point_count,
    point_weights,
    row,
)
from gearidae.engine.elastic.static_solve import SETTLED, settle_nodes
from gearidae.engine.energy.balance import carry_ledger
from gearidae.engine.model import layout as at
from gearidae.engine.model.problem import Problem
from gearidae.engine.model.tooth_pairs import history_slot

__all__ = ["change_over", "deepen"]

Floats = NDArray[np.float64]

_ROUNDS = 20  # each brings the deflections ten times nearer to those of what is joined, or more


def change_over(old: Problem, new: Problem, checkpoint: Floats) -> Floats:
    """Checkpoint from which the elastic problem goes on where the asperity problem stopped.

    The motion, the mesh and what every pair remembers are kept. The deflections are those that the pressures cause
    (some hundredths of the roughness, which is when this happens), and every node is stretched as its pair was.

    Parameters
    ----------
    old : Problem
        The asperity problem.
    new : Problem
        The same scene's elastic problem, fresh.
    checkpoint : ndarray
        Where the asperity problem stands.
    """
    d, source = new.data, old.data
    motion = old.start.size
    state = np.empty(motion)
    counters = np.empty(checkpoint.size - int(source[at.LOADING_AT]) - motion - 1, np.int64)
    time = old.restore(checkpoint, state, counters)
    d[at.TURNS : at.PASSED] = source[at.TURNS : at.PASSED]
    for law in (at.DRIVE_AT, at.LOAD_AT):
        d[int(d[law]) + at.LAW_SEGMENT] = source[int(source[law]) + at.LAW_SEGMENT]
    y = np.concatenate([state, np.zeros(new.start.size - motion)])
    slots = int(source[at.SLOTS])
    d[[history_slot(d, k // int(d[at.SLOTS]), k) + at.PAIR for k in range(int(d[at.TOTAL_SLOTS]))]] = math.nan
    for k in range(int(source[at.TOTAL_SLOTS])):
        coast = k // slots
        start = int(source[at.HISTORIES]) + int(source[at.HISTORY]) * k
        if math.isnan(source[start + at.PAIR]):
            continue
        slot = history_slot(d, coast, int(source[start + at.PAIR]))
        d[slot : slot + at.BRANCHES] = source[start : start + at.BRANCHES]
    d[at.LAST_TIME] = time
    # what is joined goes with the gaps along the contact, and these with the pressures of what is joined
    for _ in range(_ROUNDS):
        before = y.copy()
        _join(d, y)
        settle_nodes(d, time, y)
        if np.max(np.abs(y - before)) <= SETTLED:
            break
    carry_ledger(source, state, d, y)
    return new.checkpoint(time, y, counters)


def deepen(old: Problem, new: Problem, checkpoint: Floats) -> Floats:
    """Checkpoint from which nodes that reach further go on where those of a contact have been pressed too deep.

    Everything is kept but for the nodes' places: joined heights are carried to the new ones by interpolation along the
    contact, and deflections are solved for.

    Parameters
    ----------
    old : Problem
        The elastic problem so far.
    new : Problem
        The same, laid out for deeper contacts, with as many nodes.
    checkpoint : ndarray
        Where the old one stands.
    """
    d, source = new.data, old.data
    changing = int(source[at.LOADING_AT])
    state = np.empty(old.start.size)
    counters = np.empty(checkpoint.size - changing - state.size - 1, np.int64)
    time = old.restore(checkpoint, state, counters)
    lowest = d[at.LOWEST_GAP]
    d[:changing] = source[:changing]
    d[[at.LOWEST_GAP, at.PASSED]] = lowest, 0.0
    nodes = int(d[at.NODES])
    points, grid, weights = point_count(nodes), int(d[at.GRID_AT]), point_weights(d)
    kinds = [(at.ROW_SHARE, nodes, grid, 0.0)]
    kinds += [(at.ROW_JOINED + material, points, weights - points, 1.0) for material in range(2)]
    y = state.copy()
    for k in range(int(d[at.TOTAL_SLOTS])):
        slot = int(d[at.HISTORIES]) + int(d[at.HISTORY]) * k
        first = first_unknown(d, slot)
        y[first : first + nodes] = _along(source, d, grid, state[first : first + nodes])
        for kind, count, profile, curved in kinds:
            own = row(d, slot, kind)
            before = source[own : own + count] - curved * source[profile : profile + count]
            d[own : own + count] = _along(source, d, profile, before) + curved * d[profile : profile + count]
    settle_nodes(d, time, y)
    for k in range(int(d[at.TOTAL_SLOTS])):
        slot = int(d[at.HISTORIES]) + int(d[at.HISTORY]) * k
        first, gaps = first_unknown(d, slot), row(d, slot, at.ROW_GAP)
        d[gaps : gaps + nodes] = d[slot + at.LAST_GAP] + d[grid : grid + nodes] + y[first : first + nodes]
        for material in range(2):
            book_points(d, slot, material)
    carry_ledger(source, state, d, y)
    return new.checkpoint(time, y, counters)


def _along(source: Floats, d: Floats, profile: int, values: Floats) -> Floats:
    """Carry values from places along the old contact to those along the new one, flat beyond the last."""
    # takes a sixth of a second to import, and few runs need it
    from scipy.interpolate import PchipInterpolator

    span = slice(profile, profile + values.size)
    here, there = np.sqrt(source[span]), np.sqrt(d[span])
    return np.asarray(PchipInterpolator(here, values)(np.minimum(there, here[-1])))


def _join(d: Floats, y: Floats) -> None:
    """Stretch every point as its pair is stretched."""
    points = point_count(int(d[at.NODES]))
    for k in range(int(d[at.TOTAL_SLOTS])):
        slot = int(d[at.HISTORIES]) + int(d[at.HISTORY]) * k
        if math.isnan(d[slot + at.PAIR]):
            continue
        gap = d[slot + at.LAST_GAP]
        meet_nodes(d, slot, y, gap)
        for material in range(2):
            first = row(d, slot, at.ROW_JOINED + material)
            d[first : first + points] += d[slot + at.JOINED + material] - gap
            if d[slot + at.JOINED + material] < gap:
                d[slot + at.STRETCHED] = 1.0
            book_points(d, slot, material)
