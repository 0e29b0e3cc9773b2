"""Newton's iteration for a motion of few unknowns, in the place of SUNDIALS' own.

SUNDIALS iterates through a dozen vector operations, each a call or two, over vectors of four numbers. Here they are
one function: the same corrections, the same test of convergence (Hindmarsh et al. 2005,
doi:10.1145/1089014.1089020, and the IDA guide), in the same order of operations, so that both take the same steps to
the last bit.

What the iteration has to remember from step to step lies on a desk of 64-bit cells, which SUNDIALS keeps as the
solver's content: some of them whole numbers and addresses, the others real numbers.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine import pointers as ptr
from gearidae.engine import small
from gearidae.engine import sundials as sun
from gearidae.engine.residual import residual

__all__ = ["DESK", "EVALUATIONS", "FAILURES", "STORE", "iterate", "keep_set_up", "make_solver"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SET_UP: Final = 0  # address of the linear solver's set-up
STORE: Final = 1  # address of the factorised Jacobian
EVALUATIONS: Final = 2  # of the residual, so far
FAILURES: Final = 3  # to converge, so far
NEW: Final = 4  # where the set-up says that the Jacobian is new
LAST_CJ: Final = 5  # leading coefficient of the last iteration
SET_UP_CJ: Final = 6  # that of the last set-up
GAIN: Final = 7  # what is left to correct, over the last correction: an estimate from the rate of convergence
DESK: Final = 8

MOST: Final = 4  # corrections
SLOWEST: Final = 0.9  # rate of convergence that is called divergence
AT_ONCE: Final = 1e-4 * 1e-4  # a first correction this small, over the tolerance, needs no second
GAIN_NEW_CJ, GAIN_SET_UP = 100.0, 20.0
FAILED: Final = 902  # what SUNDIALS answers with shorter steps


@compiled
def make_solver(context: int, desk: Ints, where: Ints, functions: Ints) -> int:
    """Make a nonlinear solver of SUNDIALS that iterates here.

    Parameters
    ----------
    context : int
        SUNDIALS' context.
    desk : ndarray of int64, shape (DESK,)
        Must outlive the solver.
    where : ndarray of int64, shape (6,)
        From `gearidae.engine.sundials.newton_places`.
    functions : ndarray of int64, shape (4,)
        Addresses of the functions that answer for the type, iterate, and are told of the equations and of the set-up.
    """
    record = sun.SUNNonlinSolNewEmpty(context)
    fields = ptr.words(record)
    fields[where[0]] = desk.ctypes.data
    ptr.replace(record, where[1:], functions)
    return record


@compiled
def keep_set_up(solver: int, content: int, function: int) -> None:
    """Note where the linear solver's set-up is, in a solver that has its content at `content`."""
    ptr.words(ptr.words(solver)[content])[SET_UP] = function


@compiled(inline=True)
def iterate(
    n: int,
    desk: Ints,
    state: Floats,
    store: Floats,
    d: Floats,
    t: float,
    cj: float,
    predicted: Floats,
    predicted_rates: Floats,
    correction: Floats,
    y: Floats,
    yp: Floats,
    delta: Floats,
    weights: Floats,
    tolerance: float,
    renew: bool,
    solver: int,
) -> int:
    """Correct a prediction until what is left is below the tolerance.

    Parameters
    ----------
    n : int
        Unknowns.
    desk, state : ndarray
        The desk as whole and as real numbers.
    store : ndarray, shape (n (n + 1),)
        The Jacobian as `gearidae.engine.small.factorise` has left it.
    d : ndarray
        The scene, see `layout`.
    t, cj : float
        Time over tau, and IDA's leading coefficient.
    predicted, predicted_rates : ndarray, shape (n,)
        State and rates to start from.
    correction, y, yp : ndarray, shape (n,)
        The sum of all corrections, zero at first, and state and rates with it.
    delta, weights : ndarray, shape (n,)
        Work space, and the weights of the norm.
    tolerance : float
    renew : bool
        Whether the Jacobian has to be worked out anew.
    solver : int
        Address of IDA.

    Returns
    -------
    int
        0, or what SUNDIALS has to be told.
    """
    if cj != state[LAST_CJ]:
        state[GAIN] = GAIN_NEW_CJ
    state[LAST_CJ] = cj
    bad = 0
    while True:
        last = 0.0
        for m in range(MOST):
            for i in range(n):
                y[i] = predicted[i] + correction[i]
                yp[i] = cj * correction[i] + predicted_rates[i]
            residual(d, t, y, yp, delta)
            desk[EVALUATIONS] += 1
            if m == 0 and renew:
                flag = ptr.set_up(desk[SET_UP], bad, desk[NEW:].ctypes.data, solver)
                state[SET_UP_CJ], state[GAIN] = cj, GAIN_SET_UP
                if flag != 0:
                    return flag
            ratio = cj / state[SET_UP_CJ]
            for i in range(n):
                delta[i] = -delta[i]
            small.solve(n, store, delta, delta)
            total = 0.0
            for i in range(n):
                if ratio != 1.0:  # the Jacobian is that of another leading coefficient
                    delta[i] *= 2.0 / (1.0 + ratio)
                correction[i] += delta[i]
                weighed = delta[i] * weights[i]
                total += weighed * weighed
            norm = math.sqrt(total / n)
            if m == 0:
                if norm <= AT_ONCE * tolerance:
                    return 0
            else:
                rate = (norm / last) ** (1.0 / m) if norm > 0.0 else 0.0
                if rate > SLOWEST:
                    break
                state[GAIN] = rate / (1.0 - rate)
            if state[GAIN] * norm <= tolerance:
                return 0
            if m == 0:
                last = norm
        desk[FAILURES] += 1
        if renew:
            return FAILED
        renew, bad = True, 1
        for i in range(n):
            correction[i] = 0.0
