r"""Adams' formulas in the place of IDA's own, for a motion without stiffness.

Between impacts a contact vibrates with hardly any damping. There the errors of IDA's backward differentiation
formulas add up over a run to hundreds of tolerances, and their order ends at five. IDA steps, tests and stops as ever;
only the rates with which the residual has to vanish at a step's end are other ones. With k former rates known, the
formula of Adams and Moulton (Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, III.1 and III.5)

.. math::

    y_n = y_{n-1} + \int_{t_{n-1}}^{t_n} P(t)\,dt, \qquad P(t_m) = y'_m, \quad m = n-k \ldots n,

has order k + 1. Solved for the new rates it reads :math:`y'_n = c_j\,(y_n - y^*) + y'^*`, as IDA's formulas do, with

.. math::

    c_j = N_k(t_n) \Big/ \int_{t_{n-1}}^{t_n} N_k\,dt, \qquad N_i(t) = \prod_{m=1}^{i} (t - t_{n-m}),

and y* and y'* the integral and the value of the polynomial through the known rates, which also are where Newton's
iteration begins. P also is the state between the steps: samples and roots are as accurate as the steps.

Order and step length are chosen in `gearidae.engine.integrate.step_control`. All state lives in one record, ``ADAMS``
of `gearidae.engine.model.state`; order k below means a formula with k former rates.
"""

from __future__ import annotations

import numpy as np

from gearidae.compiled import compiled
from gearidae.engine.model.state import MOST_ORDERS, MOTION, Floats, Record

_points, _weights = np.polynomial.legendre.leggauss(5)  # exact for the polynomials of degree nine
_X0, _X1, _X2, _X3, _X4 = (0.5 + 0.5 * float(x) for x in _points)
_W0, _W1, _W2, _W3, _W4 = (0.5 * float(w) for w in _weights)


@compiled
def begin(a: Record, t: float, y: Floats, yp: Floats) -> None:
    """Initialise the history at a time where only the rates there are known."""
    a.contraction_rate, a.omega_sq = 1.0, 0.0
    a.used, a.attempts, a.limited_steps = a.wanted, 0, 0
    a.next_order, a.n_history, a.order_used, a.amplitude_sq = 1, 1, 0, np.inf
    a.time, a.new_step, a.time_lags[0] = t, 0.0, 0.0
    for j in range(min(y.size, MOTION)):
        a.state[j], a.differences[0, j] = y[j], yp[j]


@compiled(inline=True)
def store_step(a: Record, t: float, yp: Floats) -> None:
    """Take note of a step up to t, if one has been accepted, and set `yp` to the rates there."""
    step = a.new_step
    if step == 0.0:
        return
    a.time, a.last_step, a.new_step = t, step, 0.0
    for j in range(MOTION):
        a.state[j] = a.new_state[j]
    for j in range(min(yp.size, MOTION)):
        yp[j] = a.new_differences[0, j]
    if a.used == 0:
        return
    last = _last_row(a)
    for i in range(last + 1):
        for j in range(MOTION):
            a.differences[i, j] = a.new_differences[i, j]
    for i in range(last, 0, -1):
        a.time_lags[i] = a.time_lags[i - 1] + step
    a.n_history = last + 1


@compiled(inline=True)
def _last_row(a: Record) -> int:
    """Return the order of the highest difference that a step needs: one above the order of its formula, if known."""
    return min(a.n_history, a.order_used + 1, MOST_ORDERS)


