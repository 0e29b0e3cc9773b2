"""Starting and starting again: consistent rates, a first step that passes, and a phase that stays small."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine.elastic.calls import node_rates
from gearidae.engine.model import layout as at
from gearidae.engine.model.residual import residual
from gearidae.engine.model.tooth_pairs import nearest_gap

__all__ = ["first_step", "rebase", "set_rates"]

Floats = NDArray[np.float64]

PHASE_HIGH = 16.0
"""Pitches at which whole ones are taken out of the phase: it is held to absolute tolerances, down to 1e-15."""


@compiled(makes_arrays=True)
def set_rates(d: Floats, t: float, y: Floats, yp: Floats) -> None:
    """Solve F(t, y, y') = 0 for y', in place; its derivative in time where the nodes are concerned."""
    out = np.empty(y.size)
    for i in range(y.size):  # numba takes seconds to compile what a slice of numbers could be set to
        yp[i] = 0.0
    residual(d, t, y, yp, out)
    for i in range(y.size):
        yp[i] = -out[i]
    if d[at.KIND] == at.GEARS:
        yp[at.V] -= yp[at.W]
    if d[at.NODES] > 0.0:
        node_rates(d, yp)


@compiled(makes_arrays=True)
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
    ahead, later = np.empty(y.size), np.empty(y.size)
    for i in range(y.size):
        ahead[i] = y[i] + probe * yp[i]
    set_rates(d, t + probe, ahead, later)
    curvature = 1e-9
    for i in range(y.size):
        curvature = max(curvature, abs(later[i] - yp[i]) / (probe * scale[i]))
    step = min(0.5 * math.sqrt(rtol / curvature), longest)
    if d[at.DRY] != 0.0 and d[at.SLIP] != 0.0 and y[at.W] == 0.0:
        # a slip that has just begun must not come to rest again within the first, linear step
        change = abs(later[at.W] - yp[at.W]) / probe
        if change > 0.0:
            step = min(step, 0.25 * abs(yp[at.W]) / change)
    for coast in range(1 if d[at.KIND] == at.ROLLER else 2):
        # free flight has no curvature, and the flank at its end comes without warning
        apart = nearest_gap(d, coast, y) - d[at.CUTOFF]
        if apart > 0.0:
            step = min(step, 0.5 * max(apart, 1.0) / max(abs(y[at.V]), 1e-9))
    return float(step)


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
