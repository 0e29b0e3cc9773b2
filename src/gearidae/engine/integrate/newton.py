"""Newton's iteration for a motion of few unknowns, in the place of SUNDIALS' own.

SUNDIALS iterates with an old Jacobian, through a dozen vector operations a correction. A motion's forces come with
their slopes at no great cost, and its equations are solved in a few operations
(`gearidae.engine.integrate.correction`), so that
every correction here uses the Jacobian at the current iterate: the remaining error is of second order, and one
correction is mostly enough.

The remaining error is estimated from the last second correction. The estimate grows with every step until another
second correction is needed, which renews it. The iteration stops at a smaller error than IDA's own third of a
tolerance: the remaining error is no smooth function of time, and it disturbs the differences that choose step and
order.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from gearidae.compiled import compiled
from gearidae.engine import adams
from gearidae.engine.events.law_switches import misses_laws
from gearidae.engine.integrate.correction import correct
from gearidae.engine.integrate.step_control import below_gap_bound, control_step, max_stable_order
from gearidae.engine.model.state import Floats, Model

MOST: Final = 4  # corrections
SLOWEST: Final = 0.9  # a correction this large, over the last, is called divergence
NOTHING: Final = 1e-9  # a correction this small, over the tolerance, needs no second
SHARE: Final = 0.1  # of what IDA would leave
GROWTH: Final = 1.1  # of the estimate of what is left, per step
LEAST: Final = 1e-4  # of that estimate
FAILED: Final = 902  # what SUNDIALS answers with shorter steps


class Attempt(NamedTuple):
    """A step that IDA tries, as it lets a nonlinear solver see it.

    Attributes
    ----------
    t, step : float
        End and length of the step, over tau. The length is no difference of times, which rounding would spoil.
    cj : float
        IDA's leading coefficient.
    tolerance : float
        Of Newton's iteration.
    predicted, rates : ndarray, shape (n,)
        The state to start from and IDA's rates for it.
    correction, y, yp : ndarray, shape (n,)
        The sum of all corrections, zero at first, and state and rates with it.
    delta : ndarray, shape (n,)
        Work space.
    weights : ndarray, shape (n,)
        Of the norm; replaced by those with which IDA tests the step, see `gearidae.engine.integrate.step_control`.
    """

    t: float
    step: float
    cj: float
    tolerance: float
    predicted: Floats
    rates: Floats
    correction: Floats
    y: Floats
    yp: Floats
    delta: Floats
    weights: Floats


@compiled(inline=True)
def iterate(n: int, m: Model, attempt: Attempt) -> int:
    """Correct a prediction until what is left is far below the tolerance.

    Parameters
    ----------
    n : int
        Unknowns.

    Returns
    -------
    int
        0, or a return code for SUNDIALS.
    """
    a, cj, correction, predicted = m.work.adams, attempt.cj, attempt.correction, attempt.predicted
    by_adams = a.used != 0
    if by_adams:
        first = m.scene.error_weights_at
        for j in range(n):  # an attempt that has failed has left others
            attempt.weights[j] = m.rows[first + j]
        cj = adams.rates_at_end(n, a, attempt.step, max_stable_order(a, attempt.step), predicted, correction)
    else:
        a.order_used = 0
        a.attempts += 1
        for j in range(n):
            a.predicted_rates[j] = attempt.rates[j]
    a.new_step = attempt.step
    a.contraction_rate *= GROWTH
    last = math.inf
    m.work.not_converged = 0
    for _ in range(MOST):
        norm = _correct(n, m, attempt, cj)
        if m.work.not_converged != 0:
            break
        if last < math.inf:
            if norm > SLOWEST * last:
                break
            a.contraction_rate = max(norm / last, LEAST)
        converged = a.contraction_rate * norm <= SHARE * attempt.tolerance
        if norm <= NOTHING * attempt.tolerance or converged:
            for j in range(n):
                a.new_state[j] = predicted[j] + correction[j]
                a.new_differences[0, j] = cj * correction[j] + a.predicted_rates[j]
            if below_gap_bound(m, a) or (m.scene.law_watched != 0 and misses_laws(m, attempt.step)):
                return FAILED
            if by_adams:
                control_step(n, m, attempt.step, correction, attempt.weights)
            return 0
        last = norm
    a.failures += 1
    a.contraction_rate = 1.0
    return FAILED


@compiled(inline=True)
def _correct(n: int, m: Model, attempt: Attempt, cj: float) -> float:
    """Make one correction; its norm."""
    a = m.work.adams
    for j in range(n):
        attempt.y[j] = attempt.predicted[j] + attempt.correction[j]
        attempt.yp[j] = cj * attempt.correction[j] + a.predicted_rates[j]
    a.omega_sq = correct(m, attempt.t, cj, attempt.y, attempt.yp, attempt.delta)
    a.evaluations += 1
    for j in range(n):
        attempt.correction[j] += attempt.delta[j]
    return math.sqrt(adams.weighed_squares(n, attempt.delta, attempt.weights) / n)
