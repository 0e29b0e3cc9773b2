"""Energy of motion."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.state import PHASE, Floats, Model, U, V, W
from gearidae.engine.pairs.tooth_pairs import static_error


@compiled
def kinetic_energy(m: Model, y: Floats) -> float:
    """Kinetic energy of both gears, scaled."""
    pinion = y[V] + y[W]
    if m.scene.error_count != 0:
        pinion /= 1.0 - static_error(m, y[U], y[PHASE])[2]
    return energy_of_speeds(m, pinion, y[W])


@compiled(inline=True)
def energy_of_speeds(m: Model, pinion: float, gear: float) -> float:
    """Kinetic energy at surface velocities of both gears, scaled; what is held has none."""
    energy = 0.5 * pinion * pinion / m.scene.pinion_inverse_mass
    return energy + 0.5 * gear * gear / m.scene.gear_inverse_mass if gear != 0.0 else energy
