"""Forces at both shafts of a scene with friction, at any state."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.friction.forces import Shafts, solve_shafts, without_drag
from gearidae.engine.friction.pairs import set_limits
from gearidae.engine.model.state import DRIVE, PHASE, Floats, Model, U, V, W
from gearidae.engine.motion.residual import mesh_forces
from gearidae.engine.pairs.shaft_angle import torque_angle
from gearidae.engine.pairs.tooth_pairs import static_error
from gearidae.engine.torques.torque import torque_force


@compiled
def pinion_speed(m: Model, y: Floats) -> tuple[float, float]:
    """Surface velocity of the pinion, and the slope of the static error."""
    if m.scene.error_count == 0:
        return y[V] + y[W], 0.0
    e1 = static_error(m, y[U], y[PHASE])[2]
    return (y[V] + y[W]) / (1.0 - e1), e1


@compiled
def forces_at_shafts(m: Model, t: float, y: Floats) -> tuple[float, float, float]:
    """Surface velocity of the pinion, and the forces at both base circles without friction and dry resistance.

    The forces of the pairs are noted, with the limits of their friction.
    """
    force, relief, _, _, _, _ = mesh_forces(m, t, y, False)
    set_limits(m, t, y[W])
    force += m.scene.damping * y[V]
    turn, e1 = pinion_speed(m, y)
    drive = torque_force(m, DRIVE, t, torque_angle(m, DRIVE, y[U], y[PHASE]), turn)
    return turn, drive - (1.0 - e1) * force, without_drag(m, force + relief, y[W])


@compiled
def shafts_at(m: Model, t: float, y: Floats) -> Shafts:
    """What both shafts do at a state, with the present directions of slip; see `solve_shafts`."""
    turn, pinion, gear = forces_at_shafts(m, t, y)
    return solve_shafts(m, t, y, turn, pinion, gear)