@compiled(inline=True)
def _set_polynomials(a: Record, h: float, last: int) -> None:
    """Set Newton's polynomials N_0 ... N_last at h, and integrated from 0 to h."""
    x0, x1, x2, x3, x4 = _X0 * h, _X1 * h, _X2 * h, _X3 * h, _X4 * h
    p0, p1, p2, p3, p4, value = _W0 * h, _W1 * h, _W2 * h, _W3 * h, _W4 * h, 1.0
    for i in range(last):
        a.basis_integrals[i], a.basis_values[i] = (p0 + p1) + (p2 + p3) + p4, value
        time_lag = a.time_lags[i]
        p0 *= x0 + time_lag
        p1 *= x1 + time_lag
        p2 *= x2 + time_lag
        p3 *= x3 + time_lag
        p4 *= x4 + time_lag
        value *= h + time_lag
    a.basis_integrals[last], a.basis_values[last] = (p0 + p1) + (p2 + p3) + p4, value


@compiled(inline=True)
def _sums(a: Record, factors: Floats, count: int) -> tuple[float, float, float, float]:
    """Sums over the first differences times factors, one for each state."""
    s0, s1, s2, s3 = 0.0, 0.0, 0.0, 0.0
    for i in range(count):
        factor = factors[i]
        s0 += a.differences[i, 0] * factor
        s1 += a.differences[i, 1] * factor
        s2 += a.differences[i, 2] * factor
        s3 += a.differences[i, 3] * factor
    return s0, s1, s2, s3


@compiled(inline=True)
def rates_at_end(n: int, a: Record, h: float, order: int, predicted: Floats, correction: Floats) -> float:
    """Write the formula's rates at IDA's prediction, and the difference between both predictions.

    Parameters
    ----------
    n : int
        States.
    a : record
        ``ADAMS``.
    h : float
        Length of the step, over tau.
    order : int
        Former rates to use, if so many are known.
    predicted : ndarray, shape (n,)
    correction : ndarray, shape (n,)
        Set to the prediction from the known rates minus IDA's prediction.

    Returns
    -------
    float
        Derivative of the rates in the state.
    """
    count = min(a.n_history, order)
    a.order_used = count
    _set_polynomials(a, h, _last_row(a))
    cj = a.basis_values[count] / a.basis_integrals[count]
    changes, rates = _sums(a, a.basis_integrals, count), _sums(a, a.basis_values, count)
    for j in range(n):
        correction[j] = a.state[j] + changes[j] - predicted[j]
        a.predicted_rates[j] = rates[j] - cj * correction[j]
    return float(cj)


@compiled(inline=True)
def set_differences(a: Record, h: float) -> None:
    """Set the divided differences with the rates at the end of a step of length h."""
    for i in range(_last_row(a)):
        share = 1.0 / (h + a.time_lags[i])
        for j in range(MOTION):
            a.new_differences[i + 1, j] = (a.new_differences[i, j] - a.differences[i, j]) * share


@compiled(inline=True)
def weighed_squares(n: int, numbers: Floats, weights: Floats) -> float:
    """Sum of the squares of the first n weighed numbers."""
    total = 0.0
    for j in range(n):
        weighed = numbers[j] * weights[j]
        total += weighed * weighed
    return total


@compiled(inline=True)
def order_error_sq(n: int, a: Record, h: float, order: int, weights: Floats) -> float:
    r"""Squared distance of the new state, over the tolerance, from that by a formula of one order less.

    Both polynomials go through the same last rates; they differ by the difference of order k, times
    :math:`\int (t - t_n) N_{k-1}\,dt`.
    """
    time_lag = h + a.time_lags[order - 1]
    factor = a.basis_integrals[order] - time_lag * a.basis_integrals[order - 1]
    total = 0.0
    for j in range(n):
        weighed = a.new_differences[order, j] * weights[j]
        total += weighed * weighed
    return factor * factor * total / n


@compiled
def between(a: Record, t: float, y: Floats, yp: Floats) -> None:
    """State and rates at a time within the last step, of which `store_step` has taken note."""
    count = a.order_used + 1
    _set_polynomials(a, t - a.time, count - 1)
    changes, rates = _sums(a, a.basis_integrals, count), _sums(a, a.basis_values, count)
    for j in range(min(y.size, MOTION)):
        y[j], yp[j] = a.state[j] + changes[j], rates[j]
