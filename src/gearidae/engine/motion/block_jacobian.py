"""The Jacobian of an elastic contact and its solution by blocks.

The nodes of one pair couple to the motion only through its gap and its force. With the states of motion x, deflections
z of each pair, g its gap and W its force, Newton's equations read

    A x + sum over pairs of beta (rho . z) = b,        D z - c (gamma . x) = b_z        (for each pair)

with beta what the motion's equations take of the force, rho its slopes in the deflections, gamma the slopes of the gap
in the motion, ``D = 1 - kappa dp/dh`` and ``c = kappa dp/dh 1``, dp/dh a matrix. Each
pair's z is eliminated by its own inverse of D, and what is left is the small system of the motion. A pair out of reach
costs nothing.

All of it lies in one flat array, which SUNDIALS keeps as the data of a matrix: sizes, A (or its inverse), and a
block for each pair's history.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from gearidae.compiled import compiled
from gearidae.engine.elastic.node_rows import node_weights
from gearidae.engine.elastic.nodes import influence, stiffness_matrix
from gearidae.engine.friction.pairs import direction, levers
from gearidae.engine.model.state import MOTION, PHASE, Floats, Model, U, V, W
from gearidae.engine.motion.residual import motion_slopes, write_jacobian
from gearidae.engine.pairs.tooth_pairs import contact_length, flank_of_history

_NODES: Final = 0  # sizes: nodes, blocks
_BLOCKS: Final = 1
_SMALL: Final = 2  # A, row by row
_FIRST: Final = _SMALL + MOTION * MOTION
# a block: whether it is loaded, beta and gamma, then rho, c and D (rho and c times the inverse once factorised)
_BETA: Final = 1
_GAMMA: Final = 5
_RHO: Final = 9


@compiled
def store_size(m: Model) -> int:
    """Numbers that `assemble` wants."""
    n = m.scene.nodes
    return _FIRST + m.scene.histories * (_RHO + 2 * n + n * n)


@compiled
def unknowns(store: Floats) -> int:
    """Unknowns of the equations in a store."""
    return MOTION + int(store[_NODES]) * int(store[_BLOCKS])


@compiled(makes_arrays=True)
def assemble(m: Model, t: float, cj: float, y: Floats, store: Floats) -> None:
    """Work out the Jacobian ``dF/dy + cj dF/dy'`` by blocks.

    Parameters
    ----------
    t, cj : float
        Time over tau, and IDA's leading coefficient.
    y : ndarray
        State.
    store : ndarray, shape (store_size(m),)
        Filled in.
    """
    n = m.scene.nodes
    store[_NODES], store[_BLOCKS] = n, m.scene.histories
    small = np.empty(MOTION * MOTION)
    slopes = motion_slopes(m, t, y)
    write_jacobian(m, cj, slopes, small)
    for i in range(MOTION):
        for j in range(MOTION):
            store[_SMALL + MOTION * i + j] = small[i + MOTION * j]
    size = _RHO + 2 * n + n * n
    for block in range(m.scene.histories):
        store[_FIRST + size * block] = 0.0
    for i in range(m.work.pair_forces.count):
        noted = m.work.pair_forces.pair[i]
        start = _assemble_pair(m, noted.history, contact_length(m, noted.position), store)
        sign = 1.0 - 2.0 * flank_of_history(m, noted.history)
        on_pinion, on_gear = sign, sign * (1.0 + noted.relief)
        if m.scene.friction.flanks != 0 and noted.contact != 0.0:
            friction = direction(m, noted) * noted.limit / noted.contact
            first, second = levers(m, noted.position)
            on_pinion, on_gear = on_pinion + friction * first, on_gear + friction * second
        store[start + _BETA + V] = slopes.by_pinion * on_pinion - slopes.by_both * on_gear
        store[start + _BETA + W] = slopes.by_both * on_pinion - slopes.by_gear * on_gear
        store[start + _GAMMA + U] = -sign
        store[start + _GAMMA + PHASE] = sign * noted.relief / m.scene.phase_rate


@compiled(makes_arrays=True)
def _assemble_pair(m: Model, history: int, length: float, store: Floats) -> int:
    """Fill a pair's block but for beta and gamma, which are set to zero; its offset."""
    n = m.scene.nodes
    size = _RHO + 2 * n + n * n
    start = _FIRST + size * history
    store[start : start + _RHO] = 0.0
    store[start] = 1.0
    weights = node_weights(m)
    rho = store[start + _RHO : start + _RHO + n]
    c = store[start + _RHO + n : start + _RHO + 2 * n]
    block = store[start + _RHO + 2 * n : start + size].reshape(n, n)  # column by column
    slopes, kappa = np.empty((n, n)), np.empty((n, n))
    stiffness_matrix(m, history, slopes)
    influence(m, length, kappa)
    rho[:] = c[:] = block[:] = 0.0
    for j in range(n):
        for k in range(n):
            slope = slopes[k, j]
            if slope != 0.0:
                rho[j] += length * weights[k] * slope
                for i in range(n):
                    block[j, i] -= kappa[k, i] * slope
        for i in range(n):
            c[i] -= block[j, i]
        block[j, j] += 1.0
    return start


