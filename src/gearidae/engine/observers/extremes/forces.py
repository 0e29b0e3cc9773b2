"""Largest and smallest force: of accepted steps from the equations of motion, between them from the contact law.

Most extremes of the force lie where a pair turns round, which is an event and hence an accepted time. What is left are
maxima of adhesion, passed within a few steps. A parabola through three accepted forces shows whether one was passed
that may be a record, of the run or since the last mesh exit. Only then the force is looked at between these times: the
rates of the step's formula give it, to some 1e-5 of it, and with it where the extreme lies. What may be a record of the
run by that is evaluated there by the contact law, once, as an extreme does not notice how far beside it that is.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled
from gearidae.engine import adams
from gearidae.engine.laws.pairs import mesh_force
from gearidae.engine.model.state import DRIVE, PHASE, Floats, Model, Record, U, V, W
from gearidae.engine.motion.pair_forces import forces_at
from gearidae.engine.pairs.mesh_error import pinion_acceleration, speed_and_error
from gearidae.engine.pairs.orbit import follow_orbit
from gearidae.engine.pairs.shaft_angle import torque_angle
from gearidae.engine.pairs.tooth_pairs import in_flight
from gearidae.formulas.interpolation import cubic, quintic, vertex
from gearidae.laws.shafts import pinion_force

NEAR_RECORD: Final = 0.1
"""Share of a record by which the parabola may miss it: it has been seen to be out by 3 % at loose tolerances."""
NEARER_RECORD: Final = 0.01
"""The same for the parabola through a force that the step's formula gives."""
EVALUATIONS: Final = 3
"""Number of forces evaluated between accepted times where no formula of the step gives them."""
FLANKS: Final = 2
_CLOSE: Final = 1e-3
"""Share of the span over which two evaluations are alike: the force changes by a millionth of its own."""


@compiled(inline=True)
def force_of_motion(m: Model, t: float, y: Floats, yp: Floats, known: float) -> float:
    """Force along the line of action, mesh damping included, from the pinion's acceleration.

    See `gearidae.engine.motion.residual`, whose first equation is solved for the force. Friction acts on the pinion,
    too: with it the contact law is asked, unless the force is `known` and not NaN.
    """
    follow_orbit(m, t)
    if in_flight(m):
        return mesh_force(m, y[V], 0.0)
    if m.scene.friction.any_friction != 0:
        return float(force_of_law(m, t, y)) if math.isnan(known) else known
    surface_speed, e = speed_and_error(m, y)
    drive = pinion_force(m, t, torque_angle(m, DRIVE, y[U], y[PHASE]), surface_speed)
    acceleration = pinion_acceleration(e, surface_speed, y[W], yp[V], yp[W])
    return (drive - acceleration / m.scene.pinion_inverse_mass) / (1.0 - e.pinion)


@compiled
def first_force(m: Model, t: float, force: float) -> None:
    """Note the force at a start."""
    e = m.state.extremes
    if e.begun == 0:
        e.largest_force = e.smallest_force = force
        e.largest_force_time = e.smallest_force_time = t
    _note_force(m, t, force)


@compiled
def note_corner(m: Model, point: Record, y: Floats) -> None:
    """Note the force at an event.

    The state at an event within a step is that of the step's polynomial, whose rates go over the corner that the force
    may have there: where it may be a record the contact law is asked. The error test has seen what the corner leaves.
    """
    force, (largest, smallest) = point.force, _records(m)
    margin = (NEARER_RECORD if m.work.adams.order_used > 1 else NEAR_RECORD) * abs(force)
    if force + margin > largest or force - margin < smallest:
        force = force_of_law(m, point.time, y)
    _note_force(m, point.time, force)


@compiled(inline=True)
def follow_force(m: Model, before: Record, last: Record, now: Record, between: tuple[Floats, Floats]) -> None:
    """Follow the force over three successive accepted times, between which it has no corner.

    Parameters
    ----------
    before, last, now : record
        ``POINT`` of these times.
    between : tuple of two ndarrays, shape (n,)
        Work space.
    """
    # times a b (a + b), the slopes at both ends of the parabola through the three forces
    a, b = last.time - before.time, now.time - last.time
    rise, next_rise = b * (last.force - before.force), a * (now.force - last.force)
    curvature = next_rise - rise
    if (rise * (a + b) - curvature * a) * (next_rise * (a + b) + curvature * b) < 0.0:
        _search_between(m, before, last, now, between)
        follow_orbit(m, now.time)


