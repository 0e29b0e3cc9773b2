"""Gauss-Legendre rules, each worked out once: the tables of one surface use them some forty times."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray


@cache
def gauss_rule(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nodes on -1..1 and weights of the rule that is exact up to degree ``2 count - 1``.

    Parameters
    ----------
    count : int
        Nodes.

    Returns
    -------
    nodes, weights : ndarray, shape (count,)
        Read-only, shared between callers.
    """
    nodes, weights = np.polynomial.legendre.leggauss(count)
    nodes.setflags(write=False)
    weights.setflags(write=False)
    return nodes, weights