@compiled(makes_arrays=True)
def _invert(a: Floats) -> float:
    """Invert a matrix in place by Gauss-Jordan elimination with pivots; the sign of its determinant, 0 if singular."""
    n = a.shape[0]
    swaps = np.empty(n, np.int64)
    sign = 1.0
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[pivot, k]):
                pivot = i
        swaps[k] = pivot
        if pivot != k:
            sign = -sign
            for j in range(n):
                a[k, j], a[pivot, j] = a[pivot, j], a[k, j]
        value = a[k, k]
        if value == 0.0 or not np.isfinite(value):
            return 0.0
        if value < 0.0:
            sign = -sign
        a[k, k] = 1.0
        inverse = 1.0 / value
        for j in range(n):
            a[k, j] *= inverse
        for i in range(n):
            if i != k:
                factor = a[i, k]
                if factor != 0.0:
                    a[i, k] = 0.0
                    for j in range(n):
                        a[i, j] -= factor * a[k, j]
    for k in range(n - 1, -1, -1):
        if swaps[k] != k:
            for i in range(n):
                a[i, k], a[i, swaps[k]] = a[i, swaps[k]], a[i, k]
    return sign


@compiled(makes_arrays=True)
def factorise(store: Floats) -> int:
    """Turn an assembled Jacobian into what `solve_blocks` wants, in place.

    Returns
    -------
    int
        0 if all went well; 1 where a pair's D has a determinant that is not positive: the contact lies beyond a fold
        of its static curve.
    """
    n = int(store[_NODES])
    size = _RHO + 2 * n + n * n
    small = store[_SMALL : _SMALL + MOTION * MOTION].reshape(MOTION, MOTION)
    work = np.empty(n)
    for number in range(int(store[_BLOCKS])):
        start = _FIRST + size * number
        if store[start] == 0.0:
            continue
        rho = store[start + _RHO : start + _RHO + n]
        c = store[start + _RHO + n : start + _RHO + 2 * n]
        block = store[start + _RHO + 2 * n : start + size].reshape(n, n)
        if _invert(block) <= 0.0:
            return 1
        moved = 0.0
        for k in range(n):  # rho times the inverse; the block's rows are columns
            total = 0.0
            for i in range(n):
                total += rho[i] * block[k, i]
            work[k] = total
            moved += total * c[k]
        rho[:] = work
        work[:] = 0.0
        for k in range(n):
            for i in range(n):
                work[i] += block[k, i] * c[k]
        c[:] = work
        for i in range(MOTION):
            for j in range(MOTION):
                small[i, j] += store[start + _BETA + i] * moved * store[start + _GAMMA + j]
    return 0 if _invert(small) != 0.0 else 1


@compiled(makes_arrays=True)
def solve_blocks(store: Floats, b: Floats, x: Floats) -> None:
    """Solve Newton's equations.

    Parameters
    ----------
    store : ndarray
        From `factorise`.
    b, x : ndarray
        Right-hand side and solution; may be the same array.
    """
    n = int(store[_NODES])
    size = _RHO + 2 * n + n * n
    blocks = int(store[_BLOCKS])
    right = np.empty(MOTION)
    for i in range(MOTION):
        right[i] = b[i]
    for number in range(blocks):
        start = _FIRST + size * number
        if store[start] != 0.0:
            force = 0.0
            for i in range(n):
                force += store[start + _RHO + i] * b[MOTION + n * number + i]
            for i in range(MOTION):
                right[i] -= store[start + _BETA + i] * force
    for i in range(MOTION):
        total = 0.0
        for j in range(MOTION):
            total += store[_SMALL + MOTION * i + j] * right[j]
        x[i] = total
    work = np.empty(n)
    for number in range(blocks):
        start, first = _FIRST + size * number, MOTION + n * number
        if store[start] == 0.0:
            for i in range(n):
                x[first + i] = b[first + i]
            continue
        gap = 0.0
        for i in range(MOTION):
            gap += store[start + _GAMMA + i] * x[i]
        block = store[start + _RHO + 2 * n : start + size].reshape(n, n)
        for i in range(n):
            work[i] = store[start + _RHO + n + i] * gap
        for k in range(n):
            value = b[first + k]
            for i in range(n):
                work[i] += block[k, i] * value
        for i in range(n):
            x[first + i] = work[i]


@compiled
def dense_jacobian(m: Model, t: float, cj: float, y: Floats, store: Floats, out: Floats) -> None:
    """Jacobian of the residual as a full matrix, row by row, for solvers without blocks; `store` is overwritten."""
    assemble(m, t, cj, y, store)
    n = int(store[_NODES])
    size = _RHO + 2 * n + n * n
    out[:] = 0.0
    for i in range(MOTION):
        for j in range(MOTION):
            out[i, j] = store[_SMALL + MOTION * i + j]
    for number in range(int(store[_BLOCKS])):
        start, first = _FIRST + size * number, MOTION + n * number
        for i in range(n):
            out[first + i, first + i] = 1.0
            if store[start] == 0.0:
                continue
            for j in range(MOTION):
                out[j, first + i] = store[start + _BETA + j] * store[start + _RHO + i]
                out[first + i, j] = -store[start + _RHO + n + i] * store[start + _GAMMA + j]
            for k in range(n):
                out[first + i, first + k] = store[start + _RHO + 2 * n + n * k + i]
