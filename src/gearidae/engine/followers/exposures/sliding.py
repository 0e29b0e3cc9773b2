"""Sliding work of a pair, from one look at its power to the next.

Between two looks the power is taken as the cubic with its values and rates. An interval is divided where the power
changes its sign in it, or the sliding speed at the pitch point, and where a contact passes from one place to the next.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.followers.exposures.places import place_at, share_at_edge
from gearidae.engine.formulas.interpolation import cubic, cubic_slope
from gearidae.engine.formulas.quadrature import error_estimate, integral
from gearidae.engine.model.state import MATERIALS, PHASE, Floats, Model, U, V, W
from gearidae.engine.pairs.tooth_pairs import static_error

__all__ = ["add_sliding", "sliding_speeds"]

SLIDING = 2 * MATERIALS
"""Its place among the quantities."""
PARTS = 16
"""Parts of an interval in which a contact passes the pitch point, or pushes between ends that pull."""


@compiled(inline=True)
def sliding_speeds(m: Model, y: Floats, v_rate: float, w_rate: float) -> tuple[float, float, float]:
    """Sliding speed a pitch from the pitch point, its rate, and how fast a contact moves along the path."""
    s = m.scene
    turn, turn_rate = y[V] + y[W], v_rate + w_rate
    if s.error_count != 0:
        turn /= 1.0 - static_error(m, y[U], y[PHASE])[2]
    speed = s.sliding_pinion * turn + s.sliding_gear * y[W]
    return speed, s.sliding_pinion * turn_rate + s.sliding_gear * w_rate, s.phase_rate * y[W]


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
    pushes, turns = max(power, own.power) > 0.0, side != own.side
    if pushes or (not turns and _rises(h, own.power, own.power_rate, power, power_rate)):
        if pushes and not turns:
            work = _add_pushing(m, k, h, inside, (power, power_rate))
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


@compiled(inline=True)
def _add_pushing(m: Model, k: int, h: float, inside: float, there: tuple[float, float]) -> float:
    """Add the work of an interval in which a contact pushes, or begins or ceases to; it is returned.

    Parameters
    ----------
    m : Model
    k : int
        Index of the pair's history.
    h : float
        Length of the interval.
    inside : float
        Place on the path of contact at its end, in pitches.
    there : tuple of float
        Power at its end, and its rate.
    """
    own = m.work.exposing.pair[k]
    work, begins, ceases = integral(h, own.power, there[0], own.power_rate, there[1]), 0.0, 1.0
    if min(own.power, there[0]) < 0.0:
        zero = _zero(h, own.power, own.power_rate, there[0], there[1])
        until = _work_until(zero, h, own.power, own.power_rate, there[0], there[1])
        if own.power > 0.0:
            work, ceases = until, zero
        else:
            work, begins = work - until, zero
    work = max(work, 0.0)
    if place_at(m, inside) == own.at:
        m.rows[own.row + SLIDING * m.scene.places + own.at] += work
    else:
        _divide(m, k, h, inside, there, (work, begins, ceases))
    return work


@compiled
def _divide(
    m: Model,
    k: int,
    h: float,
    inside: float,
    there: tuple[float, float],
    pushing: tuple[float, float, float],
) -> None:
    """Divide the work of an interval between places, by the integral of its power's cubic.

    Parameters
    ----------
    m, k, h, inside, there
        As for `_add_pushing`.
    pushing : tuple of float
        Work of the whole interval, and the shares of the interval at which the contact begins and ceases to push.
    """
    own, end, (work, begins, ceases) = m.work.exposing.pair[k], place_at(m, inside), pushing
    row, at, done = own.row + SLIDING * m.scene.places, own.at, 0.0
    before = _work_until(begins, h, own.power, own.power_rate, there[0], there[1])
    step = 1 if inside > own.place else -1
    while at != end:
        share = min(max(share_at_edge(m, at, own.place, inside), begins), ceases)
        until = _work_until(share, h, own.power, own.power_rate, there[0], there[1]) - before
        until = min(max(until, done), work)
        m.rows[row + at] += until - done
        at, done = at + step, until
    m.rows[row + at] += work - done


@compiled(inline=True)
def _work_until(s: float, h: float, power0: float, rate0: float, power1: float, rate1: float) -> float:
    """Integral of a power's cubic over a share of an interval."""
    rise, slope0, slope1 = power1 - power0, h * rate0, h * rate1
    a, b = slope0 + slope1 - 2.0 * rise, 3.0 * rise - 2.0 * slope0 - slope1
    return h * s * (power0 + s * (slope0 / 2.0 + s * (b / 3.0 + s * a / 4.0)))


@compiled(inline=True)
def _zero(h: float, power0: float, rate0: float, power1: float, rate1: float) -> float:
    """Share of an interval at which a power's cubic changes its sign: a step of Newton's method from the chord's zero.

    What is left of the error counts with its square, as the power is zero there.
    """
    s = power0 / (power0 - power1)
    slope = cubic_slope(s, h, power0, rate0, power1, rate1)
    if slope * (power1 - power0) <= 0.0:
        return s
    return min(max(s - cubic(s, h, power0, rate0, power1, rate1) / slope, 0.0), 1.0)


@compiled
def _add_parts(m: Model, k: int, h: float, inside: float, side: int, there: tuple[float, float]) -> float:
    """Add the work of an interval in which the sliding speed changes its sign, or a pair pushes between ends that pull.

    Of the cubic of force times signed speed counts what a pushing contact makes of it. The work is returned.

    Parameters
    ----------
    m, k, h, inside, there
        As for `_add_pushing`.
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
