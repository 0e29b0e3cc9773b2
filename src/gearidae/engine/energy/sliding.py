"""Sliding work of a pair, from one look at its power to the next.

Between two looks the power is taken as the cubic with its values and rates. An interval is divided where the power
changes its sign in it, or the sliding speed at the pitch point, and where a contact passes from one place to the next.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.energy.places import place_at, share_at_edge
from gearidae.engine.energy.quadrature import error_estimate, integral
from gearidae.engine.extremes.interpolation import cubic
from gearidae.engine.model.state import MATERIALS, PHASE, Floats, Model, U, V, W
from gearidae.engine.model.tooth_pairs import static_error

__all__ = ["add_sliding", "sliding_speeds", "speeds_here"]

SLIDING = 2 * MATERIALS
"""Its place among the quantities."""
PARTS = 16
"""Parts of an interval in which a contact begins or ceases to push, or passes the pitch point."""


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
    """Add the sliding work of a pair up to a time, and go on from there.

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
    side = 1
    if speed < 0.0:
        side, speed, speed_rate = -1, -speed, -speed_rate
    power, power_rate = force[0] * speed, force[1] * speed + force[0] * speed_rate
    at, h = place_at(m, inside), t - own.time
    if power > 0.0 or own.power > 0.0 or _rises(h, own.power, own.power_rate, power, power_rate):
        work = integral(h, own.power, power, own.power_rate, power_rate)
        pushes = power >= 0.0 and own.power >= 0.0
        if at == own.at and side == own.side:
            if not pushes:
                work = _pushing_partly(h, own.power, own.power_rate, power, power_rate)
            m.rows[own.row + SLIDING * m.scene.places + at] += max(work, 0.0)
        elif pushes and side == own.side:
            _divide(m, k, h, inside, max(work, 0.0), (power, power_rate))
        else:
            work = _add_parts(m, k, h, inside, side, (power, power_rate))
        m.work.exposing.work += work
        m.work.exposing.error += error_estimate(h, own.power, power, own.power_rate, power_rate)
    own.time, own.place, own.at = t, inside, at
    own.power, own.power_rate, own.side = power, power_rate, side
    own.gap, own.gap_rate = gap


@compiled(inline=True)
def _rises(h: float, power0: float, rate0: float, power1: float, rate1: float) -> bool:
    """Whether the cubic of a power may be above zero between ends that pull: one of its control points is."""
    third = h / 3.0
    return rate0 > 0.0 > rate1 and max(power0 + third * rate0, power1 - third * rate1) > 0.0


@compiled
def _divide(m: Model, k: int, h: float, inside: float, work: float, there: tuple[float, float]) -> None:
    """Divide the work of an interval in which a contact pushes between places, by the integral of its power's cubic.

    Parameters
    ----------
    m : Model
    k : int
        Index of the pair's history.
    h : float
        Length of the interval.
    inside : float
        Place on the path of contact at its end, in pitches.
    work : float
        Of the whole interval.
    there : tuple of float
        Power at its end, and its rate.
    """
    own, end = m.work.exposing.pair[k], place_at(m, inside)
    row, at, before = own.row + SLIDING * m.scene.places, own.at, 0.0
    step = 1 if inside > own.place else -1
    while at != end:
        share = share_at_edge(m, at, own.place, inside)
        until = min(max(_work_until(share, h, own.power, own.power_rate, there[0], there[1]), before), work)
        m.rows[row + at] += until - before
        at, before = at + step, until
    m.rows[row + at] += work - before


@compiled(inline=True)
def _work_until(s: float, h: float, power0: float, rate0: float, power1: float, rate1: float) -> float:
    """Integral of a power's cubic over a share of an interval."""
    rise, slope0, slope1 = power1 - power0, h * rate0, h * rate1
    a, b = slope0 + slope1 - 2.0 * rise, 3.0 * rise - 2.0 * slope0 - slope1
    return h * s * (power0 + s * (slope0 / 2.0 + s * (b / 3.0 + s * a / 4.0)))


@compiled
def _pushing_partly(h: float, power0: float, rate0: float, power1: float, rate1: float) -> float:
    """Work of an interval in which a contact begins or ceases to push: of the power's cubic, what is above zero."""
    total = 0.0
    for part in range(PARTS):
        total += max(cubic((part + 0.5) / PARTS, h, power0, rate0, power1, rate1), 0.0)
    return h * total / PARTS


@compiled
def _add_parts(m: Model, k: int, h: float, inside: float, side: int, there: tuple[float, float]) -> float:
    """Add the work of an interval in which the power changes its sign, or the sliding speed does; it is returned.

    Of the cubic of force times signed speed counts what a pushing contact makes of it.

    Parameters
    ----------
    m, k, h, inside, there
        As for `_divide`.
    side : int
        Sign of the sliding speed at the end.
    """
    own = m.work.exposing.pair[k]
    row, way = own.row + SLIDING * m.scene.places, inside - own.place
    power0, rate0 = own.side * own.power, own.side * own.power_rate
    power1, rate1 = side * there[0], side * there[1]
    pushes, total = own.power >= 0.0 and there[0] >= 0.0, 0.0
    for part in range(PARTS):
        s = (part + 0.5) / PARTS
        power = cubic(s, h, power0, rate0, power1, rate1)
        if not pushes:
            power *= own.side if s < 0.5 else side
        elif side != own.side:
            power = abs(power)
        work = max(power, 0.0) * h / PARTS
        m.rows[row + place_at(m, own.place + s * way)] += work
        total += work
    return total
