r"""A step of Newton's method for the deflections of one pair.

With the loads :math:`w_i p_i` of the nodes and their slopes in the gaps, a symmetric matrix S, the equations are

.. math::

    (1 - B)\, x = d - \kappa\, p, \qquad (1 - B)\, x' = B\, 1, \qquad B = \kappa\, w^{-1} S,

where x is the step and x' the slope of the deflections in the pair's gap. Where the bodies are much stiffer than the
asperities between them, as those of gears mostly are, B is small, and the series :math:`1 + B + B^2 + \ldots` needs a
few products of a matrix and a vector. Else the equations are solved by elimination with pivots.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gearidae.compiled import compiled
from gearidae.contact.kernels.lanes import LANES, add_lanes, sum_rows
from gearidae.engine.elastic.node_rows import (
    MATRICES,
    PRESSURE,
    first_unknown,
    node_weights,
    padded,
    row,
    scratch,
)
from gearidae.engine.elastic.nodes import weighed_stiffness
from gearidae.engine.model.state import Floats, Model

NEWTON_STEP: Final = 0  # vectors in the scratch space: the step, in the end, to be taken off the deflections,
DEFLECTION_SLOPE: Final = 1  # slopes of the deflections in the pair's gap,
SUMS: Final = 2  # slopes of the nodes' loads in the pair's gap,
_LOADS: Final = 3  # and loads and a term of the series
_TERM: Final = 4
_SLOPES: Final = 5  # then matrices: S, the equations, and the influence coefficients

MILD: Final = 0.1
"""Slope of a deflection in the gap below which the series is tried: each term is so many times the one before."""
TERMS: Final = 8
EXACT: Final = 1e-7
"""Last term over the sum: it is to be small beside the second order of Newton's method."""


@compiled(makes_arrays=True)
def equation_space(m: Model, which: int) -> Floats:
    """Vector or matrix in the scratch space; of a matrix, n rows."""
    n, width = m.scene.nodes, padded(m.scene.nodes)
    space = scratch(m, MATRICES, _SLOPES * width + 3 * n * width)
    if which < _SLOPES:
        return space[which * width : (which + 1) * width]
    start = _SLOPES * width + (which - _SLOPES) * n * width
    return space[start : start + n * width]


@compiled(makes_arrays=True)
def influence_space(m: Model) -> Floats:
    """Index of the influence coefficients, column by column, shape (n, n)."""
    n = m.scene.nodes
    return equation_space(m, _SLOPES + 2)[: n * n].reshape(n, n)


@compiled(makes_arrays=True)
def newton_step(m: Model, k: int, y: Floats) -> bool:
    """Work out a step, and how the deflections follow the gap, after `force_of_nodes` and `influence`.

    Parameters
    ----------
    k : int
        Index of the pair's history.
    y : ndarray
        State, with its deflections.

    Returns
    -------
    bool
        Whether the determinant of the equations is positive.
    """
    n, first, pressure, weights = m.scene.nodes, first_unknown(m, k), row(m, k, PRESSURE), node_weights(m)
    width = padded(n)
    step, follow, sums = (
        equation_space(m, NEWTON_STEP),
        equation_space(m, DEFLECTION_SLOPE),
        equation_space(m, SUMS),
    )
    loads, slopes, kappa = (
        equation_space(m, _LOADS),
        equation_space(m, _SLOPES),
        equation_space(m, _SLOPES + 2),
    )
    weighed_stiffness(m, k, slopes, width)
    for i in range(n):
        loads[i] = weights[i] * pressure[i]
    _deflect(m, kappa, loads, step)
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += slopes[width * i + j]
        sums[i] = loads[i] = total
    _deflect(m, kappa, loads, follow)
    largest = 0.0
    for i in range(n):
        step[i] = y[first + i] - step[i]
        largest = max(largest, abs(follow[i]))
    term = equation_space(m, _TERM)
    if largest < MILD:
        start = equation_space(m, _SLOPES + 1)
        for i in range(n):  # where the series does not do, they are wanted again
            start[i], start[width + i] = step[i], follow[i]
        if _sum_series(m, slopes, kappa, step, term, loads) and _sum_series(
            m, slopes, kappa, follow, term, loads
        ):
            return True
        for i in range(n):
            step[i], follow[i] = start[i], start[width + i]
    return _eliminate(m, slopes, kappa, step, follow)


