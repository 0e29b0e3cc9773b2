"""From scaled states to what is recorded, in SI units: the columns of `gearidae.records.columns`.

The smallest distance of the flanks among them is of rigid flanks in the gap, of elastic ones anywhere along a contact.
"""

from __future__ import annotations

import math

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.elastic.node_rows import first_unknown
from gearidae.engine.friction.ageing import coefficients
from gearidae.engine.laws.discrete import asperities_joined
from gearidae.engine.laws.pairs import mesh_force
from gearidae.engine.model.record_types import FREE
from gearidae.engine.model.state import DRIVE, GEARS, LOAD, PHASE, Floats, Model, U, V, W
from gearidae.engine.motion.pair_forces import forces_at
from gearidae.engine.motion.shafts import friction_at_gear, resisting_force
from gearidae.engine.pairs.mesh_error import pinion_speed
from gearidae.engine.pairs.shaft_angle import angle_of_shaft, torque_angle
from gearidae.engine.pairs.tooth_pairs import (
    all_pairs,
    flank_gaps,
    gap_and_rate,
    history_of,
    pair_at,
    rigid_separation,
)
from gearidae.laws.pair_law import in_reach
from gearidae.laws.shafts import driving_force, write_samples
from gearidae.records.columns import GEAR, GEAR_POPULATION, ROLLER, ROLLER_POPULATION


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
    mesh = forces_at(m, t, y)
    force = mesh_force(m, v, mesh.force)
    if m.scene.kind != GEARS:
        row[ROLLER.height] = -u * length
        row[ROLLER.speed] = -v * speed
        row[ROLLER.force] = force * m.scene.force_unit
        if m.scene.population.flanks != 0:
            row[ROLLER_POPULATION.asperities_in_contact] = asperities_joined(m)[0]
        elif row.size > ROLLER.min_separation:
            row[ROLLER.min_separation] = separation(m, y) * length
        return
    phase, w = y[PHASE], y[W]
    (surface_speed, e), radius = pinion_speed(m, y), m.scene.gear_radius
    row[GEAR.gear_speed] = w * speed / radius
    row[GEAR.pinion_speed] = surface_speed * speed / m.scene.pinion_radius
    row[GEAR.gear_angle] = angle_of_shaft(m, LOAD, u, phase)
    row[GEAR.transmission_error] = u * length
    row[GEAR.mesh_force] = force * m.scene.force_unit
    contact, width = (1.0 + e.gear) * force + mesh.relief, row.size - m.scene.law_columns
    if m.scene.friction.any_friction != 0:
        friction, resistance, loads = friction_at_gear(m, t, y)
        contact += friction
        width -= _write_joints(m, loads, t, y, row[:width])
    elif m.state.hold == FREE:
        resistance = resisting_force(m, t, y)
    else:
        resistance = contact
    row[GEAR.gear_contact_torque] = radius * contact * m.scene.force_unit
    drive_gap, coast_gap, touching = flank_gaps(m, y)
    row[GEAR.drive_gap], row[GEAR.coast_gap] = drive_gap * length, coast_gap * length
    row[GEAR.pairs_in_contact] = touching
    unit = m.scene.force_unit
    drive = driving_force(m, DRIVE, t, torque_angle(m, DRIVE, u, phase), surface_speed)
    row[GEAR.drive_torque] = drive * unit * m.scene.pinion_radius
    row[GEAR.load_torque] = resistance * unit * radius
    row[GEAR.pinion_angle] = angle_of_shaft(m, DRIVE, u, phase)
    if m.scene.law_columns != 0:
        column = write_samples(
            m, DRIVE, t, row[GEAR.pinion_angle], surface_speed, row, row.size - m.scene.law_columns
        )
        write_samples(m, LOAD, t, row[GEAR.gear_angle], w, row, column)
    if m.scene.population.flanks != 0:
        row[GEAR_POPULATION.asperities_in_contact], row[GEAR.pairs_in_contact] = asperities_joined(m)
    elif width > GEAR.min_separation:
        row[GEAR.min_separation] = separation(m, y) * length


@compiled
def _write_joints(m: Model, loads: tuple[float, float, float], t: float, y: Floats, row: Floats) -> int:
    """Write loads and ageing coefficients of the joints, which are a row's last columns; how many they are."""
    if m.scene.friction.joints == 0:
        return 0
    count, ages = 2 + m.scene.friction.forced, m.scene.friction.ages
    first = row.size - (1 + ages) * count
    for i in range(count):
        row[first + i] = abs(loads[i]) * m.scene.force_unit
    if ages != 0:
        values = coefficients(m, t, y)
        for i in range(count):
            row[first + count + i] = values[i]
    return (1 + ages) * count


@compiled_once(SOLVER)
def separation(m: Model, y: Floats) -> float:
    """Smallest distance of the flanks at a state, deflection included, scaled."""
    if m.scene.nodes == 0:
        return rigid_separation(m, y[U], y[PHASE])
    least = math.inf
    reach = all_pairs(m, y)
    for i in range(reach.total):
        flank, pair = pair_at(reach, i)
        k = history_of(m, flank, pair)
        gap, _ = gap_and_rate(m, flank, pair, y)
        if not in_reach(m, gap) or m.state.history[k].pair != pair:
            least = min(least, gap)
            continue
        first = first_unknown(m, k)
        for node in range(m.scene.nodes):
            least = min(least, gap + m.tables[m.scene.profile_at + node] + y[first + node])
    return least
