"""Starting and starting again: consistent rates, a first step that passes, and a phase that stays small."""

from __future__ import annotations

import math

import numpy as np

from gearidae.compiled import compiled
from gearidae.engine.elastic.nodes import node_rates
from gearidae.engine.events.mesh_marks import relief_step
from gearidae.engine.model.state import EMPTY, LOAD, PHASE, Floats, Model, U, V, W
from gearidae.engine.motion.residual import residual
from gearidae.engine.pairs.mesh_error import error_at
from gearidae.engine.pairs.tooth_pairs import in_flight, nearest_gap
from gearidae.laws.frictions import resists

FIRST_RELIEF = 0.25
"""First step, over that in which the tip relief may part a pair."""


@compiled(makes_arrays=True)
def set_rates(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Solve F(t, y, y') = 0 for y', in place; its derivative in time where the nodes are concerned."""
    out = np.empty(y.size)
    for i in range(y.size):  # numba takes seconds to compile what a slice of numbers could be set to
        yp[i] = 0.0
    residual(m, t, y, yp, out)
    for i in range(y.size):
        yp[i] = -out[i]
    yp[V] -= (1.0 + error_at(m, y[U], y[PHASE]).gear) * yp[W]
    if m.scene.nodes > 0:
        node_rates(m, yp)


@compiled(makes_arrays=True)
def first_step(m: Model, t: float, y: Floats, yp: Floats, longest: float) -> float:
    """Step at which the first-order method's error, ``h^2 |y''| / 2``, stays well below the tolerance.

    Parameters
    ----------
    t : float
        Time over tau.
    y, yp : ndarray, shape (n,)
        State and consistent rates.
    longest : float
        Upper bound of the step.
    """
    scale = m.tables[m.scene.scale_at :]
    speed = 1e-9
    for i in range(y.size):
        speed = max(speed, abs(yp[i]) / scale[i])
    probe = min(1e-5 / speed, 1e-3 * longest)
    ahead, later = np.empty(y.size), np.empty(y.size)
    for i in range(y.size):
        ahead[i] = y[i] + probe * yp[i]
    set_rates(m, t + probe, ahead, later)
    curvature = 1e-9
    for i in range(y.size):
        curvature = max(curvature, abs(later[i] - yp[i]) / (probe * scale[i]))
    step = min(0.5 * math.sqrt(m.scene.rtol / curvature), longest)
    if resists(m, LOAD) and m.state.slip != 0.0 and y[W] == 0.0:
        # a slip that has just begun must not come to rest again within the first, linear step
        change = abs(later[W] - yp[W]) / probe
        if change > 0.0:
            step = min(step, 0.25 * abs(yp[W]) / change)
    if not in_flight(m):
        step = min(step, FIRST_RELIEF * relief_step(m, y))
    for flank in range(2):
        # free flight has no curvature, and the flank at its end comes without warning
        apart = nearest_gap(m, flank, y) - m.scene.cutoff
        if apart > 0.0:
            step = min(step, 0.5 * max(apart, 1.0) / max(abs(y[V]), 1e-9))
    return float(step)


@compiled
def rebase(m: Model, y: Floats) -> None:
    """Move whole pitches from the phase to ``m.state.turns``, with all that is counted along."""
    if abs(y[PHASE]) < m.scene.phase_high:
        return
    slots = m.scene.slots  # a multiple of the slots leaves every pair in its own
    shift = slots * math.floor(y[PHASE] / slots)
    y[PHASE] -= shift
    m.state.whole_pitches += shift
    m.state.mesh_mark_below -= shift
    m.state.mesh_mark_above -= shift
    for shaft in range(2):
        m.state.ageing.way[shaft] -= shift / m.scene.phase_rate
    for k in range(m.scene.histories):
        if m.state.history[k].pair != EMPTY:
            m.state.history[k].pair -= int(shift)
