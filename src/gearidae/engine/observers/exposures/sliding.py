"""Sliding work of a pair, from one look at its power to the next: over one to six accepted steps of rigid bodies.

Between two looks the power is taken as the cubic with its values and rates. An interval is divided where the power
changes its sign in it, or the sliding speed at the pitch point, and where a contact passes from one bin to the next.

The number of steps follows from the error estimate of the interval before, as an integrator chooses its steps. An
interval ends with the step in which a force is expected to pass zero: a contact that pulls does no sliding work, and
where the integral begins or ceases in between, it is the better the shorter the interval is. Where more than 600 steps
go to a pitch, an interval is no longer than a hundredth of a pitch.

Pressures are looked at where an interval ends, and just after a contact has left its bin: a cubic, which gives the
pressure at the edge, is most accurate close to its ends. Sliding work goes on from there, so that its sum does not
depend on the number of bins.
"""

from __future__ import annotations

import math

from gearidae.compiled import compiled
from gearidae.engine.model.state import Floats, Model, W
from gearidae.engine.observers.exposures.bins import ROWS, bin_at, share_at_edge
from gearidae.engine.pairs.mesh_error import pinion_acceleration, pinion_speed
from gearidae.formulas.interpolation import cubic, cubic_slope
from gearidae.formulas.quadrature import error_estimate, integral

PARTS = 16
"""Parts of an interval in which a contact passes the pitch point, or pushes between ends that pull."""

MOST_STEPS = 6
"""Accepted steps in an interval, where its error estimate allows."""
ALLOWED = 1e-3
"""Error estimate of sliding work, over the mean work of as many steps."""
LENGTHENING = 2.0
"""How much longer than an interval the next one is where no error is estimated, and how much shorter at the utmost."""
FADING = 0.9
"""What is left of the work of former intervals and of their steps, from one interval to the next."""
PER_PITCH = 100.0
"""Intervals in a pitch, at least, where there are as many steps: as pairs meet, forces change within half of one."""


@compiled(inline=True)
def sliding_speeds(m: Model, y: Floats, v_rate: float, w_rate: float) -> tuple[float, float, float]:
    """Sliding speed a pitch from the pitch point, its rate, and how fast a contact moves along the path."""
    s = m.scene
    surface_speed, e = pinion_speed(m, y)
    surface_acceleration = pinion_acceleration(e, surface_speed, y[W], v_rate, w_rate)
    speed = s.sliding_pinion * surface_speed + s.sliding_gear * y[W]
    return speed, s.sliding_pinion * surface_acceleration + s.sliding_gear * w_rate, s.phase_rate * y[W]


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
    t : float
        Time over tau.
    k : int
        Index of the pair's history.
    sliding : tuple of float
        See `sliding_speeds`.
    inside : float
        Position on the path of contact, in pitches.
    gap, force : tuple of float
        Gap and force, each with its rate.
    """
    exposure, away = m.work.exposing.pair[k], inside - m.scene.pitch_point
    speed, speed_rate = sliding[0] * away, sliding[1] * away
    if 0.0 < inside < m.scene.contact_ratio:
        speed_rate += sliding[0] * (sliding[2] if k < m.scene.slots else -sliding[2])
    side = 1
    if speed < 0.0:
        side, speed, speed_rate = -1, -speed, -speed_rate
    power, power_rate = force[0] * speed, force[1] * speed + force[0] * speed_rate
    here, h = bin_at(m, inside), t - exposure.time
    pushes, turns = max(power, exposure.power) > 0.0, side != exposure.side
    if pushes or (not turns and _rises(h, exposure.power, exposure.power_rate, power, power_rate)):
        if pushes and not turns:
            work = _add_pushing(m, k, h, inside, (power, power_rate))
        else:
            work = _add_parts(m, k, h, inside, side, (power, power_rate))
        m.work.exposing.work += work
        m.work.exposing.error += error_estimate(h, exposure.power, power, exposure.power_rate, power_rate)
    exposure.time, exposure.position, exposure.bin = t, inside, here
    exposure.power, exposure.power_rate, exposure.side = power, power_rate, side
    exposure.gap, exposure.gap_rate = gap


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
    k : int
        Index of the pair's history.
    h : float
        Length of the interval.
    inside : float
        Position on the path of contact at its end, in pitches.
    there : tuple of float
        Power at its end, and its rate.
    """
    exposure = m.work.exposing.pair[k]
    work, begins, ceases = integral(h, exposure.power, there[0], exposure.power_rate, there[1]), 0.0, 1.0
    if min(exposure.power, there[0]) < 0.0:
        zero = _zero(h, exposure.power, exposure.power_rate, there[0], there[1])
        until = _work_until(zero, h, exposure.power, exposure.power_rate, there[0], there[1])
        if exposure.power > 0.0:
            work, ceases = until, zero
        else:
            work, begins = work - until, zero
    work = max(work, 0.0)
    if bin_at(m, inside) == exposure.bin:
        m.rows[exposure.row + ROWS.sliding * m.scene.bins + exposure.bin] += work
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
    """Divide the work of an interval between bins, by the integral of its power's cubic.

    Parameters
    ----------
    m, k, h, inside, there
        As for `_add_pushing`.
    pushing : tuple of float
        Work of the whole interval, and the shares of the interval at which the contact begins and ceases to push.
    """
    exposure, end, (work, begins, ceases) = m.work.exposing.pair[k], bin_at(m, inside), pushing
    row, here, done = exposure.row + ROWS.sliding * m.scene.bins, exposure.bin, 0.0
    before = _work_until(begins, h, exposure.power, exposure.power_rate, there[0], there[1])
    step = 1 if inside > exposure.position else -1
    while here != end:
        share = min(max(share_at_edge(m, here, exposure.position, inside), begins), ceases)
        until = _work_until(share, h, exposure.power, exposure.power_rate, there[0], there[1]) - before
        until = min(max(until, done), work)
        m.rows[row + here] += until - done
        here, done = here + step, until
    m.rows[row + here] += work - done


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
    exposure = m.work.exposing.pair[k]
    row, way = exposure.row + ROWS.sliding * m.scene.bins, inside - exposure.position
    power0, rate0 = exposure.side * exposure.power, exposure.side * exposure.power_rate
    power1, rate1 = side * there[0], side * there[1]
    pushes, total = exposure.power >= 0.0 and there[0] >= 0.0, 0.0
    for part in range(PARTS):
        s = (part + 0.5) / PARTS
        power = cubic(s, h, power0, rate0, power1, rate1)
        if not pushes:
            power *= exposure.side if s < 0.5 else side
        elif side != exposure.side:
            power = abs(power)
        work = max(power, 0.0) * h / PARTS
        m.rows[row + bin_at(m, exposure.position + s * way)] += work
        total += work
    return total


