"""One correction of Newton's to a motion: residual and Jacobian at once, and the equations solved by elimination.

Two of a gear pair's four equations only say that u' = v and that the phase turns with w. They are put into the other
two, which leaves two equations for the corrections of v and w; a roller keeps one.
"""

from __future__ import annotations

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import FRICTION
from gearidae.engine.model.state import PHASE, ROLLER, Floats, Model, U, V, W
from gearidae.engine.motion.residual import is_stuck, motion, slopes_with_friction


@compiled(inline=True)
def correct(m: Model, t: float, cj: float, y: Floats, yp: Floats, delta: Floats) -> float:
    """Solve ``(dF/dy + cj dF/dy') delta = -F``, the static error's own slopes left out as in `residual.jacobian`.

    Parameters
    ----------
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
    force_u, force_phase, relief_u, relief_phase = motion(m, t, y, yp, delta, True)
    step = 1.0 / cj
    of_u, of_v = delta[U], delta[V]
    if m.scene.kind == ROLLER:
        slope = m.scene.gear_inverse_mass * force_u
        delta[V] = -(of_v + slope * step * of_u) / (cj - slope * step)
        delta[U] = (delta[V] - of_u) * step
        return abs(slope)
    of_phase, of_w = delta[PHASE], delta[W]
    if m.scene.friction.on != 0:
        return _correct_with_friction(m, cj, y, delta, (force_u, force_phase, relief_u, relief_phase))
    a1, turning, damping = m.scene.pinion_inverse_mass, m.scene.phase_rate, m.scene.damping
    a2 = 0.0 if is_stuck(m) else m.scene.gear_inverse_mass
    torque_u, torque_phase = force_u + relief_u, force_phase + relief_phase
    drag = 2.0 * m.scene.drag * abs(y[W]) + m.scene.viscous
    gain = a1 * m.scene.speed_gain
    # du = (dv - of_u) step and dphase = (turning dw - of_phase) step, put into the rows of v and w
    v_v = cj + gain + a1 * (damping + force_u * step)
    v_w = cj + gain + a1 * force_phase * turning * step
    w_v = -a2 * (damping + torque_u * step)
    w_w = cj + a2 * (drag - torque_phase * turning * step)
    right_v = a1 * (force_u * of_u + force_phase * of_phase) * step - of_v
    right_w = -a2 * (torque_u * of_u + torque_phase * of_phase) * step - of_w
    share = 1.0 / (v_v * w_w - v_w * w_v)
    delta[V] = (right_v * w_w - v_w * right_w) * share
    delta[W] = (v_v * right_w - w_v * right_v) * share
    delta[U] = (delta[V] - of_u) * step
    delta[PHASE] = (turning * delta[W] - of_phase) * step
    slowing = 2.0 * ((a1 + a2) * damping + a2 * drag + gain)
    return a1 * abs(force_u) + a2 * abs(torque_u) + slowing * slowing


@compiled_once(FRICTION)
def _correct_with_friction(
    m: Model, cj: float, y: Floats, delta: Floats, slopes: tuple[float, float, float, float]
) -> float:
    """Solve the same equations with friction; `delta` has the residual, and the slopes are those of `mesh_forces`."""
    s = slopes_with_friction(m, y, slopes)
    step, turning = 1.0 / cj, m.scene.phase_rate
    of_u, of_v, of_phase, of_w = delta[U], delta[V], delta[PHASE], delta[W]
    v_v, v_w = cj - s.pinion_v - s.pinion_u * step, cj - s.pinion_w - s.pinion_phase * turning * step
    w_v, w_w = -s.gear_v - s.gear_u * step, cj - s.gear_w - s.gear_phase * turning * step
    right_v = -(s.pinion_u * of_u + s.pinion_phase * of_phase) * step - of_v
    right_w = -(s.gear_u * of_u + s.gear_phase * of_phase) * step - of_w
    share = 1.0 / (v_v * w_w - v_w * w_v)
    delta[V] = (right_v * w_w - v_w * right_w) * share
    delta[W] = (v_v * right_w - w_v * right_v) * share
    delta[U] = (delta[V] - of_u) * step
    delta[PHASE] = (turning * delta[W] - of_phase) * step
    slowing = 2.0 * (abs(s.pinion_v) + abs(s.gear_v) + abs(s.pinion_w) + abs(s.gear_w))
    return abs(s.pinion_u) + abs(s.gear_u) + slowing * slowing
