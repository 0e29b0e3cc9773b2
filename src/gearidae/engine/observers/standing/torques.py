"""Torques on gears at rest or free, at any time of the run: between two knots those of the piece between them."""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.friction.forces import NO_FORCE
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import DRIVE, LOAD, SCHEDULES, Model
from gearidae.formulas.roots import HALVINGS, bisected
from gearidae.laws.frictions import law_limit, least_law_limit, resists
from gearidae.laws.shaft.own import SHIFT
from gearidae.laws.shaft.schedule import straight_until
from gearidae.laws.shafts import acting, driving_force, driving_range

LOOKS_AHEAD: Final = 4096
"""Times at most, besides knots of schedules, at which a run that is to stop looks at what is still to come."""
_PARTS: Final = 32
"""Of a piece in which all torques are straight, for the time in which the drive exceeds the load."""


@compiled
def _angle(m: Model, shaft: int, position: float, pinion_lead: float) -> float:
    """Angle of a shaft [rad] of a gear at a position [pb] whose pinion leads [sigma]."""
    if m.scene.torque[shaft].takes_angle == 0:
        return 0.0
    way = (position - m.state.first_position) / m.scene.phase_rate
    return (way + (pinion_lead if shaft != LOAD else 0.0)) * m.scene.torque[shaft].angle_unit


@compiled
def resistance(m: Model, t: float, position: float, pinion_lead: float) -> float:
    """Limit of the set-valued laws of both shafts at rest, scaled."""
    total = law_limit(m, LOAD, t, _angle(m, LOAD, position, 0.0), 0.0) if resists(m, LOAD) else 0.0
    if resists(m, DRIVE):
        total += law_limit(m, DRIVE, t, _angle(m, DRIVE, position, pinion_lead), 0.0)
    return float(total)


@compiled
def _acting(m: Model, t: float, position: float, pinion_lead: float, speed: float) -> float:
    """What acts on both shafts besides the driving torque and set-valued laws, scaled."""
    m.work.elsewhere = 1  # laws have no memory of these shafts
    force = acting(m, LOAD, t, _angle(m, LOAD, position, pinion_lead), speed, -0.0)
    if m.scene.torque[DRIVE].acts != 0:
        force = acting(m, DRIVE, t, _angle(m, DRIVE, position, pinion_lead), speed, force)
    m.work.elsewhere = 0
    return float(force)


@compiled_once(SOLVER)
def push(m: Model, t: float, position: float, pinion_lead: float, speed: float) -> float:
    """What drives gears that turn as one against the set-valued laws, scaled."""
    drive = driving_force(m, DRIVE, t, _angle(m, DRIVE, position, pinion_lead), speed)
    return float(drive + _acting(m, t, position, pinion_lead, speed))


@compiled
def excess(m: Model, t: float, position: float, pinion_lead: float) -> float:
    """Size of what drives a gear at rest, less what resists it, scaled."""
    return abs(push(m, t, position, pinion_lead, 0.0)) - resistance(m, t, position, pinion_lead)


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
def slowest_period_at(address: int) -> float:
    """`slowest_period`, for Python."""
    return slowest_period(model_at(address))


# -- at another time than that of the run ----------------------------------------------------------------------------


@compiled
def _enter_piece(m: Model, begin: float, end: float) -> tuple[int, int, int, float, float]:
    """Set segments of schedules and the window of laws to a piece between two knots; return the run's own."""
    s, w = m.state, m.work
    kept = (s.segment[0], s.segment[1], s.segment[2], w.law_from, w.law_until)
    for which in range(SCHEDULES):
        schedule = m.scene.schedule[which]
        step, count = (schedule.knot_count - 1, 2) if schedule.cubic != 0 else (1, schedule.knot_count)
        low, high = 0, count  # knots before `low` have passed, those from `high` on have not
        while low < high:
            middle = (low + high) // 2
            if m.tables[schedule.knots_at + 2 * step * middle] <= begin:
                low = middle + 1
            else:
                high = middle
        s.segment[which] = low
    w.law_from, w.law_until = begin * (1.0 + SHIFT), end * (1.0 - SHIFT)
    return kept


@compiled
def _go_back(m: Model, kept: tuple[int, int, int, float, float]) -> None:
    """Set segments and window of the run again."""
    s, w = m.state, m.work
    s.segment[0], s.segment[1], s.segment[2], w.law_from, w.law_until = kept


@compiled
def free_acceleration(
    address: int,
    begin: float,
    end: float,
    t: float,
    position: float,
    pinion_lead: float,
    speed: float,
    sign: float,
) -> float:
    """Acceleration [pb/tau^2] of free gears that turn in a direction.

    Parameters
    ----------
    address : int
        Of the model, from `gearidae.engine.model.addresses.Addresses`.
    begin, end : float
        Knots between which the time lies, over tau.
    t : float
        Over tau.
    position, pinion_lead : float
        Of the gear [pb], and of the pinion [sigma].
    speed : float
        [pb/tau].
    sign : float
        Of the direction.
    """
    m = model_at(address)
    kept = _enter_piece(m, begin, end)
    rate = m.scene.phase_rate
    force = push(m, t, position, pinion_lead, speed / rate)
    force -= sign * resistance(m, t, position, pinion_lead)
    _go_back(m, kept)
    return rate * force / (1.0 / m.scene.pinion_inverse_mass + 1.0 / m.scene.gear_inverse_mass)


