"""Single steps of the explicit and collocation methods that gearidae's own integrator is compared with.

Each takes the scaled state over one step and knows nothing of events. All read the same right-hand side as the
engine, so that what differs is the integrator alone.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853 as _SCIPY

from gearidae.engine.model.state import GEARS, Model, V, W
from gearidae.engine.motion.residual import residual
from gearidae_bench.compiling import compiled

__all__ = [
    "STAGES",
    "dop853_prepare",
    "dop853_step",
    "dop853_value",
    "gauss_step",
    "hermite_value",
    "rates",
    "rk4_step",
]

Floats = NDArray[np.float64]

STAGES = 16
"""Rows of work space that any of the methods needs."""

# Dormand and Prince's eighth-order pair with its dense output (Hairer, Norsett and Wanner 1993, Sec. II.5).
_N = 12
_A, _B, _C = _SCIPY.A.copy(), _SCIPY.B.copy(), _SCIPY.C.copy()
_E3, _E5 = _SCIPY.E3.copy(), _SCIPY.E5.copy()
_A_MORE, _C_MORE, _D = _SCIPY.A_EXTRA.copy(), _SCIPY.C_EXTRA.copy(), _SCIPY.D.copy()

_GAUSS_STAGES = 6
_GAUSS_ITERATIONS = 60


def _gauss_tableau(stages: int) -> tuple[Floats, Floats, Floats, Floats]:
    """Nodes, matrix and weights of Gauss-Legendre collocation, and weights of an embedded rule of order `stages`.

    The embedded rule leaves the last node out and takes the start of the step in.
    """
    x, w = np.polynomial.legendre.leggauss(stages)
    c, b = 0.5 * (x + 1.0), 0.5 * w
    powers = np.vander(c, increasing=True)
    order = np.arange(1, stages + 1)
    a = (c[:, None] ** order / order) @ np.linalg.inv(powers)
    nodes = np.concatenate([[0.0], c[:-1]])
    embedded = np.linalg.solve(np.vander(nodes, increasing=True).T, 1.0 / order)
    return c, np.asarray(a), b, np.asarray(embedded)


_GC, _GA, _GB, _GE = _gauss_tableau(_GAUSS_STAGES)


@compiled()
def rates(m: Model, t: float, y: Floats, zero: Floats, out: Floats) -> None:
    """y' at a scaled state, from the engine's residual; `zero` holds zeros and stays so."""
    residual(m, t, y, zero, out)
    for i in range(y.size):
        out[i] = -out[i]
    if m.scene.kind == GEARS:
        out[V] -= out[W]


@compiled()
def rk4_step(
    m: Model, t: float, y: Floats, h: float, k: Floats, zero: Floats, trial: Floats, new: Floats
) -> None:
    """One step of the classical method of order four from t; ``k[0]`` holds y' there."""
    n = y.size
    for i in range(n):
        trial[i] = y[i] + 0.5 * h * k[0, i]
    rates(m, t + 0.5 * h, trial, zero, k[1])
    for i in range(n):
        trial[i] = y[i] + 0.5 * h * k[1, i]
    rates(m, t + 0.5 * h, trial, zero, k[2])
    for i in range(n):
        trial[i] = y[i] + h * k[2, i]
    rates(m, t + h, trial, zero, k[3])
    for i in range(n):
        new[i] = y[i] + h / 6.0 * (k[0, i] + 2.0 * (k[1, i] + k[2, i]) + k[3, i])


@compiled()
def hermite_value(y: Floats, f: Floats, new: Floats, f_new: Floats, h: float, s: float, out: Floats) -> None:
    """Cubic through states and rates at both ends of a step, at the part `s` of it."""
    r = 1.0 - s
    for i in range(y.size):
        rise = new[i] - y[i]
        out[i] = y[i] + s * (rise + r * (r * (h * f[i] - rise) + s * (rise - h * f_new[i])))


