r"""Adams' formulas in the place of IDA's own, for a motion without stiffness.

Between impacts a contact vibrates with hardly any damping. There the errors of IDA's backward differentiation
formulas add up over a run to hundreds of tolerances. Here IDA predicts, chooses steps and orders and tests errors as
ever; only the rates with which the residual has to vanish at a step's end are other ones. With the last k rates
known, the formula of Adams and Moulton (Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, III.1
and III.5)

.. math::

    y_n = y_{n-1} + \int_{t_{n-1}}^{t_n} P(t)\,dt, \qquad P(t_m) = y'_m, \quad m = n-k \ldots n,

has order k + 1, one more than IDA's of the same order k, and an error constant many times smaller. Solved for the new
rates it reads :math:`y'_n = c_j\,(y_n - y^*) + y'^*`, as IDA's formulas do, with

.. math::

    c_j = N_k(t_n) \Big/ \int_{t_{n-1}}^{t_n} N_k\,dt, \qquad N_i(t) = \prod_{m=1}^{i} (t - t_{n-m}),

and y* and y'* the integral and the value of the polynomial through the known rates. P also is the state between the
steps: samples and roots are as accurate as the steps.

Three things the formulas cannot do, and there IDA's are kept: steps that are long against the vibration, for which
they are not stable; tolerances so close to rounding that the difference of two states, which IDA's do not take, shows
it; and coming to rest. They damp nothing, so that a contact whose vibration is down to the tolerance would tremble on
for ever, each swing turning its histories, where IDA's formulas damp it away.

All is kept on a desk of numbers, which SUNDIALS carries as the nonlinear solver's content.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine import layout as at

__all__ = [
    "DESK",
    "EVALUATIONS",
    "FAILURES",
    "FASTEST",
    "GAIN",
    "LONGER",
    "NEW_RATES",
    "NEW_STATE",
    "NEW_STEP",
    "OWN",
    "PREDICTED_RATES",
    "USED",
    "begin",
    "between",
    "keep",
    "rates_at_end",
    "reaches",
]

Floats = NDArray[np.float64]

HIGHEST: Final = 5  # rates that a formula looks back on: IDA's highest order
WIDTH: Final = 4  # states, at most

OWN: Final = 0  # 1 where Newton's iteration is ours
EVALUATIONS: Final = 1  # of the residual with its slopes, so far
FAILURES: Final = 2  # of Newton's iteration, so far
GAIN: Final = 3  # what is left to correct after a correction, over the correction
FASTEST: Final = 4  # squared frequency of the motion, from the last evaluation
KNOWN: Final = 5  # rates known
USED: Final = 6  # of them by the last formula; 0 if it was IDA's
NOW: Final = 7  # the last accepted time
NEW_STEP: Final = 8  # length of the step that is tried; 0 once it has been accepted
LONGER: Final = 9  # 1 where IDA has been told to let steps grow sooner
NEW_STATE: Final = 10
NEW_RATES: Final = NEW_STATE + WIDTH
PREDICTED_RATES: Final = NEW_RATES + WIDTH
STATE: Final = PREDICTED_RATES + WIDTH  # at the last accepted time
AGO: Final = STATE + WIDTH  # how long before it the others were, the last first
AREA: Final = AGO + HIGHEST + 1  # of Newton's polynomials over these times
VALUE: Final = AREA + HIGHEST + 1
TABLE: Final = VALUE + HIGHEST + 1  # divided differences of the rates, a row for each order
DESK: Final = TABLE + WIDTH * (HIGHEST + 1)

# Where Adams' formulas are used: below, above, below.
LONGEST: Final = 0.25  # squared step times squared frequency
QUIET: Final = 30.0  # speed of the vibration, or what its acceleration makes of it, over the tolerance
COARSEST: Final = 0.2 / float(np.finfo(float).eps)  # a state over its tolerance

_points, _weights = np.polynomial.legendre.leggauss(3)  # exact for the polynomials of degree five
_X0, _X1, _X2 = (0.5 + 0.5 * float(x) for x in _points)
_W0, _W1, _W2 = (0.5 * float(w) for w in _weights)


@compiled
def begin(desk: Floats, t: float, y: Floats, yp: Floats) -> None:
    """Begin at a time where only the rates there are known, and nothing of Newton's iteration."""
    desk[GAIN], desk[FASTEST] = 1.0, 0.0
    desk[KNOWN], desk[USED] = 1.0, 0.0
    desk[NOW], desk[NEW_STEP], desk[AGO] = t, 0.0, 0.0
    for j in range(y.size):
        desk[STATE + j], desk[TABLE + j] = y[j], yp[j]