# -- intervals --------------------------------------------------------------------------------------------------------


@compiled(inline=True)
def begin_intervals(m: Model) -> None:
    """Begin at a start of the integration, with nothing known of the work of former steps."""
    m.work.exposing.work = m.work.exposing.counted = 0.0
    start_with_one_step(m)


@compiled(inline=True)
def start_with_one_step(m: Model) -> None:
    """Begin an interval of one step, as a contact has begun or ended."""
    m.work.exposing.steps, m.work.exposing.steps_per_interval, m.work.exposing.wanted = 0, 1, 1
    m.work.exposing.error = 0.0


@compiled(inline=True)
def time_to_zero(m: Model, k: int, force: float, rate: float) -> float:
    """Time until the force of the pair with the k-th history is expected to pass zero.

    It is infinite beyond the longest interval, and where the pair has not pulled: most contacts cease to push as they
    separate, without a kink.
    """
    exposure = m.work.exposing.pair[k]
    if force < 0.0:
        exposure.pulls = 1
    if exposure.pulls == 0 or force * (force + rate * MOST_STEPS * m.work.driver.step) >= 0.0:
        return math.inf
    return -force / rate


@compiled(inline=True)
def next_interval(m: Model, to_zero: float, speed: float) -> None:
    """End an interval, and choose the steps of the next one.

    Parameters
    ----------
    to_zero : float
        Time until the first force is expected to pass zero.
    speed : float
        With which contacts move along the path, in pitches.
    """
    exposing, step = m.work.exposing, m.work.driver.step
    steps, gone = _steps_by_error(m), abs(speed) * step
    if steps * gone * PER_PITCH > 1.0:
        steps = max(int(1.0 / (PER_PITCH * gone)), 1)
    if to_zero < steps * step:
        steps = int(to_zero / step) + 1
    exposing.steps, exposing.steps_per_interval, exposing.error = 0, steps, 0.0


@compiled(inline=True)
def choose_pressure_step(m: Model, way: float, speed: float) -> None:
    """Choose the step after which pressures are looked at next.

    Parameters
    ----------
    way : float
        To the nearest edge of a bin, in bins.
    speed : float
        As for `next_interval`.
    """
    exposing = m.work.exposing
    left, gone = (
        exposing.steps_per_interval - exposing.steps,
        abs(speed) * m.work.driver.step * m.scene.bins_per_pitch,
    )
    if way < left * gone:
        left = int(way / gone) + 1
    exposing.wanted = exposing.steps + left


@compiled(inline=True)
def _steps_by_error(m: Model) -> int:
    """Steps for which the error estimate of the next interval will be what is allowed."""
    exposing = m.work.exposing
    exposing.counted += exposing.steps
    allowed, error = ALLOWED * exposing.work * exposing.steps, exposing.error * exposing.counted
    exposing.work *= FADING
    exposing.counted *= FADING
    longer = LENGTHENING
    if error > 0.0:  # 1 where it is what is allowed
        longer = (LENGTHENING * allowed + error) / (allowed + LENGTHENING * error)
    return min(max(int(longer * exposing.steps + 0.5), 1), MOST_STEPS)
