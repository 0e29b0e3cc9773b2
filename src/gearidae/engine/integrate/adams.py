r"""Adams' formulas in the place of IDA's own, for a motion without stiffness.

Between impacts a contact vibrates with hardly any damping. There the errors of IDA's backward differentiation
formulas add up over a run to hundreds of tolerances, and their order ends at five. IDA steps, tests and stops as ever;
only the rates with which the residual has to vanish at a step's end are other ones. With the last k rates known, the
formula of Adams and Moulton (Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, III.1 and III.5)

.. math::

    y_n = y_{n-1} + \int_{t_{n-1}}^{t_n} P(t)\,dt, \qquad P(t_m) = y'_m, \quad m = n-k \ldots n,

has order k + 1. Solved for the new rates it reads :math:`y'_n = c_j\,(y_n - y^*) + y'^*`, as IDA's formulas do, with

.. math::

    c_j = N_k(t_n) \Big/ \int_{t_{n-1}}^{t_n} N_k\,dt, \qquad N_i(t) = \prod_{m=1}^{i} (t - t_{n-m}),

and y* and y'* the integral and the value of the polynomial through the known rates, which also are where Newton's
iteration begins. P also is the state between the steps: samples and roots are as accurate as the steps.

How far a formula looks back, and how long its steps are, is for `gearidae.engine.integrate.step_control`. All is
kept on a desk of
numbers, which SUNDIALS carries as the nonlinear solver's content.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled

__all__ = [
    "ADAMS",
    "BACK",
    "DEEPEST",
    "DESK",
    "EVALUATIONS",
    "FAILURES",
    "FASTEST",
    "GAIN",
    "HELD",
    "KNOWN",
    "LAST_STEP",
    "NEW_RATES",
    "NEW_STATE",
    "NEW_STEP",
    "OWN",
    "PREDICTED_RATES",
    "SINCE",
    "SWING",
    "USED",
    "WANTED",
    "begin",
    "between",
    "keep",
    "rates_at_end",
    "set_differences",
    "spread",
    "squares",
]

Floats = NDArray[np.float64]

DEEPEST: Final = 8  # rates that a formula looks back on, at most: with more, only short steps are stable
WIDTH: Final = 4  # states, at most

OWN: Final = 0  # 1 where Newton's iteration is ours
EVALUATIONS: Final = 1  # of the residual with its slopes, so far
FAILURES: Final = 2  # of Newton's iteration, so far
GAIN: Final = 3  # what is left to correct after a correction, over the correction
FASTEST: Final = 4  # squared frequency of the motion, from the last evaluation
WANTED: Final = 5  # 1 where Adams' formulas are to be used from the next start on
ADAMS: Final = 6  # 1 where they are
SINCE: Final = 7  # steps tried since the start
HELD: Final = 8  # of them in succession shorter than they need be for the error
BACK: Final = 9  # rates to look back on in the coming step
KNOWN: Final = 10  # rates known
USED: Final = 11  # of them by the last formula; 0 if it was IDA's
NOW: Final = 12  # the last accepted time, and the step up to it
LAST_STEP: Final = 13
NEW_STEP: Final = 14  # length of the step that is tried; 0 once it has been accepted
SWING: Final = 15  # squared speed of the vibration over the tolerance, and what its acceleration makes of it
NEW_STATE: Final = 16
PREDICTED_RATES: Final = NEW_STATE + WIDTH
STATE: Final = PREDICTED_RATES + WIDTH  # at the last accepted time
AGO: Final = STATE + WIDTH  # how long before it the others were, the last first
AREA: Final = AGO + DEEPEST + 1  # of Newton's polynomials over these times
VALUE: Final = AREA + DEEPEST + 1
TABLE: Final = VALUE + DEEPEST + 1  # divided differences of the rates, a row for each order
NEW_TABLE: Final = TABLE + WIDTH * (DEEPEST + 1)  # with those at the end of the step that is tried
NEW_RATES: Final = NEW_TABLE
DESK: Final = NEW_TABLE + WIDTH * (DEEPEST + 1)

_points, _weights = np.polynomial.legendre.leggauss(5)  # exact for the polynomials of degree nine
_X0, _X1, _X2, _X3, _X4 = (0.5 + 0.5 * float(x) for x in _points)
_W0, _W1, _W2, _W3, _W4 = (0.5 * float(w) for w in _weights)


@compiled
def begin(desk: Floats, t: float, y: Floats, yp: Floats) -> None:
    """Begin at a time where only the rates there are known, and nothing of Newton's iteration."""
    desk[GAIN], desk[FASTEST] = 1.0, 0.0
    desk[ADAMS], desk[SINCE], desk[HELD] = desk[WANTED], 0.0, 0.0
    desk[BACK], desk[KNOWN], desk[USED], desk[SWING] = 1.0, 1.0, 0.0, np.inf
    desk[NOW], desk[NEW_STEP], desk[AGO] = t, 0.0, 0.0
    for j in range(y.size):
        desk[STATE + j], desk[TABLE + j] = y[j], yp[j]


