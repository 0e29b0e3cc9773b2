"""One correction of Newton's to a motion: residual and Jacobian at once, and the equations solved by elimination.

Two of a gear pair's four equations only say that u' = v and that the phase turns with w. They are put into the other
two, which leaves two equations for the corrections of v and w; a roller keeps one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine.model import layout as at
from gearidae.engine.model.residual import held, motion

__all__ = ["correct"]

Floats = NDArray[np.float64]


@compiled(inline=True)
def correct(d: Floats, t: float, cj: float, y: Floats, yp: Floats, delta: Floats) -> float:
    """Solve ``(dF/dy + cj dF/dy') delta = -F``, the static error's own slopes left out as in `residual.jacobian`.

    Parameters
    ----------
    d : ndarray
        The scene, see `layout`.
    t, cj : float
        Time over tau, and what the rates change by with the state.
    y, yp, delta : ndarray, shape (4,) or (2,)
        State, its rate, and where the correction goes.

    Returns
    -------
    float
        Squared frequency of the motion, over 1 / tau^2: an upper estimate from the slopes of the forces, with the rate
        at which resistance slows the motion down added at twice its value.
    """
    force_u, force_phase, relief_u, relief_phase = motion(d, t, y, yp, delta)
    step = 1.0 / cj
    of_u, of_v = delta[at.U], delta[at.V]
    if d[at.KIND] == at.ROLLER:
        slope = d[at.GEAR_SHARE] * force_u
        delta[at.V] = -(of_v + slope * step * of_u) / (cj - slope * step)
        delta[at.U] = (delta[at.V] - of_u) * step
        return abs(slope)
    of_phase, of_w = delta[at.PHASE], delta[at.W]
    a1, turning, damping = d[at.PINION_SHARE], d[at.PHASE_RATE], d[at.DAMPING]
    a2 = 0.0 if held(d) else d[at.GEAR_SHARE]
    torque_u, torque_phase = force_u + relief_u, force_phase + relief_phase
    drag = 2.0 * d[at.DRAG] * abs(y[at.W])
    # du = (dv - of_u) step and dphase = (turning dw - of_phase) step, put into the rows of v and w
    v_v = cj + a1 * (damping + force_u * step)
    v_w = cj + a1 * force_phase * turning * step
    w_v = -a2 * (damping + torque_u * step)
    w_w = cj + a2 * (drag - torque_phase * turning * step)
    right_v = a1 * (force_u * of_u + force_phase * of_phase) * step - of_v
    right_w = -a2 * (torque_u * of_u + torque_phase * of_phase) * step - of_w
    share = 1.0 / (v_v * w_w - v_w * w_v)
    delta[at.V] = (right_v * w_w - v_w * right_w) * share
    delta[at.W] = (v_v * right_w - w_v * right_v) * share
    delta[at.U] = (delta[at.V] - of_u) * step
    delta[at.PHASE] = (turning * delta[at.W] - of_phase) * step
    slowing = 2.0 * ((a1 + a2) * damping + a2 * drag)
    return a1 * abs(force_u) + a2 * abs(torque_u) + slowing * slowing