@compiled(inline=True)
def keep(desk: Floats, t: float, yp: Floats) -> None:
    """Take note of a step up to t, if one has been accepted, and set `yp` to the rates there."""
    step = desk[NEW_STEP]
    if step == 0.0:
        return
    desk[NOW], desk[NEW_STEP] = t, 0.0
    known = min(int(desk[KNOWN]), HIGHEST)
    for j in range(WIDTH):
        desk[STATE + j] = desk[NEW_STATE + j]
    for j in range(yp.size):
        yp[j] = desk[NEW_RATES + j]
    for i in range(known):
        share = 1.0 / (step + desk[AGO + i])
        row = TABLE + WIDTH * i
        for j in range(WIDTH):
            older = desk[row + j]
            desk[row + j] = desk[NEW_RATES + j]
            desk[NEW_RATES + j] = (desk[NEW_RATES + j] - older) * share
    for j in range(WIDTH):
        desk[TABLE + WIDTH * known + j] = desk[NEW_RATES + j]
    for i in range(known, 0, -1):
        desk[AGO + i] = desk[AGO + i - 1] + step
    desk[KNOWN] = known + 1


@compiled(inline=True)
def _polynomials(desk: Floats, h: float, count: int) -> tuple[float, float]:
    """Newton's polynomials N_0 ... N_(count - 1) at h and integrated from 0 to h; those of N_count are returned."""
    x0, x1, x2 = _X0 * h, _X1 * h, _X2 * h
    p0, p1, p2, value = _W0 * h, _W1 * h, _W2 * h, 1.0
    for i in range(count):
        desk[AREA + i], desk[VALUE + i] = p0 + p1 + p2, value
        ago = desk[AGO + i]
        p0 *= x0 + ago
        p1 *= x1 + ago
        p2 *= x2 + ago
        value *= h + ago
    return value, p0 + p1 + p2


@compiled(inline=True)
def _along(desk: Floats, j: int, count: int) -> tuple[float, float]:
    """A state and its rate by the polynomial through the last rates, where `_polynomials` has been asked for."""
    state, rate = desk[STATE + j], 0.0
    for i in range(count):
        difference = desk[TABLE + WIDTH * i + j]
        state += difference * desk[AREA + i]
        rate += difference * desk[VALUE + i]
    return state, rate


@compiled(inline=True)
def reaches(n: int, desk: Floats, h: float, predicted: Floats, rates: Floats, weights: Floats) -> bool:
    """Whether Adams' formulas are good for a step: neither too long, nor held to rounding, nor at rest."""
    if desk[FASTEST] > 0.0:
        swing = (predicted[at.V] ** 2 + rates[at.V] ** 2 / desk[FASTEST]) * weights[at.V] ** 2
        if swing < QUIET * QUIET:
            return False
    coarse = 0.0
    for j in range(n):
        coarse = max(coarse, abs(predicted[j]) * weights[j])
    return h * h * desk[FASTEST] <= LONGEST and coarse <= COARSEST


@compiled(inline=True)
def rates_at_end(n: int, desk: Floats, h: float, order: int, predicted: Floats) -> float:
    """Write the rates that the formula wants at a prediction.

    Parameters
    ----------
    n : int
        States.
    desk : ndarray, shape (DESK,)
    h : float
        Length of the step, over tau.
    order : int
        Rates to look back on, if so many are known.
    predicted : ndarray, shape (n,)

    Returns
    -------
    float
        What the rates change by, with the state.
    """
    count = min(int(desk[KNOWN]), order)
    desk[USED] = count
    value, area = _polynomials(desk, h, count)
    cj = value / area
    for j in range(n):
        state, rate = _along(desk, j, count)
        desk[PREDICTED_RATES + j] = rate + cj * (predicted[j] - state)
    return float(cj)


@compiled
def between(desk: Floats, t: float, y: Floats, yp: Floats) -> None:
    """State and rates at a time within the last step, of which `keep` has taken note."""
    count = min(int(desk[USED]) + 1, int(desk[KNOWN]))
    _polynomials(desk, t - desk[NOW], count)
    for j in range(y.size):
        y[j], yp[j] = _along(desk, j, count)