@compiled()
def dop853_step(
    m: Model,
    t: float,
    y: Floats,
    h: float,
    atol: Floats,
    k: Floats,
    zero: Floats,
    trial: Floats,
    new: Floats,
) -> float:
    """One step of order eight; ``k[0]`` holds y' at its start, ``k[12]`` will hold that at its end.

    Returns
    -------
    float
        Root mean square of the estimated error over `atol`: 1 is as much as may be.
    """
    n = y.size
    for s in range(1, _N):
        for i in range(n):
            total = 0.0
            for j in range(s):
                total += _A[s, j] * k[j, i]
            trial[i] = y[i] + h * total
        rates(m, t + _C[s] * h, trial, zero, k[s])
    for i in range(n):
        total = 0.0
        for j in range(_N):
            total += _B[j] * k[j, i]
        new[i] = y[i] + h * total
    rates(m, t + h, new, zero, k[_N])
    fifth = third = 0.0
    for i in range(n):
        e3 = e5 = 0.0
        for j in range(_N + 1):
            e3 += _E3[j] * k[j, i]
            e5 += _E5[j] * k[j, i]
        third += (e3 / atol[i]) ** 2
        fifth += (e5 / atol[i]) ** 2
    if fifth == 0.0:
        return 0.0
    return h * fifth / math.sqrt((fifth + 0.01 * third) * n)


@compiled()
def dop853_prepare(
    m: Model,
    t: float,
    y: Floats,
    h: float,
    k: Floats,
    zero: Floats,
    trial: Floats,
    new: Floats,
    dense: Floats,
) -> None:
    """Coefficients of the interpolant of order seven over a step just made, shape (7, n)."""
    n = y.size
    for s in range(_N + 1, STAGES):
        for i in range(n):
            total = 0.0
            for j in range(s):
                total += _A_MORE[s - _N - 1, j] * k[j, i]
            trial[i] = y[i] + h * total
        rates(m, t + _C_MORE[s - _N - 1] * h, trial, zero, k[s])
    for i in range(n):
        rise = new[i] - y[i]
        dense[0, i] = rise
        dense[1, i] = h * k[0, i] - rise
        dense[2, i] = 2.0 * rise - h * (k[_N, i] + k[0, i])
        for row in range(4):
            total = 0.0
            for j in range(STAGES):
                total += _D[row, j] * k[j, i]
            dense[3 + row, i] = h * total


@compiled()
def dop853_value(y: Floats, dense: Floats, s: float, out: Floats) -> None:
    """State at the part `s` of a step."""
    for i in range(y.size):
        value = 0.0
        for row in range(6, -1, -1):
            value = (value + dense[row, i]) * (s if row % 2 == 0 else 1.0 - s)
        out[i] = y[i] + value


@compiled()
def gauss_step(
    m: Model,
    t: float,
    y: Floats,
    h: float,
    scale: Floats,
    k: Floats,
    zero: Floats,
    trial: Floats,
    new: Floats,
) -> float:
    """One step of Gauss-Legendre collocation of order twelve, solved by fixed-point iteration down to rounding.

    Parameters
    ----------
    m, t, y, h : Model, float, ndarray, float
        The scene, and the step.
    scale : ndarray, shape (n,)
        What an error of 1 means for each state.
    k : ndarray, shape (STAGES, n)
        ``k[0]`` holds y' at the start; the other rows are work space, and no start values are taken from them.
    zero, trial : ndarray, shape (n,)
        Zeros, and work space.
    new : ndarray, shape (n,)
        State at the end of the step.

    Returns
    -------
    float
        Error of the embedded rule of order six over `scale`; infinite if the iteration does not settle or
        overflows.
    """
    n = y.size
    for s in range(_GAUSS_STAGES):
        for i in range(n):
            trial[i] = y[i] + _GC[s] * h * k[0, i]
        rates(m, t + _GC[s] * h, trial, zero, k[1 + s])
    last = math.inf
    improved = k[_GAUSS_STAGES + 1]
    for iteration in range(_GAUSS_ITERATIONS):
        change = 0.0
        for s in range(_GAUSS_STAGES):
            for i in range(n):
                total = 0.0
                for j in range(_GAUSS_STAGES):
                    total += _GA[s, j] * k[1 + j, i]
                trial[i] = y[i] + h * total
            rates(m, t + _GC[s] * h, trial, zero, improved)
            for i in range(n):
                change = max(change, h * abs(improved[i] - k[1 + s, i]) / scale[i])
                k[1 + s, i] = improved[i]
        if change < 1e-15 or (iteration > 8 and change < 1e-13 and change >= last):
            break
        last = change
    else:
        return math.inf
    error = 0.0
    for i in range(n):
        rise = 0.0
        other = _GE[0] * k[0, i]
        for s in range(_GAUSS_STAGES):
            rise += _GB[s] * k[1 + s, i]
            if s < _GAUSS_STAGES - 1:
                other += _GE[s + 1] * k[1 + s, i]
        new[i] = y[i] + h * rise
        if not math.isfinite(new[i]):  # a trial far inside a tooth: NaN passes for small in a maximum
            return math.inf
        error = max(error, abs(h * (rise - other)) / scale[i])
    return error