@compiled(inline=True)
def keep(desk: Floats, t: float, yp: Floats) -> None:
    """Take note of a step up to t, if one has been accepted, and set `yp` to the rates there."""
    step = desk[NEW_STEP]
    if step == 0.0:
        return
    desk[NOW], desk[LAST_STEP], desk[NEW_STEP] = t, step, 0.0
    for j in range(WIDTH):
        desk[STATE + j] = desk[NEW_STATE + j]
    for j in range(yp.size):
        yp[j] = desk[NEW_RATES + j]
    if desk[ADAMS] == 0.0:
        return
    last = _last_row(desk)
    for i in range(WIDTH * (last + 1)):
        desk[TABLE + i] = desk[NEW_TABLE + i]
    for i in range(last, 0, -1):
        desk[AGO + i] = desk[AGO + i - 1] + step
    desk[KNOWN] = last + 1


@compiled(inline=True)
def _last_row(desk: Floats) -> int:
    """Return the order of the last difference that a step has a use for: its formula's, and one to compare it with."""
    return min(int(desk[KNOWN]), int(desk[USED]) + 1, DEEPEST)


@compiled(inline=True)
def _set_polynomials(desk: Floats, h: float, last: int) -> None:
    """Set Newton's polynomials N_0 ... N_last at h, and integrated from 0 to h."""
    x0, x1, x2, x3, x4 = _X0 * h, _X1 * h, _X2 * h, _X3 * h, _X4 * h
    p0, p1, p2, p3, p4, value = _W0 * h, _W1 * h, _W2 * h, _W3 * h, _W4 * h, 1.0
    for i in range(last):
        desk[AREA + i], desk[VALUE + i] = (p0 + p1) + (p2 + p3) + p4, value
        ago = desk[AGO + i]
        p0 *= x0 + ago
        p1 *= x1 + ago
        p2 *= x2 + ago
        p3 *= x3 + ago
        p4 *= x4 + ago
        value *= h + ago
    desk[AREA + last], desk[VALUE + last] = (p0 + p1) + (p2 + p3) + p4, value


@compiled(inline=True)
def _sums(desk: Floats, polynomials: int, count: int) -> tuple[float, float, float, float]:
    """Sums over the first differences, times the polynomials that lie there on the desk: one for each state."""
    s0, s1, s2, s3 = 0.0, 0.0, 0.0, 0.0
    for i in range(count):
        row, factor = TABLE + WIDTH * i, desk[polynomials + i]
        s0 += desk[row] * factor
        s1 += desk[row + 1] * factor
        s2 += desk[row + 2] * factor
        s3 += desk[row + 3] * factor
    return s0, s1, s2, s3


@compiled(inline=True)
def rates_at_end(n: int, desk: Floats, h: float, back: int, predicted: Floats, correction: Floats) -> float:
    """Write the rates that the formula wants at IDA's prediction, and how far this is from its own.

    Parameters
    ----------
    n : int
        States.
    desk : ndarray, shape (DESK,)
    h : float
        Length of the step, over tau.
    back : int
        Rates to look back on, if so many are known.
    predicted : ndarray, shape (n,)
    correction : ndarray, shape (n,)
        Set to what leads from IDA's prediction to that by the known rates.

    Returns
    -------
    float
        What the rates change by, with the state.
    """
    count = min(int(desk[KNOWN]), back)
    desk[USED] = count
    _set_polynomials(desk, h, _last_row(desk))
    cj = desk[VALUE + count] / desk[AREA + count]
    changes, rates = _sums(desk, AREA, count), _sums(desk, VALUE, count)
    for j in range(n):
        correction[j] = desk[STATE + j] + changes[j] - predicted[j]
        desk[PREDICTED_RATES + j] = rates[j] - cj * correction[j]
    return float(cj)


@compiled(inline=True)
def set_differences(desk: Floats, h: float) -> None:
    """Set the divided differences with the rates at the end of a step of length h."""
    for i in range(_last_row(desk)):
        share = 1.0 / (h + desk[AGO + i])
        row = WIDTH * i
        for j in range(WIDTH):
            desk[NEW_TABLE + row + WIDTH + j] = (desk[NEW_TABLE + row + j] - desk[TABLE + row + j]) * share


@compiled(inline=True)
def squares(n: int, numbers: Floats, first: int, weights: Floats) -> float:
    """Sum of the squares of n weighed numbers, from a place on."""
    total = 0.0
    for j in range(n):
        weighed = numbers[first + j] * weights[j]
        total += weighed * weighed
    return total


@compiled(inline=True)
def spread(n: int, desk: Floats, h: float, back: int, weights: Floats) -> float:
    r"""Squared distance of the new state, over the tolerance, from that by a formula looking back on one rate less.

    Both polynomials go through the same last rates; they differ by the difference of order `back`, times
    :math:`\int (t - t_n) N_{back-1}\,dt`.
    """
    area = desk[AREA + back] - (h + desk[AGO + back - 1]) * desk[AREA + back - 1]
    return area * area * squares(n, desk, NEW_TABLE + WIDTH * back, weights) / n


@compiled
def between(desk: Floats, t: float, y: Floats, yp: Floats) -> None:
    """State and rates at a time within the last step, of which `keep` has taken note."""
    count = int(desk[USED]) + 1
    _set_polynomials(desk, t - desk[NOW], count - 1)
    changes, rates = _sums(desk, AREA, count), _sums(desk, VALUE, count)
    for j in range(y.size):
        y[j], yp[j] = desk[STATE + j] + changes[j], rates[j]
