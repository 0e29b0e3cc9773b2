"""Largest and smallest force, from the equations of motion: the accelerations of accepted steps tell it."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.state import DRIVE, PHASE, ROLLER, Floats, Model, U, V, W
from gearidae.engine.model.tooth_pairs import in_flight, static_error
from gearidae.engine.model.torque import torque_force

__all__ = ["first_force", "follow_force", "force_of_motion"]


@compiled(inline=True)
def force_of_motion(m: Model, t: float, y: Floats, yp: Floats) -> float:
    """Force along the line of action, mesh damping included, that the pinion's acceleration tells; of a roller, on it.

    See `gearidae.engine.model.residual`, whose first equation is solved for the force.
    """
    if m.scene.kind == ROLLER:
        return 0.0 if in_flight(m) else yp[V] / m.scene.gear_inverse_mass
    if in_flight(m):
        return m.scene.damping * y[V]
    acceleration, turn = yp[V] + yp[W], y[V] + y[W]
    if m.scene.error_count == 0:
        return torque_force(m, DRIVE, t, turn) - acceleration / m.scene.pinion_inverse_mass
    _, _, e1, e2 = static_error(m, y[U], y[PHASE])
    turn /= 1.0 - e1
    drive = torque_force(m, DRIVE, t, turn)
    pinion = (acceleration + e2 * turn * turn) / ((1.0 - e1) * m.scene.pinion_inverse_mass)
    return (drive - pinion) / (1.0 - e1)


@compiled
def first_force(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Note the force at a start."""
    force, e = force_of_motion(m, t, y, yp), m.state.extremes
    if e.begun == 0:
        e.largest_force = e.smallest_force = force
        e.largest_force_time = e.smallest_force_time = t
    _corner(m, t, force)


@compiled(inline=True)
def follow_force(m: Model, t: float, y: Floats, yp: Floats, corner: bool) -> None:
    """Follow the force to an accepted time; at an event it may have a corner, over which no parabola is laid."""
    k, force = m.work.track, force_of_motion(m, t, y, yp)
    if k.forces > 1:
        before, middle = k.force[1], k.force[2]
        if (middle - before) * (force - middle) < 0.0:
            _note_vertex(m, t, force)
    if corner:
        _corner(m, t, force)
        return
    k.forces += 1
    for i in range(2):
        k.force_time[i], k.force[i] = k.force_time[i + 1], k.force[i + 1]
    k.force_time[2], k.force[2] = t, force


@compiled
def _corner(m: Model, t: float, force: float) -> None:
    """Note a force that nothing before it is to be joined with."""
    k = m.work.track
    k.forces, k.force_time[2], k.force[2] = 1, t, force
    _note_force(m, t, force)


@compiled
def _note_vertex(m: Model, t: float, force: float) -> None:
    """Note the vertex of the parabola through the last three forces, of which the middle one sticks out."""
    k = m.work.track
    t0, t1, f0, f1 = k.force_time[1], k.force_time[2], k.force[1], k.force[2]
    first, second = (f1 - f0) / (t1 - t0), (force - f1) / (t - t1)
    bend = (second - first) / (t - t0)
    vertex = 0.5 * (t0 + t1 - first / bend)
    _note_force(m, vertex, f0 + (vertex - t0) * (first + bend * (vertex - t1)))


@compiled
def _note_force(m: Model, t: float, force: float) -> None:
    e = m.state.extremes
    if force > e.largest_force:
        e.largest_force, e.largest_force_time = force, t
    if force < e.smallest_force:
        e.smallest_force, e.smallest_force_time = force, t
