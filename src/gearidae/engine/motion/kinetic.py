"""Energy of motion."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.state import Floats, Model, W
from gearidae.engine.pairs.mesh_error import pinion_speed


@compiled
def kinetic_energy(m: Model, y: Floats) -> float:
    """Kinetic energy of both gears, scaled."""
    return energy_of_speeds(m, pinion_speed(m, y)[0], y[W])


@compiled(inline=True)
def energy_of_speeds(m: Model, pinion: float, gear: float) -> float:
    """Kinetic energy at surface velocities of both gears, scaled; what is held has none."""
    energy = 0.5 * pinion * pinion / m.scene.pinion_inverse_mass
    return energy + 0.5 * gear * gear / m.scene.gear_inverse_mass if gear != 0.0 else energy
