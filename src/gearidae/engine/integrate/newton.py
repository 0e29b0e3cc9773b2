"""Newton's iteration for a motion of few unknowns, in the place of SUNDIALS' own.

SUNDIALS iterates with an old Jacobian, through a dozen vector operations a correction. A motion's forces come with
their slopes at no great cost, and its equations are solved in a few operations
(`gearidae.engine.integrate.correction`), so that
every correction here is made with the Jacobian of where it is: what it leaves is of second order, and one is mostly
enough.

How much is left is known from the last time that a second correction was made. The estimate grows with every step
until it says that another one is needed, and so is renewed. The iteration is carried further than IDA's own third of a
tolerance: what it leaves is no smooth function of time, and steps and orders are chosen by differences that show it.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine.integrate import adams
from gearidae.engine.integrate.correction import correct
from gearidae.engine.integrate.step_control import furthest_back, overshoots, set_pace
from gearidae.engine.model import layout as at
from gearidae.engine.sundials import memory as ptr
from gearidae.engine.sundials import names as sun

__all__ = ["iterate", "make_solver"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MOST: Final = 4  # corrections
SLOWEST: Final = 0.9  # a correction this large, over the last, is called divergence
NOTHING: Final = 1e-9  # a correction this small, over the tolerance, needs no second
SHARE: Final = 0.1  # of what IDA would leave
GROWTH: Final = 1.1  # of the estimate of what is left, per step
LEAST: Final = 1e-4  # of that estimate
FAILED: Final = 902  # what SUNDIALS answers with shorter steps


@compiled
def make_solver(context: int, desk: Floats, where: Ints, functions: Ints) -> int:
    """Make a nonlinear solver of SUNDIALS that iterates here.

    Parameters
    ----------
    context : int
        SUNDIALS' context.
    desk : ndarray, shape (DESK,)
        See `gearidae.engine.integrate.adams`; must outlive the solver.
    where : ndarray of int64, shape (5,)
        From `gearidae.engine.sundials.names.newton_places`.
    functions : ndarray of int64, shape (3,)
        Addresses of the functions that answer for the type, iterate, and are told of the equations.
    """
    record = sun.SUNNonlinSolNewEmpty(context)
    fields = ptr.words(record)
    fields[where[0]] = desk.ctypes.data
    ptr.replace(record, where[1:], functions)
    return record


@compiled(inline=True)
def iterate(
    n: int,
    desk: Floats,
    d: Floats,
    t: float,
    step: float,
    cj: float,
    predicted: Floats,
    rates: Floats,
    correction: Floats,
    y: Floats,
    yp: Floats,
    delta: Floats,
    weights: Floats,
    tolerance: float,
) -> int:
    """Correct a prediction until what is left is far below the tolerance.

    Parameters
    ----------
    n : int
        Unknowns.
    desk : ndarray, shape (DESK,)
        See `gearidae.engine.integrate.adams`.
    d : ndarray
        The scene, see `layout`.
    t, step : float
        End and length of the step, over tau. The length is no difference of times, which rounding would spoil.
    cj, predicted, rates : float, ndarray of shape (n,)
        IDA's leading coefficient, the state to start from and IDA's rates for it.
    correction, y, yp : ndarray, shape (n,)
        The sum of all corrections, zero at first, and state and rates with it.
    delta : ndarray, shape (n,)
        Work space.
    weights : ndarray, shape (n,)
        Of the norm; set to those by which IDA is to judge the step, see `gearidae.engine.integrate.step_control`.
    tolerance : float

    Returns
    -------
    int
        0, or what SUNDIALS has to be told.
    """
    by_adams = desk[adams.ADAMS] != 0.0
    if by_adams:
        first = int(d[at.WEIGHTS_AT])
        for j in range(n):  # an attempt that has failed has left others
            weights[j] = d[first + j]
        cj = adams.rates_at_end(n, desk, step, furthest_back(desk, step), predicted, correction)
    else:
        desk[adams.USED] = 0.0
        desk[adams.SINCE] += 1.0
        for j in range(n):
            desk[adams.PREDICTED_RATES + j] = rates[j]
    desk[adams.NEW_STEP] = step
    desk[adams.GAIN] *= GROWTH
    last = math.inf
    for _ in range(MOST):
        for j in range(n):
            y[j] = predicted[j] + correction[j]
            yp[j] = cj * correction[j] + desk[adams.PREDICTED_RATES + j]
        desk[adams.FASTEST] = correct(d, t, cj, y, yp, delta)
        desk[adams.EVALUATIONS] += 1.0
        for j in range(n):
            correction[j] += delta[j]
        norm = math.sqrt(adams.squares(n, delta, 0, weights) / n)
        if last < math.inf:
            if norm > SLOWEST * last:
                break
            desk[adams.GAIN] = max(norm / last, LEAST)
        if norm <= NOTHING * tolerance or desk[adams.GAIN] * norm <= SHARE * tolerance:
            for j in range(n):
                desk[adams.NEW_STATE + j] = predicted[j] + correction[j]
                desk[adams.NEW_RATES + j] = cj * correction[j] + desk[adams.PREDICTED_RATES + j]
            if overshoots(d, desk):
                return FAILED
            if by_adams:
                set_pace(n, desk, d, step, correction, weights)
            return 0
        last = norm
    desk[adams.FAILURES] += 1.0
    desk[adams.GAIN] = 1.0
    return FAILED
