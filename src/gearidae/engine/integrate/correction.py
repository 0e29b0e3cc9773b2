"""One correction of Newton's to a motion: residual and Jacobian at once, and the equations solved by elimination.

Two of a gear pair's four equations only say that u' = v and that the phase turns with w. They are put into the other
two, which leaves two equations for the corrections of v and w.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.state import PHASE, Floats, Model, U, V, W
from gearidae.engine.motion.residual import motion
from gearidae.engine.motion.shafts import acceleration_slopes


@compiled(inline=True)
def correct(m: Model, t: float, cj: float, y: Floats, yp: Floats, delta: Floats) -> float:
    """Solve ``(dF/dy + cj dF/dy') delta = -F``, with the slopes of `gearidae.engine.motion.residual.jacobian`.

    Parameters
    ----------
    t, cj : float
        Time over tau, and what the rates change by with the state.
    y, yp, delta : ndarray, shape (4,)
        State, its rate, and where the correction goes.

    Returns
    -------
    float
        Squared frequency of the motion, over 1 / tau^2: an upper estimate from the slopes of the forces, with the rate
        at which resistance slows the motion down added at twice its value.
    """
    s = acceleration_slopes(m, y, motion(m, t, y, yp, delta, True))
    step, of_u, of_v = 1.0 / cj, delta[U], delta[V]
    # du = (dv - of_u) step and dphase = (turning dw - of_phase) step, put into the rows of v and w
    v_v = cj - s.pinion_v - s.pinion_u * step
    turning, of_phase, of_w = m.scene.phase_rate, delta[PHASE], delta[W]
    v_w = cj - s.pinion_w - s.pinion_phase * turning * step
    w_v, w_w = -s.gear_v - s.gear_u * step, cj - s.gear_w - s.gear_phase * turning * step
    right_v = -(s.pinion_u * of_u + s.pinion_phase * of_phase) * step - of_v
    right_w = -(s.gear_u * of_u + s.gear_phase * of_phase) * step - of_w
    share = 1.0 / (v_v * w_w - v_w * w_v)
    delta[V] = (right_v * w_w - v_w * right_w) * share
    delta[W] = (v_v * right_w - w_v * right_v) * share
    delta[U] = (delta[V] - of_u) * step
    delta[PHASE] = (turning * delta[W] - of_phase) * step
    own = s.by_pinion * s.pinion_by_speed  # of the pinion, which is in its slope in v already
    slowing = 2.0 * (abs(s.pinion_v) + abs(s.gear_v) + abs(s.pinion_w - own) + abs(s.gear_w))
    return abs(s.pinion_u) + abs(s.gear_u) + abs(s.gear_by_travel) + slowing * slowing
