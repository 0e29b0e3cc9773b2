"""One step of a train's motion by the Runge-Kutta formula of order 8 of Dormand and Prince, and its polynomial.

Between events the equations are smooth and not stiff, and events come many times in a period of the contacts: a formula
of one step starts anew behind each of them at no cost. Works and losses are components of the same vector, so that they
have the formula's own order; the error of a step is that of the motion alone.

E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., 1993, section II.5; the
coefficients are those of `scipy.integrate.DOP853`.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from scipy.integrate import DOP853

from gearidae.arrays import Floats
from gearidae.compiled import compiled
from gearidae.engine.train.layout import TrainModel
from gearidae.engine.train.motion import motion

STAGES: Final = 12
_A: Final = np.ascontiguousarray(DOP853.A)
_B: Final = np.ascontiguousarray(DOP853.B)
_C: Final = np.ascontiguousarray(DOP853.C)
_E3: Final = np.ascontiguousarray(DOP853.E3)
_E5: Final = np.ascontiguousarray(DOP853.E5)
_D: Final = np.ascontiguousarray(DOP853.D)
_A_MORE: Final = np.ascontiguousarray(DOP853.A_EXTRA)
_C_MORE: Final = np.ascontiguousarray(DOP853.C_EXTRA)
POWERS: Final = 7
"""Coefficients of the polynomial of a step."""
SAFETY: Final = 0.9
SHRINK: Final = 0.2
GROW: Final = 5.0
"""By how much the next step is longer or shorter at most."""
EXPONENT: Final = -1.0 / 8.0


@compiled
def attempt(tm: TrainModel, h: float) -> float:
    """Try a step of the length h [s] from the accepted time; the error over the tolerance is returned.

    ``tm.new`` is the state at its end, ``tm.rates[12]`` its rates there, as ``tm.rates[0]`` are those at the beginning.
    """
    n, rates, y, new, between = 2 * len(tm.shafts), tm.rates, tm.y, tm.new, tm.between
    t = tm.train[0].time
    for stage in range(1, STAGES):
        for j in range(n):
            total = 0.0
            for i in range(stage):
                total += _A[stage, i] * rates[i, j]
            between[j] = y[j] + h * total
        motion(tm, t + _C[stage] * h, between, rates[stage])
        for k in range(len(tm.meshes)):
            mesh = tm.meshes[k]
            if stage == 1:
                mesh.step_high = mesh.step_low = mesh.force
            mesh.step_high, mesh.step_low = max(mesh.step_high, mesh.force), min(mesh.step_low, mesh.force)
    for j in range(y.size):
        total = 0.0
        for i in range(STAGES):
            total += _B[i] * rates[i, j]
        new[j] = y[j] + h * total
    motion(tm, t + h, new, rates[STAGES])
    low = high = 0.0
    for j in range(n):
        third = fifth = 0.0
        for i in range(STAGES + 1):
            third += _E3[i] * rates[i, j]
            fifth += _E5[i] * rates[i, j]
        low += (third * tm.weights[j]) ** 2
        high += (fifth * tm.weights[j]) ** 2
    if not (low + high < math.inf):
        return math.inf
    if high == 0.0:
        return 0.0
    return h * high / math.sqrt((high + 0.01 * low) * n)


@compiled
def next_length(h: float, error: float, refused: bool) -> float:
    """Length of the next step after one of the length h with an error over the tolerance."""
    if error == 0.0:
        return GROW * h
    factor = SAFETY * error**EXPONENT if error < math.inf else SHRINK
    return h * min(max(factor, SHRINK), 1.0 if refused else GROW)


@compiled
def make_polynomial(tm: TrainModel, h: float) -> None:
    """Work out the polynomial of the step of the length h that has just been tried, for `state_at`."""
    n, rates, y, between, dense = 2 * len(tm.shafts), tm.rates, tm.y, tm.between, tm.dense
    for extra in range(3):
        stage = STAGES + 1 + extra
        for j in range(n):
            total = 0.0
            for i in range(stage):
                total += _A_MORE[extra, i] * rates[i, j]
            between[j] = y[j] + h * total
        motion(tm, tm.train[0].time + _C_MORE[extra] * h, between, rates[stage])
    for j in range(y.size):
        change = tm.new[j] - y[j]
        dense[0, j] = change
        dense[1, j] = h * rates[0, j] - change
        dense[2, j] = 2.0 * change - h * (rates[0, j] + rates[STAGES, j])
        for p in range(4):
            total = 0.0
            for i in range(STAGES + 4):
                total += _D[p, i] * rates[i, j]
            dense[3 + p, j] = h * total


@compiled
def state_at(tm: TrainModel, share: float, count: int, out: Floats) -> None:
    """Write the first numbers of the state at a share of the step whose polynomial is known."""
    for j in range(count):
        value = 0.0
        for p in range(POWERS - 1, -1, -1):
            value = (value + tm.dense[p, j]) * (share if p % 2 == 0 else 1.0 - share)
        out[j] = tm.y[j] + value