@compiled
def _rests(t: float, m: Model, position: float, pinion_lead: float) -> bool:
    """Whether the set-valued laws hold a gear at rest."""
    return bool(excess(m, t, position, pinion_lead) - NO_FORCE <= 0.0)


_end_of_rest = bisected(_rests)


@compiled
def rest_of(
    address: int, piece: tuple[float, float], t: float, at: tuple[float, float]
) -> tuple[float, float]:
    """Time from `t` on at which a drive overcomes what resists gears at rest, and what drives them then.

    At most that of the end of the piece, with 0.

    Parameters
    ----------
    place, t
        As for `free_acceleration`.
    piece : tuple of two floats
        Knots between which the time lies, over tau.
    at : tuple of two floats
        Position of the gear [pb] and lead of the pinion [sigma].
    """
    m = model_at(address)
    kept = _enter_piece(m, piece[0], piece[1])
    end, longest = piece[1], m.scene.free_step if m.scene.free_step > 0.0 else math.inf
    rests = _rests(t, m, at[0], at[1])
    while rests and t < end:
        after = min(straight_until(m, t, end), t + longest)
        if not _rests(after, m, at[0], at[1]):
            t = _end_of_rest(t, after, HALVINGS, 0.0, m, at[0], at[1])[1]
            rests = False
        else:
            t = after
    force = 0.0 if rests else push(m, t, at[0], at[1], 0.0)
    _go_back(m, kept)
    return t, force


@compiled
def drive_between(
    address: int, piece: tuple[float, float], t: float, to: float, at: tuple[float, float]
) -> tuple[float, float]:
    """By how much, scaled, and how long, over tau, the drive exceeds what resists a gear that stands.

    Arguments as for `rest_of`.
    """
    m = model_at(address)
    kept = _enter_piece(m, piece[0], piece[1])
    largest, lasts, longest = 0.0, 0.0, (to - t) / _PARTS
    if m.scene.free_step > 0.0:
        longest = min(longest, m.scene.free_step)
    first = excess(m, t, at[0], at[1]) - NO_FORCE
    while t < to:
        after = min(straight_until(m, t, to), t + longest)
        if not after > t:
            break
        last = excess(m, after, at[0], at[1]) - NO_FORCE
        share = 0.0
        if first > 0.0 and last > 0.0:
            share = 1.0
        elif first > 0.0 or last > 0.0:
            share = max(first, last) / abs(first - last)
        largest = max(largest, first, last)
        lasts += share * (after - t)
        t, first = after, last
    _go_back(m, kept)
    return largest, lasts


@compiled
def drive_at(address: int, piece: tuple[float, float], t: float, at: tuple[float, float]) -> float:
    """Driving torque on a pinion at rest over its base radius, scaled; arguments as for `rest_of`."""
    m = model_at(address)
    kept = _enter_piece(m, piece[0], piece[1])
    force = driving_force(m, DRIVE, t, _angle(m, DRIVE, at[0], at[1]), 0.0)
    _go_back(m, kept)
    return force


@compiled
def _bound_of_excess(m: Model, t: float, at: tuple[float, float]) -> float:
    """Bound of the excess at rest at a time: harmonics have their amplitudes, laws their present values."""
    low, high = driving_range(m, DRIVE, t, t, _angle(m, DRIVE, at[0], at[1]))
    held = _acting(m, t, at[0], at[1], 0.0)
    load = least_law_limit(m, LOAD, t, _angle(m, LOAD, at[0], 0.0)) if resists(m, LOAD) else 0.0
    if resists(m, DRIVE):
        load += least_law_limit(m, DRIVE, t, _angle(m, DRIVE, at[0], at[1]))
    return max(abs(low + held), abs(high + held)) - load


@compiled
def hardest_in(
    address: int, piece: tuple[float, float], t: float, to: float, at: tuple[float, float]
) -> tuple[float, float]:
    """Time at which the drive exceeds the load most, and by how much at most then; arguments as for `rest_of`."""
    m = model_at(address)
    kept = _enter_piece(m, piece[0], piece[1])
    longest = math.inf
    if m.scene.free_step > 0.0:
        longest = max(m.scene.free_step, (m.scene.end - m.scene.start) / LOOKS_AHEAD)
    most, time = _bound_of_excess(m, t, at), t
    while t < to:
        t = min(straight_until(m, t, to), t + longest)
        size = _bound_of_excess(m, t, at)
        if size > most + 1e-9 * abs(most):
            most, time = size, t
    _go_back(m, kept)
    return time, most
