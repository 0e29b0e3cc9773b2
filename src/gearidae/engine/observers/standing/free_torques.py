"""Torques on free gears, at any time of the run: the schedules' segments are set for it and put back."""

from __future__ import annotations

import math

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.model.state import DRIVE, LOAD, SCHEDULES, Model
from gearidae.laws.shafts import acting, driving_force, driving_range


@compiled
def _angle(m: Model, i: int, shaft: int, travel: float) -> float:
    """Angle of a shaft [rad] of free gears that have travelled so far from a zero [pb]."""
    if m.scene.torque[shaft].takes_angle == 0:
        return 0.0
    z = m.state.standing.zero[i]
    way = (z.position + travel - m.state.first_place) / m.scene.phase_rate
    if shaft != LOAD:
        way += z.lead
    return way * m.scene.torque[shaft].angle_unit


@compiled_once(SOLVER)
def free_torque(m: Model, i: int, shaft: int, t: float, travel: float, speed: float) -> float:
    """Torque of a shaft over its base radius, scaled, of free gears from the zero `i`; the load's is dry resistance."""
    if shaft == LOAD and m.scene.dry == 0:
        return 0.0
    until, m.work.law_until = m.work.law_until, 0.0  # laws at any time, not in the present piece
    torque = driving_force(m, shaft, t, _angle(m, i, shaft, travel), speed)
    m.work.law_until = until
    return torque if shaft != LOAD else max(torque, 0.0)


@compiled
def acting_on_free(m: Model, i: int, t: float, travel: float, speed: float) -> float:
    """What acts on both shafts of free gears besides the driving torque and the dry resistance, scaled."""
    m.work.elsewhere = 1  # laws have no memory of these shafts
    force = acting(m, LOAD, t, _angle(m, i, LOAD, travel), speed, -0.0)
    if m.scene.torque[DRIVE].acts != 0:
        force = acting(m, DRIVE, t, _angle(m, i, DRIVE, travel), speed, force)
    m.work.elsewhere = 0
    return float(force)


@compiled
def push_on_free(m: Model, i: int, t: float, travel: float) -> float:
    """What pushes free gears at rest against the dry resistance, scaled."""
    return float(free_torque(m, i, DRIVE, t, travel, 0.0) + acting_on_free(m, i, t, travel, 0.0))


@compiled
def excess(m: Model, i: int, t: float) -> float:
    """Size of what pushes a gear that stands at a zero, less the dry resistance, scaled."""
    return abs(push_on_free(m, i, t, 0.0)) - free_torque(m, i, LOAD, t, 0.0, 0.0)


@compiled
def largest_excess(m: Model, i: int, t: float, to: float, travel: float) -> float:
    """Bound of the excess at rest over a time in which schedules go one way, with all harmonics at their amplitudes.

    Of a law the bound is that of its present value.
    """
    low, high = driving_range(m, DRIVE, t, to, _angle(m, i, DRIVE, 0.0))
    held = acting_on_free(m, i, t, travel, 0.0)
    low, high = low + held, high + held
    load = driving_range(m, LOAD, t, to, _angle(m, i, LOAD, 0.0))[0] if m.scene.dry != 0 else 0.0
    return max(abs(low), abs(high)) - max(load, 0.0)


@compiled
def slowest_period(m: Model) -> float:
    """Period of the slowest harmonic of both torques, over tau; 0 without any."""
    longest = 0.0
    for shaft in range(2):
        torque = m.scene.torque[shaft]
        for k in range(torque.harmonic_count):
            at = torque.harmonics_at + 3 * k
            if m.tables[at] != 0.0 and m.tables[at + 1] != 0.0:
                longest = max(longest, 2.0 * math.pi / abs(m.tables[at + 1]))
    return longest


@compiled
def enter_segments(m: Model, t: float, end: float) -> float:
    """Set the segments of all schedules for a time, and return when the next begins, at most `end`."""
    for which in range(SCHEDULES):
        schedule = m.scene.schedule[which]
        step, count = (schedule.knot_count - 1, 2) if schedule.cubic != 0 else (1, schedule.knot_count)
        low, high = 0, count  # knots before `low` have passed, those from `high` on have not
        while low < high:
            middle = (low + high) // 2
            if m.tables[schedule.knots_at + 2 * step * middle] <= t:
                low = middle + 1
            else:
                high = middle
        m.state.segment[which] = low
        if low < count:
            end = min(end, m.tables[schedule.knots_at + 2 * step * low])
    return end
