"""Sliding work and largest pressure of a pair, from one look at its force to the next."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.energy.places import divide, note_pressure, place_at
from gearidae.engine.energy.quadrature import error_estimate, integral
from gearidae.engine.extremes.interpolation import cubic
from gearidae.engine.model.state import MATERIALS, PHASE, Floats, Model, U, V, W
from gearidae.engine.model.tooth_pairs import static_error

__all__ = ["PRESSURE", "add_sliding", "sliding_speeds", "speeds_here"]

SLIDING, PRESSURE = 2 * MATERIALS, 2 * MATERIALS + 1
"""Places of their sums among the quantities."""
PARTS = 16
"""Parts of an interval in which a contact begins or ceases to push."""


@compiled(inline=True)
def sliding_speeds(m: Model, y: Floats, v_rate: float, w_rate: float) -> tuple[float, float, float]:
    """Sliding speed a pitch from the pitch point, its rate, and how fast a contact moves along the path."""
    s = m.scene
    turn, turn_rate = y[V] + y[W], v_rate + w_rate
    if s.error_count != 0:
        turn /= 1.0 - static_error(m, y[U], y[PHASE])[2]
    speed = s.sliding_pinion * turn + s.sliding_gear * y[W]
    return speed, s.sliding_pinion * turn_rate + s.sliding_gear * w_rate, s.phase_rate * y[W]


@compiled
def speeds_here(m: Model, y: Floats) -> tuple[float, float, float]:
    """Do the same at the accepted time that is being dealt with, whose rates the extremes have noted."""
    point = m.work.track.point[m.work.track.last]
    return sliding_speeds(m, y, point.travel_bend, point.speed_rate)


@compiled(inline=True)
def add_sliding(
    m: Model,
    t: float,
    k: int,
    sliding: tuple[float, float, float],
    inside: float,
    gap: tuple[float, float],
    force: tuple[float, float],
) -> None:
    """Add the sliding work of a pair up to a time, note its pressure, and go on from there.

    Parameters
    ----------
    m : Model
    t : float
        Time over tau.
    k : int
        Index of the pair's history.
    sliding : tuple of float
        See `sliding_speeds`.
    inside : float
        Place on the path of contact, in pitches.
    gap, force : tuple of float
        Gap and force, each with its rate.
    """
    own, away = m.work.exposing.pair[k], inside - m.scene.pitch_point
    speed, speed_rate = sliding[0] * away, sliding[1] * away
    if 0.0 < inside < m.scene.contact_ratio:
        speed_rate += sliding[0] * (sliding[2] if k < m.scene.slots else -sliding[2])
    if speed < 0.0:
        speed, speed_rate = -speed, -speed_rate
    power, power_rate = force[0] * speed, force[1] * speed + force[0] * speed_rate
    at, h = place_at(m, inside), t - own.time
    if power > 0.0 or own.power > 0.0 or _rises(h, own.power, own.power_rate, power, power_rate):
        work = _pushing(h, own.power, own.power_rate, power, power_rate)
        m.work.exposing.work += work
        m.work.exposing.error += error_estimate(h, own.power, power, own.power_rate, power_rate)
        row = own.row + SLIDING * m.scene.places
        if at == own.at:
            m.rows[row + at] += work
        else:
            divide(m, row, own.place, inside, work)
        if force[0] > 0.0:
            note_pressure(m, own.row + PRESSURE * m.scene.places + at, inside, force[0])
    if at != own.at:
        if own.force > 0.0 or force[0] > 0.0:
            _note_crossings(m, t, k, inside, force)
        own.lowest = m.scene.cutoff  # another place
    own.time, own.place, own.at, own.power, own.power_rate = t, inside, at, power, power_rate
    own.gap, own.gap_rate = gap
    own.force, own.force_rate = force


@compiled(inline=True)
def _rises(h: float, power0: float, rate0: float, power1: float, rate1: float) -> bool:
    """Whether the cubic of a power may be above zero between ends that pull: one of its control points is."""
    third = h / 3.0
    return rate0 > 0.0 > rate1 and max(power0 + third * rate0, power1 - third * rate1) > 0.0


@compiled
def _note_crossings(m: Model, t: float, k: int, inside: float, force: tuple[float, float]) -> None:
    """Note the pressure where a pair has passed from one place to the next, on the cubic of its force.

    Parameters
    ----------
    m, t, k, inside, force
        As for `add_sliding`.
    """
    own, scale = m.work.exposing.pair[k], m.scene.places_per_pitch
    at, row = place_at(m, inside), own.row + PRESSURE * m.scene.places
    for place in range(min(own.at, at) + 1, max(own.at, at) + 1):
        edge = place / scale
        share = (edge - own.place) / (inside - own.place)
        pressing = cubic(share, t - own.time, own.force, own.force_rate, force[0], force[1])
        if pressing > 0.0:
            note_pressure(m, row + place - 1, edge, pressing)
            note_pressure(m, row + place, edge, pressing)


@compiled(inline=True)
def _pushing(h: float, power0: float, rate0: float, power1: float, rate1: float) -> float:
    """Sliding work over an interval of a contact while it pushes."""
    if power0 >= 0.0 and power1 >= 0.0:
        return max(integral(h, power0, power1, rate0, rate1), 0.0)
    return _pushing_partly(h, power0, rate0, power1, rate1)


@compiled
def _pushing_partly(h: float, power0: float, rate0: float, power1: float, rate1: float) -> float:
    """Do the same where it begins or ceases to push: of the power's cubic, what is above zero."""
    rise, slope0, slope1 = power1 - power0, h * rate0, h * rate1
    a, b = slope0 + slope1 - 2.0 * rise, 3.0 * rise - 2.0 * slope0 - slope1
    total = 0.0
    for part in range(PARTS):
        s = (part + 0.5) / PARTS
        total += max(power0 + s * (slope0 + s * (b + s * a)), 0.0)
    return h * total / PARTS
