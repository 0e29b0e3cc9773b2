"""The one residual F(t, y, y') = 0 that every driver integrates, and its Jacobian.

States of a gear pair, scaled (see `gearidae.engine.model.state`): u, its rate v, the gear's phase in pitches and its
surface velocity w,

    u' - v = 0,                  v' - (1 - e1) a1 (m1 - (1 - e1) F) + (1 + g1) w' + e2 w1^2 + g2 w^2 + h'' = 0,
    phase' - (sigma/pb) w = 0,   w' - a2 ((1 + g1) F + Fs - m2) = 0,

with w1 the surface velocity of the pinion, e1, e2, g1, g2 and h'' the derivatives of the mesh's error in both angles
and time (`gearidae.engine.pairs.mesh_error`), F the sum of the pairs' forces along the line of action and Fs what tip
relief adds at the gear (Teodorescu et al. 2009, Eqs. 1-6, with the tip relief doing work consistently) and, with
``mesh.radius_force``, the changing radius. A gear held by dry resistance has w' = 0. A roller at the height z is a
pinion that meets one flank of a gear that is held for good, u = -z and a2 = 0. An elastic contact adds the deflections
at its nodes, which have no rates: the system is then a DAE of index 1.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.elastic.nodes import node_residual
from gearidae.engine.model.state import PHASE, Floats, Model, U, V, W
from gearidae.engine.motion.pair_forces import mesh_forces
from gearidae.engine.motion.shafts import (
    AccelerationSlopes,
    acceleration_slopes,
    accelerations,
    note_limits,
    shafts_at,
)
from gearidae.engine.pairs.pair_force import MeshForces


@compiled(inline=True)
def motion(m: Model, t: float, y: Floats, yp: Floats, out: Floats, settling: bool) -> MeshForces:
    """F(t, y, y') of the motion, in the first numbers of `out`; the forces of the mesh are returned.

    `settling` as for `mesh_forces`; the state may then be that of the motion alone.
    """
    mesh = mesh_forces(m, t, y, settling)
    out[U] = yp[U] - y[V]
    s = shafts_at(m, t, y, mesh)
    pinion, gear = accelerations(m, t, y, s)
    out[V] = yp[V] + (1.0 + s.error.gear) * yp[W] - (1.0 - s.error.pinion) * pinion
    out[V] += (
        s.error.pinion_curvature * s.surface_speed * s.surface_speed
        + s.error.gear_curvature * y[W] * y[W]
        + s.error.acceleration
    )
    out[PHASE], out[W] = yp[PHASE] - m.scene.phase_rate * y[W], yp[W] - gear
    return mesh


@compiled
def residual(m: Model, t: float, y: Floats, yp: Floats, out: Floats) -> None:
    """F(t, y, y') in scaled states.

    Parameters
    ----------
    t : float
        Time over tau.
    y, yp, out : ndarray, shape (4,) and the nodes
        State, its rate, and where the residual goes.
    """
    motion(m, t, y, yp, out, False)
    if m.scene.nodes > 0:
        node_residual(m, y, out)


@compiled(inline=True)
def motion_slopes(m: Model, t: float, y: Floats) -> AccelerationSlopes:
    """Slopes of the accelerations at a state, at fixed deflections; the forces of the pairs are noted."""
    mesh = mesh_forces(m, t, y, False)
    if m.scene.friction.any_friction != 0:
        note_limits(m, t, y)
    return acceleration_slopes(m, y, mesh)


@compiled
def jacobian(m: Model, t: float, cj: float, y: Floats, out: Floats) -> None:
    """dF/dy + cj dF/dy' of the motion, dense, column by column (Fortran order).

    Parameters
    ----------
    t, cj : float
        Time over tau, and IDA's leading coefficient.
    y : ndarray
        State; the deflections of an elastic contact after the motion.
    out : ndarray, shape (16,)
    """
    write_jacobian(m, cj, motion_slopes(m, t, y), out)


@compiled
def write_jacobian(m: Model, cj: float, s: AccelerationSlopes, out: Floats) -> None:
    """Write the Jacobian of the residual, with given slopes of the accelerations."""
    out[:16] = 0.0
    out[0], out[1], out[3] = cj, -s.pinion_u, -s.gear_u
    out[4], out[5], out[7] = -1.0, cj - s.pinion_v, -s.gear_v
    out[9], out[10], out[11] = -s.pinion_phase, cj, -s.gear_phase
    out[13], out[14], out[15] = cj - s.pinion_w, -m.scene.phase_rate, cj - s.gear_w
