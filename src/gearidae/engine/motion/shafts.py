"""Forces at both shafts of a scene with friction, at any state."""

from __future__ import annotations

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import FRICTION
from gearidae.engine.friction.forces import dry_force, solve_shafts, without_drag
from gearidae.engine.friction.pairs import direction, levers, set_limits
from gearidae.engine.model.record_types import AT_REST, HELD_GEAR, HELD_PAIR
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


@compiled_once(FRICTION)
def friction_at_gear(m: Model, t: float, y: Floats) -> tuple[float, float]:
    """Force of the flanks' friction on the gear, and what resists it besides its hub: drags and dry resistance.

    At rest, where the shares of several elements are not unique, the flanks' is zero and the dry resistance takes what
    it can.
    """
    turn, pinion, gear = forces_at_shafts(m, t, y)
    found = solve_shafts(m, t, y, turn, pinion, gear)
    friction = 0.0
    for i in range(m.work.notes.count if m.scene.friction.flanks != 0 else 0):
        noted = m.work.notes.pair[i]
        second = levers(m, noted.position)[1]
        friction += direction(m, noted) * noted.limit * second
        if m.state.hold == HELD_PAIR and noted.history == m.state.held_pair:
            friction += found.held * second
    w, dry = y[W], dry_force(m, t, y)
    drags = m.scene.drag * w * abs(w) + m.scene.viscous * w
    if m.state.hold == AT_REST or m.state.hold == HELD_GEAR:
        return friction, drags + min(max(gear + friction, -dry), dry)
    return friction, drags + m.state.slip * dry
