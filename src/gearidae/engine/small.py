"""Linear equations of as few unknowns as a motion has, which SUNDIALS' dense solver is not made for.

With the two states of a roller or the four of a gear pair, a solver made for any size spends most of its time
finding out what there is to do. The operations and their order are those of SUNDIALS' own solver, so that the results
are the same to the last bit.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled

__all__ = ["factorise", "solve"]

Floats = NDArray[np.float64]


@compiled
def factorise(n: int, store: Floats) -> int:
    """Factorise a matrix in place, with partial pivoting.

    Parameters
    ----------
    n : int
        Equations.
    store : ndarray, shape (n (n + 1),)
        The matrix, column by column; then what is filled in, the row that each pivot was found in.

    Returns
    -------
    int
        0, or 1 + the column without a pivot.
    """
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(store[n * k + i]) > abs(store[n * k + pivot]):
                pivot = i
        store[n * n + k] = pivot
        if store[n * k + pivot] == 0.0:
            return k + 1
        if pivot != k:
            for j in range(n):
                store[n * j + k], store[n * j + pivot] = store[n * j + pivot], store[n * j + k]
        share = 1.0 / store[n * k + k]
        for i in range(k + 1, n):
            store[n * k + i] *= share
        for j in range(k + 1, n):
            above = store[n * j + k]
            if above != 0.0:
                for i in range(k + 1, n):
                    store[n * j + i] -= above * store[n * k + i]
    return 0


@compiled(inline=True)
def solve(n: int, store: Floats, b: Floats, x: Floats) -> None:
    """Solve the equations that `factorise` has left in `store`; x may be b."""
    for i in range(n):
        x[i] = b[i]
    for k in range(n):
        pivot = int(store[n * n + k])
        if pivot != k:
            x[k], x[pivot] = x[pivot], x[k]
    for k in range(n - 1):
        for i in range(k + 1, n):
            x[i] -= store[n * k + i] * x[k]
    for k in range(n - 1, -1, -1):
        x[k] /= store[n * k + k]
        for i in range(k):
            x[i] -= store[n * k + i] * x[k]
