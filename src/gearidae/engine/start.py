"""Starting and starting again: consistent rates, a first step that passes, and a phase that stays small."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine import layout as at
from gearidae.engine.residual import residual

__all__ = ["first_step", "rebase", "set_rates"]

Floats = NDArray[np.float64]

PHASE_HIGH = 4096.0
"""The phase is taken back to within this many pitches whenever the integration starts afresh."""


@compiled
def set_rates(d: Floats, t: float, y: Floats, yp: Floats) -> None:
    """Solve F(t, y, y') = 0 for y', in place."""
    out = np.empty(y.size)
    yp[:] = 0.0
    residual(d, t, y, yp, out)
    yp[:] = -out
    if d[at.KIND] == at.GEARS:
        yp[at.V] -= yp[at.W]


@compiled
def first_step(
    d: Floats, t: float, y: Floats, yp: Floats, scale: Floats, rtol: float, longest: float
) -> float:
    """Step at which the first-order method's error, ``h^2 |y''| / 2``, stays well below the tolerance.

    Parameters
    ----------
    d : ndarray
        The scene, see `layout`.
    t : float
        Time over tau.
    y, yp : ndarray, shape (n,)
        State and consistent rates.
    scale : ndarray, shape (n,)
        What an error of 1 means for each state.
    rtol : float
        Relative tolerance.
    longest : float
        Upper bound of the step.
    """
    speed = 1e-9
    for i in range(y.size):
        speed = max(speed, abs(yp[i]) / scale[i])
    probe = min(1e-5 / speed, 1e-3 * longest)
    later = np.empty(y.size)
    set_rates(d, t + probe, y + probe * yp, later)
    curvature = 1e-9
    for i in range(y.size):
        curvature = max(curvature, abs(later[i] - yp[i]) / (probe * scale[i]))
    return float(min(0.5 * math.sqrt(rtol / curvature), longest))


@compiled
def rebase(d: Floats, y: Floats) -> None:
    """Move whole pitches from the phase to `layout.TURNS`, with all that is counted along."""
    if d[at.KIND] == at.ROLLER or abs(y[at.PHASE]) < PHASE_HIGH:
        return
    slots = d[at.SLOTS]  # a multiple of the slots leaves every pair in its own
    shift = slots * math.floor(y[at.PHASE] / slots)
    y[at.PHASE] -= shift
    d[at.TURNS] += shift
    d[at.MARK_LOW] -= shift
    d[at.MARK_HIGH] -= shift
    for k in range(int(d[at.TOTAL_SLOTS])):
        d[int(d[at.HISTORIES]) + int(d[at.HISTORY]) * k + at.PAIR] -= shift
