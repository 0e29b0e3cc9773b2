"""From scaled states to what is recorded, in SI units: the columns of `gearidae.records.columns`."""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.model.state import PHASE, ROLLER, Floats, Model, U, V, W
from gearidae.engine.motion.residual import mesh_forces, roller_force
from gearidae.engine.motion.separation import separation
from gearidae.engine.pairs.tooth_pairs import all_pairs, pair_at, pair_gap, static_error
from gearidae.engine.population.forces import asperities_joined
from gearidae.records import GEAR_COLUMNS, ROLLER_COLUMNS

__all__ = ["observe"]

_GEARS: Final = len(GEAR_COLUMNS)
_ROLLER: Final = len(ROLLER_COLUMNS)


@compiled_once(SOLVER)
def observe(m: Model, t: float, y: Floats, row: Floats) -> None:
    """Write one sample.

    Parameters
    ----------
    m : Model
        With the histories as they are at t.
    t : float
        Time over tau.
    y : ndarray, shape (n,)
        Scaled state.
    row : ndarray, shape (n,)
        `GEAR_SAMPLES` or `ROLLER_SAMPLES`, and of elastic contacts `ELASTIC_SAMPLES`, in SI units.
    """
    length, speed = m.scene.length_unit, m.scene.length_unit / m.scene.time_unit
    u, v = y[U], y[V]
    if m.scene.kind == ROLLER:
        force, _ = roller_force(m, t, y, False)
        row[0], row[1], row[2] = u * length, v * speed, force * m.scene.force_unit
        if m.scene.population.flanks != 0:
            row[_ROLLER] = asperities_joined(m)[0]
        elif row.size > _ROLLER:
            row[_ROLLER] = separation(m, y) * length
        return
    phase, w = y[PHASE], y[W]
    force, relief, _, _, _, _ = mesh_forces(m, t, y, False)
    force += m.scene.damping * v
    e1 = 0.0
    if m.scene.error_count != 0:
        _, _, e1, _ = static_error(m, u, phase)
    radius = m.scene.gear_radius
    row[0] = w * speed / radius
    row[1] = (v + w) * speed / (m.scene.pinion_radius * (1.0 - e1))
    row[2] = (m.state.turns + phase) * m.scene.base_pitch / radius
    row[3] = u * length
    row[4] = force * m.scene.force_unit
    row[5] = radius * (force + relief) * m.scene.force_unit
    touching = 0.0
    row[6] = row[7] = math.inf
    reach = all_pairs(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        gap, _, _, _ = pair_gap(m, coast, pair, u, v, phase, w)
        row[6 + coast] = min(row[6 + coast], gap * length)
        if gap < m.scene.contact_gap:
            touching += 1.0
    row[8] = touching
    if m.scene.population.flanks != 0:
        row[_GEARS], row[8] = asperities_joined(m)
    elif row.size > _GEARS:
        row[_GEARS] = separation(m, y) * length
