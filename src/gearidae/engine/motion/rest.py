"""Forces on a gear at rest: what the mesh pushes with, and what dry resistance holds."""

from __future__ import annotations

from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.model.state import LOAD, Floats, Model, U, V
from gearidae.engine.motion.residual import mesh_forces
from gearidae.engine.torques.torque import torque_force

__all__ = ["NO_FORCE", "holding_force", "is_pulled_back", "push_at_rest"]

NO_FORCE: Final = 1e-12
"""Of the reference load: less than this neither holds a gear nor moves it from rest."""


@compiled_once(SOLVER)
def push_at_rest(m: Model, t: float, y: Floats) -> float:
    """Force on a gear at rest, from the mesh."""
    force, relief, _, _, _, _ = mesh_forces(m, t, y, False)
    return force + m.scene.damping * y[V] + relief


@compiled
def holding_force(m: Model, t: float) -> float:
    """Largest force with which dry resistance holds a gear at rest."""
    return max(torque_force(m, LOAD, t, 0.0), 0.0)


@compiled_once(SOLVER)
def is_pulled_back(m: Model, t: float, y: Floats) -> bool:
    """Whether the drive flank pulls a gear back whose speed falls to zero, by more than dry resistance holds."""
    damping = m.scene.damping * y[V]
    pull = damping - push_at_rest(m, t, y)
    hold = holding_force(m, t) + NO_FORCE if m.scene.dry != 0 else 0.0
    return bool(y[U] > 0.0 and pull > max(damping + hold, 0.0))
