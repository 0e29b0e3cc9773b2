"""Work of the drive through the centre of a pinion that orbits in its hub.

The force of the drive carries the pinion's centre round, and with it the teeth along the forces of the mesh: with what
the orbit adds to the error of the mesh, h, and to the gaps of the coast flank, k, it does the work
``-F h' - F_c k'`` in a time, F along the line of action and F_c of the pairs of the coast flank.
"""

from __future__ import annotations

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import FRICTION
from gearidae.engine.friction.pairs import rate_of_force, set_limits
from gearidae.engine.laws.pairs import mesh_by_rate, mesh_force
from gearidae.engine.model.state import Floats, Model, V, W
from gearidae.engine.motion.pair_forces import follow_slopes, forces_at
from gearidae.engine.pairs.tooth_pairs import flank_of_history, in_flight
from gearidae.formulas.quadrature import error_estimate, integral


@compiled
def _power(m: Model, t: float, y: Floats, yp: Floats) -> tuple[float, float]:
    """Power of the moving centre, and its rate; the forces of the pairs are noted."""
    force, rate, coast_force, coast_rate = mesh_force(m, y[V], 0.0), mesh_by_rate(m, 0.0) * yp[V], 0.0, 0.0
    if not in_flight(m):
        forces_at(m, t, y)
        if m.scene.nodes > 0:
            follow_slopes(m, t, y, 0.0, y)
        set_limits(m, t, y[W])
        for i in range(m.work.pair_forces.count):
            noted = m.work.pair_forces.pair[i]
            flank = flank_of_history(m, noted.history)
            changes = rate_of_force(m, noted, y[W], yp[V], yp[W])
            force += (1.0 - 2.0 * flank) * noted.force
            rate += (1.0 - 2.0 * flank) * changes
            coast_force += flank * noted.force
            coast_rate += flank * changes
    o = m.work.orbit
    power = -force * o.error_rate - coast_force * o.play_rate
    return power, -(
        rate * o.error_rate
        + force * o.error_acceleration
        + coast_rate * o.play_rate
        + coast_force * o.play_acceleration
    )


@compiled_once(FRICTION)
def begin_orbit(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Note the power at a start, where it may jump."""
    o = m.work.orbit
    o.work_time = t
    o.power, o.power_rate = _power(m, t, y, yp)


@compiled_once(FRICTION)
def book_orbit(m: Model, t: float, y: Floats, yp: Floats) -> float:
    """Add the work of the orbit in a step to the work of the drive; return its magnitude."""
    o, e = m.work.orbit, m.state.energy
    h, first, first_rate = t - o.work_time, o.power, o.power_rate
    begin_orbit(m, t, y, yp)
    work = integral(h, first, o.power, first_rate, o.power_rate)
    e.drive_work += work
    e.loss_error += error_estimate(h, first, o.power, first_rate, o.power_rate)
    return abs(work)
