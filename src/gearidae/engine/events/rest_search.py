"""The first time at which gears at rest begin to move: a search in time alone.

While nothing moves the state is constant, so that what is left of what holds the gears, the margin, depends on time
through the torques only, and through friction of joints that ages: that holds the more the longer they rest, so that
it makes no fall. Nothing is integrated. The time goes on by stretches in which all schedules are straight:

- *Bounds.* The torques lie within the sums of their parts' bounds. What holds at both ends of the drive's range under
  the least load holds at all torques between: a larger load holds more, and the drives that friction can hold
  are an interval. Two evaluations pass a stretch however long it is.
- *Periods.* Harmonics with a common period repeat. In a straight stretch whose first and last periods
  have been looked at, all torques of one phase lie between those of these two periods. If they hold, all do; if the
  last one does not, the first that does not is found by bisection.
- *Looks.* Else the margin is evaluated 32 times in each period of the fastest harmonic, and a minimum that may lie
  below zero between two looks is refined. Of a registered law nothing is known: it is looked at 100,000 times in a run,
  and a dip that is shorter than the time between two looks may be missed.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import FRICTION
from gearidae.engine.events.law_switches import law_guard
from gearidae.engine.events.sliding import sliding_guard
from gearidae.engine.model.state import DRIVE, LOAD, PHASE, Floats, Model, U
from gearidae.engine.pairs.shaft_angle import torque_angle
from gearidae.formulas.roots import bisected
from gearidae.laws.shaft.schedule import straight_until
from gearidae.laws.shafts import driving_force, driving_range

LOOKS: Final = 10_000
"""At the margin, one after the other, at most, between two returns to the driver."""
FEW_PERIODS: Final = 4.0
"""Periods that are looked at one after the other."""
REFINEMENTS: Final = 45
"""Golden sections of a minimum: then its time is known to 1e-9 of the time between two looks."""
HALVINGS: Final = 80
"""Of an interval with a root, at most."""

_GOLDEN: Final = 0.5 * (3.0 - math.sqrt(5.0))
_EPS: Final = 2.0 * float(np.finfo(float).eps)


@compiled
def _margin(m: Model, t: float, y: Floats) -> float:
    """What is left of what holds gears at rest, until a law switches."""
    m.state.progress.guard_evaluations += 1
    held = sliding_guard(m, t, y)
    return min(held, law_guard(m, t, y)) if m.scene.law_switches != 0 else held


@compiled
def _holds(t: float, m: Model, y: Floats) -> bool:
    return bool(_margin(m, t, y) >= 0.0)


_end_of_hold = bisected(_holds)


@compiled_once(FRICTION)
def rest_until(m: Model, t: float, y: Floats, stop: float) -> tuple[float, bool]:
    """Find how long gears at rest stay there.

    Parameters
    ----------
    t, stop : float
        Times over tau: now, and the next stop of the solver.
    y : ndarray, shape (n,)
        State.

    Returns
    -------
    time : float
        Up to which they certainly rest, at most `stop`; later than `t`.
    moves : bool
        Whether they begin to move there: the margin is just below zero.
    """
    to = straight_until(m, t, stop)
    begin, end = t, to
    if m.work.torque_law[DRIVE] == 0 and m.work.torque_law[LOAD] == 0:
        if _holds_throughout(m, t, to, y):
            return to, False
        period = m.scene.common_period
        if 0.0 < FEW_PERIODS * period < to - t and period < LOOKS * m.scene.rest_search_step:
            whole = int((to - t) / period)
            first = _first_period(m, t, y, period, whole)
            if first == whole:
                return min(t + whole * period, to), False
            begin = t + first * period
            end = begin + period
    end = min(end, begin + LOOKS * m.scene.rest_search_step)
    moves = _first_fall(m, y, begin, end)
    return (moves, True) if moves < math.inf else (end, False)


@compiled
def _holds_throughout(m: Model, t: float, to: float, y: Floats) -> bool:
    """Whether gears are held at all torques within the bounds of a time."""
    drive, load = m.scene.torque[DRIVE], m.scene.torque[LOAD]
    angles = torque_angle(m, DRIVE, y[U], y[PHASE]), torque_angle(m, LOAD, y[U], y[PHASE])
    low, high = driving_range(m, DRIVE, t, to, angles[0])
    at_drive, at_load = drive.constant, load.constant
    from_now = at_drive - driving_force(m, DRIVE, t, angles[0], 0.0)
    load.constant += driving_range(m, LOAD, t, to, angles[1])[0] - driving_force(m, LOAD, t, angles[1], 0.0)
    drive.constant = from_now + low
    held = _margin(m, t, y) > 0.0
    drive.constant = from_now + high
    held = held and _margin(m, t, y) > 0.0
    drive.constant, load.constant = at_drive, at_load
    return held


@compiled
def _first_period(m: Model, t: float, y: Floats, period: float, whole: int) -> int:
    """Number of the first of some periods in which gears begin to move, or how many there are if they stay at rest."""
    if _first_fall(m, y, t, t + period) < math.inf:
        return 0
    low, high = 0, whole - 1
    if _first_fall(m, y, t + high * period, t + whole * period) == math.inf:
        return whole
    while high - low > 1:
        middle = (low + high) // 2
        if _first_fall(m, y, t + middle * period, t + (middle + 1) * period) < math.inf:
            high = middle
        else:
            low = middle
    return high


@compiled
def _first_fall(m: Model, y: Floats, begin: float, end: float) -> float:
    """First time of an interval at which the margin is below zero; infinite if there is none."""
    parts = max(math.ceil((end - begin) / m.scene.rest_search_step), 1)
    h = (end - begin) / parts
    drop = m.scene.rest_margin_curvature * h * h if m.scene.rest_margin_curvature < math.inf else math.inf
    before, now, then = math.inf, _margin(m, begin, y), begin
    if now < 0.0:
        return begin
    if begin - h >= m.scene.start:
        before = _margin(m, begin - h, y)
    for i in range(1, parts + 2):
        t = end if i == parts else begin + i * h
        after = _margin(m, t, y) if t <= m.scene.end else math.inf
        if after < 0.0 and i <= parts:
            return float(_end_of_hold(then, t, HALVINGS, _EPS, m, y)[1])
        # a margin that stays as it is has no minimum
        if before >= now <= after and now < drop and not before == now == after:
            left = max(then - h, begin)
            lowest = _lowest(m, y, left, min(t, end))
            if _margin(m, lowest, y) < 0.0:
                return float(_end_of_hold(left, lowest, HALVINGS, _EPS, m, y)[1])
        before, now, then = now, after, t
    return math.inf


@compiled
def _lowest(m: Model, y: Floats, a: float, b: float) -> float:
    """Time at which the margin is least between two times, or already below zero."""
    c, d = a + _GOLDEN * (b - a), b - _GOLDEN * (b - a)
    at_c, at_d = _margin(m, c, y), _margin(m, d, y)
    for _ in range(REFINEMENTS):
        if min(at_c, at_d) < 0.0:
            break
        if at_c < at_d:
            b, d, at_d = d, c, at_c
            c = a + _GOLDEN * (b - a)
            at_c = _margin(m, c, y)
        else:
            a, c, at_c = c, d, at_d
            d = b - _GOLDEN * (b - a)
            at_d = _margin(m, d, y)
    return c if at_c < at_d else d
