"""Energy of motion."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.state import PHASE, ROLLER, Floats, Model, U, V, W
from gearidae.engine.pairs.tooth_pairs import static_error


@compiled
def kinetic_energy(m: Model, y: Floats) -> float:
    """Kinetic energy of both gears, or of the roller, scaled."""
    if m.scene.kind == ROLLER:
        return 0.5 * y[V] * y[V] / m.scene.gear_inverse_mass
    pinion = y[V] + y[W]
    if m.scene.error_count != 0:
        pinion /= 1.0 - static_error(m, y[U], y[PHASE])[2]
    return 0.5 * pinion * pinion / m.scene.pinion_inverse_mass + 0.5 * y[W] * y[W] / m.scene.gear_inverse_mass