@compiled(makes_arrays=True)
def _deflect(m: Model, kappa: Floats, loads: Floats, out: Floats) -> None:
    """Deflections under given loads of the nodes, which become pressures."""
    n, weights = m.scene.nodes, node_weights(m)
    for j in range(n):
        loads[j] /= weights[j]
    for c in range(0, n, LANES):  # beyond the last of a column is the next one, which goes to the padding
        sum_rows(out, np.uintp(c), kappa, np.uintp(c), np.uintp(n), loads, np.uintp(n))


@compiled(makes_arrays=True)
def _sum_series(m: Model, slopes: Floats, kappa: Floats, x: Floats, term: Floats, loads: Floats) -> bool:
    """Solve for one right-hand side, in place; whether the series has come to an end."""
    n, width = m.scene.nodes, padded(m.scene.nodes)
    for i in range(n):
        term[i] = x[i]
    for _ in range(TERMS):
        for c in range(0, n, LANES):
            sum_rows(loads, np.uintp(c), slopes, np.uintp(c), np.uintp(width), term, np.uintp(n))
        _deflect(m, kappa, loads, term)
        last = largest = 0.0
        for i in range(n):
            x[i] += term[i]
            last, largest = max(last, abs(term[i])), max(largest, abs(x[i]))
        if last <= EXACT * largest:
            return True
    return False


@compiled(makes_arrays=True)
def _eliminate(m: Model, slopes: Floats, kappa: Floats, x: Floats, y: Floats) -> bool:
    """Solve for two right-hand sides, in place; whether the determinant is positive."""
    n, weights, a = m.scene.nodes, node_weights(m), equation_space(m, _SLOPES + 1)
    width = padded(n)
    for i in range(n * width):
        a[i] = 0.0
    for j in range(n):
        weight = -1.0 / weights[j]
        for i in range(n):
            factor = weight * kappa[n * j + i]
            for c in range(0, width, LANES):
                add_lanes(a, np.uintp(width * i + c), slopes, np.uintp(width * j + c), factor)
    for i in range(n):
        a[width * i + i] += 1.0
        a[width * i + n], a[width * i + n + 1] = x[i], y[i]
    positive = _triangular(a, n)
    for k in range(n - 1, -1, -1):
        first, second, pivot = a[width * k + n], a[width * k + n + 1], a[width * k + k]
        for j in range(k + 1, n):
            first -= a[width * k + j] * x[j]
            second -= a[width * k + j] * y[j]
        inverse = 1.0 / pivot if pivot != 0.0 else math.inf
        x[k], y[k] = first * inverse, second * inverse
    return positive


@compiled
def _triangular(a: Floats, n: int) -> bool:
    """Bring a matrix to triangular form in place, by rows with pivots; whether its determinant is positive."""
    width = padded(n)
    positive = True
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(a[width * i + k]) > abs(a[width * pivot + k]):
                pivot = i
        if pivot != k:
            positive = not positive
            for j in range(k, n + 2):
                a[width * k + j], a[width * pivot + j] = a[width * pivot + j], a[width * k + j]
        if a[width * k + k] < 0.0:
            positive = not positive
        inverse = 1.0 / a[width * k + k] if a[width * k + k] != 0.0 else math.inf
        for i in range(k + 1, n):
            factor = -a[width * i + k] * inverse
            for c in range(k // LANES * LANES, width, LANES):  # what comes before k is not looked at again
                add_lanes(a, np.uintp(width * i + c), a, np.uintp(width * k + c), factor)
    return positive
