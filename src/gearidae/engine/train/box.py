"""Friction of all that is at rest in a train: a quadratic programme over a box, by active sets.

Elements at rest, tooth pairs that roll and shafts that stand, have relative accelerations ``g - G f`` under their
friction f, with ``G = J I^-1 J^T`` and the accelerations g without it. Gauss' principle of least constraint gives

    min  1/2 f' G f - f' g,    |f_j| <= l_j.

What is within its limit is held; what is at it slips if the acceleration that is left has its direction. Elements may
outnumber the shafts: then G is singular, the frictions are not unique, and the accelerations are.

C. Lanczos, The Variational Principles of Mechanics, 4th ed., 1970, section IV.8; active sets with bounds as P. B.
Stark and R. L. Parker, Computational Statistics 10 (1995) 129-141.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled

FREE_ACCELERATION, LIMIT, UNIT, FRICTION, LEFT, STEP, BOUND, BEFORE = range(8)
"""Rows of the table of elements: g; l; force that counts as none; f; g - G f; a step of f; 1 or -1 at the limit; and
f before a pass over the loads of hubs."""
BOX_ROWS: Final = 8
DEPENDENT: Final = 1e-12
"""Pivot over the diagonal below which an element depends on others."""
SMALL: Final = 1e-2
"""Of the force that counts as none: a missing friction below it is none. Rounding is some 1e-4 of it."""
PASSES: Final = 10
"""Changes of the active set for each element, at most; two are enough nearly always."""


@compiled
def solve_free(
    count: int, gram: NDArray[np.float64], work: NDArray[np.float64], box: NDArray[np.float64]
) -> int:
    """Solve ``G step = left`` on all elements that are not at a limit; the number of independent ones is returned.

    Dependent ones have a step of zero. Matrix and elements are scaled by the root of the diagonal.
    """
    for i in range(count):
        box[STEP, i] = box[LEFT, i] / math.sqrt(gram[i, i])
        for j in range(count):
            work[i, j] = gram[i, j] / math.sqrt(gram[i, i] * gram[j, j])
        work[i, count] = 0.0  # 1 of an element that has been eliminated
    rank = 0
    for _ in range(count):
        pivot, largest = -1, DEPENDENT
        for i in range(count):
            if box[BOUND, i] == 0.0 and work[i, count] == 0.0 and work[i, i] > largest:
                pivot, largest = i, work[i, i]
        if pivot < 0:
            break
        work[pivot, count] = 1.0
        rank += 1
        for i in range(count):
            if i == pivot or box[BOUND, i] != 0.0:
                continue
            factor = work[i, pivot] / largest
            for j in range(count):
                work[i, j] -= factor * work[pivot, j]
            box[STEP, i] -= factor * box[STEP, pivot]
    for i in range(count):
        solved = box[BOUND, i] == 0.0 and work[i, count] != 0.0
        box[STEP, i] = box[STEP, i] / (work[i, i] * math.sqrt(gram[i, i])) if solved else 0.0
    return rank


@compiled
def write_left(count: int, gram: NDArray[np.float64], box: NDArray[np.float64]) -> None:
    """Work out the accelerations that the frictions leave."""
    for i in range(count):
        left = box[FREE_ACCELERATION, i]
        for j in range(count):
            left -= gram[i, j] * box[FRICTION, j]
        box[LEFT, i] = left


@compiled
def missing_friction(i: int, gram: NDArray[np.float64], box: NDArray[np.float64]) -> float:
    """Friction that would take an element's acceleration alone, over the force that counts as none; with its sign."""
    return float(box[LEFT, i] / (gram[i, i] * box[UNIT, i]))


@compiled
def solve_held(
    count: int, gram: NDArray[np.float64], work: NDArray[np.float64], box: NDArray[np.float64]
) -> int:
    """Frictions that hold all elements, whatever their limits; the number of independent elements is returned."""
    for i in range(count):
        box[BOUND, i] = box[FRICTION, i] = 0.0
        box[LEFT, i] = box[FREE_ACCELERATION, i]
    rank = solve_free(count, gram, work, box)
    for i in range(count):
        box[FRICTION, i] = box[STEP, i]
    return rank


@compiled
def solve_box(
    count: int, gram: NDArray[np.float64], work: NDArray[np.float64], box: NDArray[np.float64]
) -> bool:
    """Frictions within their limits by Gauss' principle, and the accelerations that they leave; whether found.

    Parameters
    ----------
    count : int
        Elements.
    gram : ndarray, shape (m, m), m >= count
        G, with a positive diagonal.
    work : ndarray, shape (m, m + 1)
        Changed.
    box : ndarray, shape (BOX_ROWS, m)
        Rows as named above: accelerations without friction, limits and units are taken, the others are written.
    """
    for i in range(count):
        box[FRICTION, i] = 0.0
        box[BOUND, i] = 0.0 if box[LIMIT, i] > 0.0 else 1.0
    for _ in range(PASSES * (count + 1)):
        write_left(count, gram, box)
        solve_free(count, gram, work, box)
        share, blocking = 1.0, -1
        for i in range(count):
            step = box[STEP, i]
            if abs(box[FRICTION, i] + step) > box[LIMIT, i] and step != 0.0:
                reach = max((math.copysign(box[LIMIT, i], step) - box[FRICTION, i]) / step, 0.0)
                if reach < share:
                    share, blocking = reach, i
        for i in range(count):
            box[FRICTION, i] += share * box[STEP, i]
        if blocking >= 0:
            way = math.copysign(1.0, box[STEP, blocking])
            box[FRICTION, blocking], box[BOUND, blocking] = way * box[LIMIT, blocking], way
            continue
        write_left(count, gram, box)
        worst, most = -1, SMALL
        for i in range(count):
            if box[BOUND, i] != 0.0 and box[LIMIT, i] > 0.0:
                wrong = -box[BOUND, i] * missing_friction(i, gram, box)
                if wrong > most:
                    worst, most = i, wrong
        if worst < 0:
            return True
        box[BOUND, worst] = 0.0
    return False
