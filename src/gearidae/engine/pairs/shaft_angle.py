"""Angles of the shafts, which torques may depend on (Teodorescu et al. 2009, Eq. 1)."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.state import LOAD, Model
from gearidae.engine.pairs.mesh_error import error_at


@compiled
def angle_of_shaft(m: Model, shaft: int, u: float, phase: float) -> float:
    """Angle [rad] by which a shaft has turned since the start of the first run of a chain.

    Parameters
    ----------
    shaft : int
        DRIVE for the pinion, LOAD for the gear.
    u, phase : float
        Dynamic transmission error and phase, of the scaled state.
    """
    travel = (m.state.whole_pitches + phase - m.state.first_position) / m.scene.phase_rate
    if shaft != LOAD:
        travel += u - m.state.initial_pinion_lead + error_at(m, u, phase).value
    return travel * m.scene.torque[shaft].angle_unit


@compiled(inline=True)
def torque_angle(m: Model, shaft: int, u: float, phase: float) -> float:
    """Angle of a shaft for a torque that depends on it; 0 for one that does not."""
    return angle_of_shaft(m, shaft, u, phase) if m.scene.torque[shaft].takes_angle != 0 else 0.0
