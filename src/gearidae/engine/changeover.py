"""From the asperity model to the elastic one in the middle of a run."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearidae.engine import layout as at
from gearidae.engine.mesh import history_slot
from gearidae.engine.nodes import meet_nodes, row
from gearidae.engine.problem import Problem
from gearidae.engine.settle import settle_nodes

__all__ = ["change_over"]

Floats = NDArray[np.float64]


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
    _join(d, y)
    settle_nodes(d, time, y)
    _join(d, y)
    d[at.LAST_TIME] = time
    return new.checkpoint(time, y, counters)


def _join(d: Floats, y: Floats) -> None:
    """Stretch every node as its pair is stretched."""
    n = int(d[at.NODES])
    for k in range(int(d[at.TOTAL_SLOTS])):
        slot = int(d[at.HISTORIES]) + int(d[at.HISTORY]) * k
        if math.isnan(d[slot + at.PAIR]):
            continue
        gap = d[slot + at.LAST_GAP]
        meet_nodes(d, slot, y, gap)
        for material in range(2):
            first = row(d, slot, at.ROW_JOINED + material)
            d[first : first + n] += d[slot + at.JOINED + material] - gap
