"""How far dry resistance holds a gear, and what pushes or pulls it."""

from __future__ import annotations

from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.model.state import LOAD, PHASE, Floats, Model, U, V
from gearidae.engine.motion.pair_forces import forces_at
from gearidae.engine.pairs.shaft_angle import torque_angle
from gearidae.engine.torques.torque import torque_force

NO_FORCE: Final = 1e-12
"""Of the reference load: less than this neither holds a gear nor moves it from rest."""


@compiled
def dry_limit(m: Model, t: float, y: Floats) -> float:
    """Largest force with which dry resistance holds a gear at rest."""
    angle = torque_angle(m, LOAD, y[U], y[PHASE])
    return max(torque_force(m, LOAD, t, angle, 0.0), 0.0)


@compiled_once(SOLVER)
def push_on_gear(m: Model, t: float, y: Floats) -> float:
    """Force of the mesh on a gear at rest, damping included."""
    mesh = forces_at(m, t, y)
    return mesh.force + m.scene.damping * y[V] + mesh.relief


@compiled_once(SOLVER)
def is_pulled_back(m: Model, t: float, y: Floats) -> bool:
    """Whether the drive flank pulls a gear back whose speed falls to zero, by more than dry resistance holds."""
    mesh = forces_at(m, t, y)
    pull = -(mesh.force + mesh.relief)
    held_up_to = m.scene.damping * y[V] + (dry_limit(m, t, y) + NO_FORCE if m.scene.dry != 0 else 0.0)
    return bool(y[U] > 0.0 and pull > max(held_up_to, 0.0))
