"""The one residual F(t, y, y') = 0 that every driver integrates, and its Jacobian.

States of a gear pair, scaled (see `layout`): u, its rate v, the gear's phase in pitches, its surface velocity w,

    u' - v = 0,                  v' - (1 - e') a1 (m1 - (1 - e') F) + w' + e'' (phi1')^2 = 0,
    phase' - (sigma/pb) w = 0,   w' - a2 (F + Fs - m2) = 0,

with F the sum of the pairs' forces along the line of action and Fs the part that tip relief adds (Teodorescu et al.
2009, Eqs. 1-6, with the tip relief doing work consistently). A gear held by dry resistance has w' = 0. A roller has
the states z and its rate, z' - v = 0, v' - a2 F = 0. An elastic contact adds the deflections at its nodes, which
have no rates: the system is then a DAE of index 1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine.elastic.calls import node_force, node_residual
from gearidae.engine.elastic.nodes import unload
from gearidae.engine.model import layout as at
from gearidae.engine.model.tooth_pairs import (
    first_pair,
    footprint,
    history_slot,
    last_pair,
    pair_force,
    pair_gap,
    static_error,
)
from gearidae.engine.model.torque import torque_force

__all__ = ["held", "jacobian", "mesh_forces", "motion", "residual", "resisting_force", "roller_force"]

Floats = NDArray[np.float64]


@compiled
def roller_force(d: Floats, t: float, y: Floats) -> tuple[float, float]:
    """Force on a roller and its slope in the height, scaled."""
    height, speed = y[at.U], y[at.V]
    slot = int(d[at.HISTORIES])
    elastic = d[at.NODES] > 0.0
    if elastic:
        unload(d)
    if height >= d[at.CUTOFF]:
        return 0.0, 0.0
    known = d[slot + at.PAIR] == 0.0
    if elastic:
        return node_force(d, slot, known, t, y, height, speed, 1.0)
    return pair_force(d, slot, known, t, height, speed, 0.0)


@compiled(inline=True)
def mesh_forces(d: Floats, t: float, y: Floats) -> tuple[float, float, float, float, float, float]:
    """Sum the forces of all pairs within reach, with their slopes; those of an elastic contact at fixed deflection.

    Returns
    -------
    force, relief_force : float
        F and Fs, scaled.
    force_u, force_phase, relief_u, relief_phase : float
        Their partial derivatives in u and phase.
    """
    force = relief = force_u = force_phase = relief_u = relief_phase = 0.0
    u, v, phase, w = y[at.U], y[at.V], y[at.PHASE], y[at.W]
    cutoff = d[at.CUTOFF]
    elastic = d[at.NODES] > 0.0
    if elastic:
        unload(d)
    for coast in range(2):
        sign = 1.0 - 2.0 * coast
        if d[at.HALF_BACKLASH] - sign * u >= cutoff:  # tip relief only opens the gap: no pair can be in reach
            continue
        for pair in range(first_pair(d, coast, phase), last_pair(d, coast, phase) + 1):
            gap, rate, slope, inside = pair_gap(d, coast, pair, u, v, phase, w)
            if gap >= cutoff:
                continue
            slot = history_slot(d, coast, pair)
            known = d[slot + at.PAIR] == pair
            if elastic:
                load, stiffness = node_force(d, slot, known, t, y, gap, rate, footprint(d, inside))
            else:
                load, stiffness = pair_force(d, slot, known, t, gap, rate, inside)
            load *= sign
            # the gap falls with u on the drive flank and rises on the coast flank; the phase carries a coast pair
            # backwards along its path
            by_u = -stiffness
            along = slope / d[at.PHASE_RATE]
            by_phase = stiffness * along
            force += load
            force_u += by_u
            force_phase += by_phase
            if slope != 0.0:
                relief += load * slope
                relief_u += by_u * slope
                relief_phase += by_phase * slope + sign * load * d[at.RELIEF_SLOPE]
    return force, relief, force_u, force_phase, relief_u, relief_phase


@compiled
def resisting_force(d: Floats, t: float, w: float) -> float:
    """Resistance at the gear over R2, scaled: dry in the direction of slip, and drag (Eq. 2)."""
    force = d[at.DRAG] * w * abs(w)
    if d[at.DRY] != 0.0 and d[at.SLIP] != 0.0:
        force += d[at.SLIP] * max(torque_force(d, int(d[at.LOAD_AT]), t), 0.0)
    return force


@compiled
def held(d: Floats) -> bool:
    """Whether dry resistance holds the gear at rest."""
    return bool(d[at.DRY] != 0.0 and d[at.SLIP] == 0.0)


@compiled(inline=True)
def motion(d: Floats, t: float, y: Floats, yp: Floats, out: Floats) -> tuple[float, float, float, float]:
    """F(t, y, y') of the motion, in the first places of `out`, and the slopes of its forces.

    Returns
    -------
    force_u, force_phase, relief_u, relief_phase : float
        As `mesh_forces` has them; of a roller, the slope in its height and zeros.
    """
    v = y[at.V]
    out[at.U] = yp[at.U] - v
    if d[at.KIND] == at.ROLLER:
        force, slope = roller_force(d, t, y)
        out[at.V] = yp[at.V] - d[at.GEAR_SHARE] * force
        return slope, 0.0, 0.0, 0.0
    u, phase, w = y[at.U], y[at.PHASE], y[at.W]
    force, relief, force_u, force_phase, relief_u, relief_phase = mesh_forces(d, t, y)
    force += d[at.DAMPING] * v
    drive = torque_force(d, int(d[at.DRIVE_AT]), t)
    if d[at.ERROR_ORDERS] == 0.0:
        pinion = d[at.PINION_SHARE] * (drive - force)
    else:
        _, _, e1, e2 = static_error(d, u, phase)
        turn = (v + w) / (1.0 - e1)
        pinion = (1.0 - e1) * d[at.PINION_SHARE] * (drive - (1.0 - e1) * force) - e2 * turn * turn
    if held(d):
        out[at.W] = yp[at.W]
    else:
        out[at.W] = yp[at.W] - d[at.GEAR_SHARE] * (force + relief - resisting_force(d, t, w))
    out[at.V] = yp[at.V] + yp[at.W] - pinion
    out[at.PHASE] = yp[at.PHASE] - d[at.PHASE_RATE] * w
    return force_u, force_phase, relief_u, relief_phase


@compiled
def residual(d: Floats, t: float, y: Floats, yp: Floats, out: Floats) -> None:
    """F(t, y, y') in scaled states.

    Parameters
    ----------
    d : ndarray
        The scene, see `layout`.
    t : float
        Time over tau.
    y, yp, out : ndarray, shape (4,) or (2,), and the nodes
        State, its rate, and where the residual goes.
    """
    motion(d, t, y, yp, out)
    if d[at.NODES] > 0.0:
        node_residual(d, y, out)


@compiled
def jacobian(d: Floats, t: float, cj: float, y: Floats, out: Floats) -> None:
    """dF/dy + cj dF/dy' of the motion, dense, column by column (Fortran order).

    The static error's own slopes are left out: it is small, and the Jacobian only steers Newton's iteration.

    Parameters
    ----------
    d : ndarray
        The scene, see `layout`.
    t, cj : float
        Time over tau, and IDA's leading coefficient.
    y : ndarray
        State; the deflections of an elastic contact after the motion.
    out : ndarray, shape (16,) or (4,)
    """
    if d[at.KIND] == at.ROLLER:
        _, slope = roller_force(d, t, y)
        out[0], out[1] = cj, -d[at.GEAR_SHARE] * slope
        out[2], out[3] = -1.0, cj
        return
    w = y[at.W]
    _, _, force_u, force_phase, relief_u, relief_phase = mesh_forces(d, t, y)
    a1, a2, damping = d[at.PINION_SHARE], d[at.GEAR_SHARE], d[at.DAMPING]
    out[:16] = 0.0
    out[0], out[1] = cj, a1 * force_u
    out[4], out[5] = -1.0, cj + a1 * damping
    out[9], out[10] = a1 * force_phase, cj
    out[13], out[14], out[15] = cj, -d[at.PHASE_RATE], cj
    if not held(d):
        out[3] = -a2 * (force_u + relief_u)
        out[7] = -a2 * damping
        out[11] = -a2 * (force_phase + relief_phase)
        out[15] += a2 * d[at.DRAG] * 2.0 * abs(w)
