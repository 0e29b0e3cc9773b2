"""The one residual F(t, y, y') = 0 that every driver integrates, and its Jacobian.

States of a gear pair, scaled (see `gearidae.engine.model.state`): u, its rate v, the gear's phase in pitches and its
surface velocity w,

    u' - v = 0,                  v' - (1 - e') a1 (m1 - (1 - e') F) + w' + e'' (phi1')^2 = 0,
    phase' - (sigma/pb) w = 0,   w' - a2 (F + Fs - m2) = 0,

with F the sum of the pairs' forces along the line of action and Fs what tip relief adds at the gear (Teodorescu et al.
2009, Eqs. 1-6, with the tip relief doing work consistently) and, with ``mesh.radius_force``, the changing radius. A
gear held by dry resistance has w' = 0. A roller has the states z and its rate, z' - v = 0, v' - a2 F = 0. An elastic
contact adds the deflections at its nodes, which have no rates: the system is then a DAE of index 1.
"""

from __future__ import annotations

from typing import NamedTuple

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import FRICTION, SOLVER
from gearidae.engine.elastic.elimination import FINISH, PREDICT, SETTLE, pair_deflections, settle_pair
from gearidae.engine.elastic.nodes import mark_out_of_reach, node_force, node_residual
from gearidae.engine.elastic.rows import first_unknown
from gearidae.engine.energy.radius import radius_force
from gearidae.engine.friction.forces import friction_slopes, rubbed_accelerations
from gearidae.engine.friction.pairs import set_limits
from gearidae.engine.model.state import DRIVE, LOAD, PHASE, ROLLER, Floats, Model, U, V, W
from gearidae.engine.pairs.coverage import WHOLE, note_shares, path_position, shares_of
from gearidae.engine.pairs.notes import begin_notes, note_force
from gearidae.engine.pairs.shaft_angle import torque_angle
from gearidae.engine.pairs.tooth_pairs import (
    contact_length,
    gap_and_rate,
    history_of,
    pair_at,
    pair_force,
    pair_gap,
    pairs_touching,
    static_error,
)
from gearidae.engine.population.forces import mesh_sums, roller_sum
from gearidae.engine.torques.torque import torque_force


@compiled_once(SOLVER)
def roller_force(m: Model, t: float, y: Floats, settling: bool) -> tuple[float, float]:
    """Force on a roller and its slope in the height, scaled; `settling` as for `mesh_forces`."""
    if m.scene.population.flanks != 0:
        return roller_sum(m, y)
    height, speed = y[U], y[V]
    elastic = m.scene.nodes > 0
    if elastic:
        mark_out_of_reach(m)
    if height >= m.scene.cutoff:
        return 0.0, 0.0
    known = m.state.history[0].pair == 0
    if elastic and settling:
        return settle_pair(m, 0, known, t, with_deflections(m, y), height, speed, 1.0)
    if elastic:
        return node_force(m, 0, known, t, y, height, speed, 1.0)
    return pair_force(m, 0, known, t, height, speed, 0.0, WHOLE)