@compiled
def _search_between(
    m: Model, before: Record, last: Record, now: Record, between: tuple[Floats, Floats]
) -> None:
    """Look for a record of the force near the vertex of the parabola through three accepted ones.

    Each force that is found takes the place of the outer point that is further away.
    """
    t0, f0, t1, f1, t2, f2 = before.time, before.force, last.time, last.force, now.time, now.force
    t, force, curvature = vertex(t0, f0, t1, f1, t2, f2)
    e = m.state.extremes
    record = e.largest_force if curvature < 0.0 else e.smallest_force
    if not _is_near(force, record, curvature, NEAR_RECORD):
        largest, smallest = _records(m)
        # the parabola is out by less than what it adds to the accepted forces
        farthest = 2.0 * force - (max(f0, f1, f2) if curvature < 0.0 else min(f0, f1, f2))
        if smallest <= farthest <= largest:
            return
    if m.scene.nodes > 0:  # their deflections between accepted times are not known
        _note_force(m, t, force)
        return
    by_law, least = m.work.adams.order_used < 2, _CLOSE * (now.time - before.time)
    for _ in range(EVALUATIONS if by_law else 1):
        if by_law:
            force = _force_between(m, before, last, now, t, between[0])
            _note_force(m, t, force)
        else:
            adams.between(m.work.adams, t, between[0], between[1])
            force = force_of_motion(m, t, between[0], between[1], math.nan)
        at, found = t, force
        if t - t0 > t2 - t:
            t0, f0 = t, force
        else:
            t2, f2 = t, force
        if min(abs(t1 - t0), abs(t1 - t2)) < least:
            break
        t, force, _ = vertex(t0, f0, t1, f1, t2, f2)
        if not before.time < t < now.time:
            t, force = at, found
            break
    if by_law:
        return
    if _is_near(force, record, curvature, NEARER_RECORD):
        force = _force_between(m, before, last, now, t, between[0])
    _note_force(m, t, force)


@compiled(inline=True)
def _is_near(force: float, record: float, curvature: float, share: float) -> bool:
    """Whether an extreme that is bent so is beyond a record, or misses it by no more than a share of it."""
    return bool((force - record) * curvature <= share * abs(record * curvature))


@compiled
def _force_between(m: Model, before: Record, last: Record, now: Record, t: float, y: Floats) -> float:
    """Force at a time between accepted ones, by the contact law; `y` is overwritten."""
    p, q = (before, last) if t < last.time else (last, now)
    h = q.time - p.time
    s = (t - p.time) / h
    y[U] = quintic(
        s,
        h,
        (p.travel, p.travel_rate, p.travel_acceleration),
        (q.travel, q.travel_rate, q.travel_acceleration),
    )
    y[V] = cubic(s, h, p.travel_rate, p.travel_acceleration, q.travel_rate, q.travel_acceleration)
    scale = m.scene.phase_rate
    y[PHASE] = cubic(s, h, p.position, scale * p.speed, q.position, scale * q.speed) - m.state.whole_pitches
    y[W] = cubic(s, h, p.speed, p.speed_rate, q.speed, q.speed_rate)
    return float(force_of_law(m, t, y))


@compiled
def force_of_law(m: Model, t: float, y: Floats) -> float:
    """Force at a state, by the contact law, mesh damping included."""
    return float(mesh_force(m, y[V], forces_at(m, t, y).force))


@compiled
def _note_force(m: Model, t: float, force: float) -> None:
    e = m.state.extremes
    if force > e.largest_force:
        e.largest_force, e.largest_force_time = force, t
    if force < e.smallest_force:
        e.smallest_force, e.smallest_force_time = force, t
    if m.scene.follow.passages != 0:
        for flank in range(FLANKS):
            note_since(m, flank, force)


@compiled
def note_since(m: Model, flank: int, force: float) -> None:
    """Note a force since the last mesh exit of a flank; one that is out of reach has none."""
    p = m.state.passage[flank]
    if m.state.flank_in_reach[flank] == 0:
        force = 0.0
    if p.begun == 0:
        p.begun, p.largest_force, p.smallest_force = 1, force, force
    p.largest_force, p.smallest_force = max(p.largest_force, force), min(p.smallest_force, force)


@compiled
def _records(m: Model) -> tuple[float, float]:
    """Largest and smallest force so far: of the run, or since the last mesh exits where these are kept."""
    if m.scene.follow.passages == 0:
        return m.state.extremes.largest_force, m.state.extremes.smallest_force
    largest, smallest = math.inf, -math.inf
    for flank in range(FLANKS):
        if m.state.flank_in_reach[flank] != 0:
            largest = min(largest, m.state.passage[flank].largest_force)
            smallest = max(smallest, m.state.passage[flank].smallest_force)
    return largest, smallest
