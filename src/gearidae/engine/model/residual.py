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

from gearidae.compiled import compiled
from gearidae.engine.elastic.calls import node_force, node_residual
from gearidae.engine.elastic.nodes import mark_out_of_reach
from gearidae.engine.energy.noted_force import begin_notes, note_force
from gearidae.engine.energy.radius import radius_force
from gearidae.engine.model.coverage import WHOLE, note_shares, shares_of
from gearidae.engine.model.state import DRIVE, LOAD, PHASE, ROLLER, Floats, Model, U, V, W
from gearidae.engine.model.tooth_pairs import (
    contact_length,
    history_of,
    pair_at,
    pair_force,
    pair_gap,
    pairs_touching,
    static_error,
)
from gearidae.engine.model.torque import torque_force

__all__ = ["held", "jacobian", "mesh_forces", "motion", "residual", "resisting_force", "roller_force"]


@compiled
def roller_force(m: Model, t: float, y: Floats) -> tuple[float, float]:
    """Force on a roller and its slope in the height, scaled."""
    height, speed = y[U], y[V]
    elastic = m.scene.nodes > 0
    if elastic:
        mark_out_of_reach(m)
    if height >= m.scene.cutoff:
        return 0.0, 0.0
    known = m.state.history[0].pair == 0
    if elastic:
        return node_force(m, 0, known, t, y, height, speed, 1.0)
    return pair_force(m, 0, known, t, height, speed, 0.0, WHOLE)


@compiled(inline=True)
def mesh_forces(m: Model, t: float, y: Floats) -> tuple[float, float, float, float, float, float]:
    """Sum the forces of all pairs within reach, with their slopes; those of an elastic contact at fixed deflection.

    Returns
    -------
    force, relief_force : float
        F and Fs, scaled.
    force_u, force_phase, relief_u, relief_phase : float
        Their partial derivatives in u and phase.
    """
    force = relief = force_u = force_phase = relief_u = relief_phase = 0.0
    u, v, phase, w = y[U], y[V], y[PHASE], y[W]
    cutoff = m.scene.cutoff
    elastic = m.scene.nodes > 0
    if elastic:
        mark_out_of_reach(m)
    if m.work.notes.wanted != 0:
        begin_notes(m, t, u)
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
            load, stiffness = node_force(m, k, known, t, y, gap, rate, contact_length(m, inside))
        else:
            shares = shares_of(m, k, coast, pair, inside)
            load, stiffness = pair_force(m, k, known, t, gap, rate, inside, shares)
            if m.work.notes.wanted != 0:
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
            load, by_u, by_phase = radius_force(m, t, y, coast, pair, k, gap, rate)
            relief += load
            relief_u += by_u
            relief_phase += by_phase
    return force, relief, force_u, force_phase, relief_u, relief_phase


@compiled
def resisting_force(m: Model, t: float, w: float) -> float:
    """Resistance at the gear over R2, scaled: dry in the direction of slip, and both drags (Eq. 2)."""
    force = m.scene.drag * w * abs(w) + m.scene.viscous * w
    if m.scene.dry != 0 and m.state.slip != 0.0:
        force += m.state.slip * max(torque_force(m, LOAD, t, w), 0.0)
    return force


@compiled
def held(m: Model) -> bool:
    """Whether dry resistance holds the gear at rest."""
    return bool(m.scene.dry != 0 and m.state.slip == 0.0)


@compiled(inline=True)
def motion(m: Model, t: float, y: Floats, yp: Floats, out: Floats) -> tuple[float, float, float, float]:
    """F(t, y, y') of the motion, in the first places of `out`, and the slopes of its forces.

    Returns
    -------
    force_u, force_phase, relief_u, relief_phase : float
        As `mesh_forces` has them; of a roller, the slope in its height and zeros.
    """
    v = y[V]
    out[U] = yp[U] - v
    if m.scene.kind == ROLLER:
        force, slope = roller_force(m, t, y)
        out[V] = yp[V] - m.scene.gear_inverse_mass * force
        return slope, 0.0, 0.0, 0.0
    u, phase, w = y[U], y[PHASE], y[W]
    force, relief, force_u, force_phase, relief_u, relief_phase = mesh_forces(m, t, y)
    force += m.scene.damping * v
    turn, e1, e2 = v + w, 0.0, 0.0
    if m.scene.error_count != 0:
        _, _, e1, e2 = static_error(m, u, phase)
        turn = (v + w) / (1.0 - e1)
    drive = torque_force(m, DRIVE, t, turn)
    if m.scene.error_count == 0:
        pinion = m.scene.pinion_inverse_mass * (drive - force)
    else:
        pinion = (1.0 - e1) * m.scene.pinion_inverse_mass * (drive - (1.0 - e1) * force) - e2 * turn * turn
    if held(m):
        out[W] = yp[W]
    else:
        out[W] = yp[W] - m.scene.gear_inverse_mass * (force + relief - resisting_force(m, t, w))
    out[V] = yp[V] + yp[W] - pinion
    out[PHASE] = yp[PHASE] - m.scene.phase_rate * w
    return force_u, force_phase, relief_u, relief_phase


@compiled
def residual(m: Model, t: float, y: Floats, yp: Floats, out: Floats) -> None:
    """F(t, y, y') in scaled states.

    Parameters
    ----------
    m : Model
    t : float
        Time over tau.
    y, yp, out : ndarray, shape (4,) or (2,), and the nodes
        State, its rate, and where the residual goes.
    """
    motion(m, t, y, yp, out)
    if m.scene.nodes > 0:
        node_residual(m, y, out)


@compiled
def jacobian(m: Model, t: float, cj: float, y: Floats, out: Floats) -> None:
    """dF/dy + cj dF/dy' of the motion, dense, column by column (Fortran order).

    The static error's own slopes are left out: it is small, and the Jacobian only steers Newton's iteration. So are the
    slopes of a torque law in the speed: a shaft takes many steps to follow a mild law, and each iteration reduces what
    is left by the ratio of a step to that time. A drive that holds a speed is not mild, and its slope is there.

    Parameters
    ----------
    m : Model
    t, cj : float
        Time over tau, and IDA's leading coefficient.
    y : ndarray
        State; the deflections of an elastic contact after the motion.
    out : ndarray, shape (16,) or (4,)
    """
    if m.scene.kind == ROLLER:
        _, slope = roller_force(m, t, y)
        out[0], out[1] = cj, -m.scene.gear_inverse_mass * slope
        out[2], out[3] = -1.0, cj
        return
    w = y[W]
    _, _, force_u, force_phase, relief_u, relief_phase = mesh_forces(m, t, y)
    a1, a2, damping = m.scene.pinion_inverse_mass, m.scene.gear_inverse_mass, m.scene.damping
    out[:16] = 0.0
    out[0], out[1] = cj, a1 * force_u
    gain = a1 * m.scene.speed_gain
    out[4], out[5] = -1.0, cj + a1 * damping + gain
    out[9], out[10] = a1 * force_phase, cj
    out[13], out[14], out[15] = cj + gain, -m.scene.phase_rate, cj
    if not held(m):
        out[3] = -a2 * (force_u + relief_u)
        out[7] = -a2 * damping
        out[11] = -a2 * (force_phase + relief_phase)
        out[15] += a2 * (m.scene.drag * 2.0 * abs(w) + m.scene.viscous)