@compiled(inline=True)
def mesh_forces(
    m: Model, t: float, y: Floats, settling: bool
) -> tuple[float, float, float, float, float, float]:
    """Sum the forces of all pairs within reach, with their slopes.

    Parameters
    ----------
    t : float
        Time over tau.
    y : ndarray
        State.
    settling : bool
        Whether the deflections of elastic contacts are solved for, with slopes along which they follow; otherwise they
        are those of the state, and the slopes are at fixed deflection.

    Returns
    -------
    force, relief_force : float
        F and Fs, scaled.
    force_u, force_phase, relief_u, relief_phase : float
        Their partial derivatives in u and phase.
    """
    if m.scene.population.flanks != 0:
        return mesh_sums(m, y)
    force = relief = force_u = force_phase = relief_u = relief_phase = 0.0
    u, v, phase, w = y[U], y[V], y[PHASE], y[W]
    cutoff = m.scene.cutoff
    elastic = m.scene.nodes > 0
    if elastic:
        mark_out_of_reach(m)
    if m.scene.noting != 0:
        begin_notes(m, t, u)
    full = with_deflections(m, y) if elastic and settling else y
    reach = pairs_touching(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        sign = 1.0 - 2.0 * coast
        gap, rate, slope, inside = pair_gap(m, coast, pair, u, v, phase, w)
        if gap >= cutoff:
            continue
        k = history_of(m, coast, pair)
        known = m.state.history[k].pair == pair
        if elastic:
            note_shares(m, k, coast, pair, inside)
            length = contact_length(m, inside)
            if settling:
                load, stiffness = settle_pair(m, k, known, t, full, gap, rate, length)
            else:
                load, stiffness = node_force(m, k, known, t, y, gap, rate, length)
        else:
            shares = shares_of(m, coast, pair, inside)
            load, stiffness = pair_force(m, k, known, t, gap, rate, inside, shares)
            if m.scene.noting != 0:
                note_force(m, k, pair, inside, (gap, rate), (load, stiffness))
        load *= sign
        # the gap falls with u on the drive flank and rises on the coast flank; the phase carries a coast pair
        # backwards along its path
        by_u = -stiffness
        along = slope / m.scene.phase_rate
        by_phase = stiffness * along
        force += load
        force_u += by_u
        force_phase += by_phase
        if slope != 0.0:
            relief += load * slope
            relief_u += by_u * slope
            relief_phase += by_phase * slope + sign * load * m.scene.relief_slope
        if m.scene.radius_force != 0:
            load, by_u, by_phase = radius_force(m, t, full, coast, pair, k, gap, rate)
            relief += load
            relief_u += by_u
            relief_phase += by_phase
    return force, relief, force_u, force_phase, relief_u, relief_phase


@compiled
def resisting_force(m: Model, t: float, u: float, phase: float, w: float) -> float:
    """Resistance at the gear over R2, scaled: dry in the direction of slip, and both drags (Eq. 2)."""
    force = m.scene.drag * w * abs(w) + m.scene.viscous * w
    if m.scene.dry != 0 and m.state.slip != 0.0:
        angle = torque_angle(m, LOAD, u, phase)
        force += m.state.slip * max(torque_force(m, LOAD, t, angle, w), 0.0)
    return force


@compiled
def is_stuck(m: Model) -> bool:
    """Whether dry resistance holds the gear at rest."""
    return bool(m.scene.dry != 0 and m.state.slip == 0.0)


@compiled(inline=True)
def motion(
    m: Model, t: float, y: Floats, yp: Floats, out: Floats, settling: bool
) -> tuple[float, float, float, float]:
    """F(t, y, y') of the motion, in the first places of `out`, and the slopes of its forces.

    `settling` as for `mesh_forces`; the state may then be that of the motion alone.

    Returns
    -------
    force_u, force_phase, relief_u, relief_phase : float
        As `mesh_forces` has them; of a roller, the slope in its height and zeros.
    """
    v = y[V]
    out[U] = yp[U] - v
    if m.scene.kind == ROLLER:
        force, slope = roller_force(m, t, y, settling)
        out[V] = yp[V] - m.scene.gear_inverse_mass * force
        return slope, 0.0, 0.0, 0.0
    u, phase, w = y[U], y[PHASE], y[W]
    force, relief, force_u, force_phase, relief_u, relief_phase = mesh_forces(m, t, y, settling)
    force += m.scene.damping * v
    turn, e1, e2 = v + w, 0.0, 0.0
    if m.scene.error_count != 0:
        _, _, e1, e2 = static_error(m, u, phase)
        turn = (v + w) / (1.0 - e1)
    drive = torque_force(m, DRIVE, t, torque_angle(m, DRIVE, u, phase), turn)
    if m.scene.friction.on != 0:
        drive -= (1.0 - e1) * force
        pinion, gear = rubbed_accelerations(m, t, y, turn, drive, force + relief)
        out[V] = yp[V] + yp[W] - (1.0 - e1) * pinion + e2 * turn * turn
        out[PHASE], out[W] = yp[PHASE] - m.scene.phase_rate * w, yp[W] - gear
        return force_u, force_phase, relief_u, relief_phase
    if m.scene.error_count == 0:
        pinion = m.scene.pinion_inverse_mass * (drive - force)
    else:
        pinion = (1.0 - e1) * m.scene.pinion_inverse_mass * (drive - (1.0 - e1) * force) - e2 * turn * turn
    if is_stuck(m):
        out[W] = yp[W]
    else:
        out[W] = yp[W] - m.scene.gear_inverse_mass * (force + relief - resisting_force(m, t, u, phase, w))
    out[V] = yp[V] + yp[W] - pinion
    out[PHASE] = yp[PHASE] - m.scene.phase_rate * w
    return force_u, force_phase, relief_u, relief_phase


@compiled(makes_arrays=True)
def with_deflections(m: Model, y: Floats) -> Floats:
    """Whole state to which deflections can be put: the same, or a copy if it is that of the motion alone."""
    if y.size == m.scene.states:
        return y
    own = m.rows[m.scene.trial_at : m.scene.trial_at + m.scene.states]
    for j in range(y.size):
        own[j] = y[j]
    return own


@compiled
def is_eliminated(m: Model) -> bool:
    """Whether there are nodes that the integrator does not see."""
    return bool(m.scene.nodes > 0 and m.work.adams.own != 0)


@compiled
def set_deflections(m: Model, t: float, y: Floats, roughly: bool) -> None:
    """Solve for the deflections that go with the motion of a whole state, or only interpolate them, in place."""
    _ask_for_deflections(m, t, y, PREDICT if roughly else SETTLE)


@compiled
def finish_deflections(m: Model, t: float, y: Floats) -> None:
    """Put the deflections to the state at the end of a step, and note them for the prediction of the next ones."""
    for k in range(m.scene.histories):
        if m.state.history[k].loaded == 0:
            m.work.settling[k].last_known = m.work.settling[k].before_known = 0
    _ask_for_deflections(m, t, y, FINISH)


@compiled_once(SOLVER)
def _ask_for_deflections(m: Model, t: float, y: Floats, kind: int) -> None:
    """Ask for the deflections of all pairs within reach, in one of the ways of `pair_deflections`."""
    for j in range(first_unknown(m, 0), y.size):  # those of pairs out of reach are zero
        y[j] = 0.0
    reach = pairs_touching(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        k = history_of(m, coast, pair)
        gap, rate = gap_and_rate(m, coast, pair, y)
        if gap >= m.scene.cutoff:
            continue
        m.state.history[k].length = 1.0
        if m.scene.kind != ROLLER:
            inside = path_position(m, coast, pair, y[PHASE])
            note_shares(m, k, coast, pair, inside)
            m.state.history[k].length = contact_length(m, inside)
        known = m.state.history[k].pair == pair
        pair_deflections(m, kind, k, known, t, y, gap, rate)


@compiled
def residual(m: Model, t: float, y: Floats, yp: Floats, out: Floats) -> None:
    """F(t, y, y') in scaled states.

    Parameters
    ----------
    t : float
        Time over tau.
    y, yp, out : ndarray, shape (4,) or (2,), and the nodes
        State, its rate, and where the residual goes.
    """
    motion(m, t, y, yp, out, False)
    if m.scene.nodes > 0:
        node_residual(m, y, out)


@compiled
def jacobian(m: Model, t: float, cj: float, y: Floats, out: Floats) -> None:
    """dF/dy + cj dF/dy' of the motion, dense, column by column (Fortran order).

    The static error's own slopes are left out: it is small, and the Jacobian only steers Newton's iteration. So are the
    slopes of a torque in angle and speed: a shaft takes many steps to follow a mild law, and each iteration reduces
    what is left by the ratio of a step to that time. A drive that holds a speed is not mild, and its slope is there.

    Parameters
    ----------
    t, cj : float
        Time over tau, and IDA's leading coefficient.
    y : ndarray
        State; the deflections of an elastic contact after the motion.
    out : ndarray, shape (16,) or (4,)
    """
    if m.scene.kind == ROLLER:
        _, slope = roller_force(m, t, y, False)
        out[0], out[1] = cj, -m.scene.gear_inverse_mass * slope
        out[2], out[3] = -1.0, cj
        return
    w = y[W]
    _, _, force_u, force_phase, relief_u, relief_phase = mesh_forces(m, t, y, False)
    if m.scene.friction.on != 0:
        _jacobian_with_friction(m, t, cj, y, out, (force_u, force_phase, relief_u, relief_phase))
        return
    a1, a2, damping = m.scene.pinion_inverse_mass, m.scene.gear_inverse_mass, m.scene.damping
    out[:16] = 0.0
    out[0], out[1] = cj, a1 * force_u
    gain = a1 * m.scene.speed_gain
    out[4], out[5] = -1.0, cj + a1 * damping + gain
    out[9], out[10] = a1 * force_phase, cj
    out[13], out[14], out[15] = cj + gain, -m.scene.phase_rate, cj
    if not is_stuck(m):
        out[3] = -a2 * (force_u + relief_u)
        out[7] = -a2 * damping
        out[11] = -a2 * (force_phase + relief_phase)
        out[15] += a2 * (m.scene.drag * 2.0 * abs(w) + m.scene.viscous)


@compiled_once(FRICTION)
def _jacobian_with_friction(
    m: Model, t: float, cj: float, y: Floats, out: Floats, slopes: tuple[float, float, float, float]
) -> None:
    """Jacobian with friction, from the slopes of F and Fs in u and phase that `mesh_forces` has just summed."""
    set_limits(m, t, y[W])
    s = slopes_with_friction(m, y, slopes)
    for i in range(16):
        out[i] = 0.0
    out[0], out[1], out[3] = cj, -s.pinion_u, -s.gear_u
    out[4], out[5], out[7] = -1.0, cj - s.pinion_v, -s.gear_v
    out[9], out[10], out[11] = -s.pinion_phase, cj, -s.gear_phase
    out[13], out[14], out[15] = cj - s.pinion_w, -m.scene.phase_rate, cj - s.gear_w


class AccelerationSlopes(NamedTuple):
    """Partial derivatives of the accelerations of both base circles in u, v, phase and w."""

    pinion_u: float
    pinion_v: float
    pinion_phase: float
    pinion_w: float
    gear_u: float
    gear_v: float
    gear_phase: float
    gear_w: float


@compiled
def slopes_with_friction(
    m: Model, y: Floats, slopes: tuple[float, float, float, float]
) -> AccelerationSlopes:
    """Slopes of the accelerations with friction, from those of F and Fs that `mesh_forces` has just summed."""
    f, (force_u, force_phase, relief_u, relief_phase) = friction_slopes(m, y), slopes
    drag = 2.0 * m.scene.drag * abs(y[W]) + m.scene.viscous
    gain, damping = m.scene.speed_gain, m.scene.damping
    on_pinion = (f.pinion_u - force_u, -damping - gain, f.pinion_phase - force_phase, -gain)
    on_gear = (f.gear_u + force_u + relief_u, damping, f.gear_phase + force_phase + relief_phase, -drag)
    a, b, c = f.by_pinion, f.by_both, f.by_gear
    return AccelerationSlopes(
        a * on_pinion[0] + b * on_gear[0],
        a * on_pinion[1] + b * on_gear[1] + f.pinion_v,
        a * on_pinion[2] + b * on_gear[2],
        a * on_pinion[3] + b * on_gear[3] + f.pinion_w,
        b * on_pinion[0] + c * on_gear[0],
        b * on_pinion[1] + c * on_gear[1] + f.gear_v,
        b * on_pinion[2] + c * on_gear[2],
        b * on_pinion[3] + c * on_gear[3] + f.gear_w,
    )
