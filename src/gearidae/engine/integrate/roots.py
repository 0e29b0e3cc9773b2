"""The first root of the guard in a step, and the states of a step between its ends.

IDA's own root finding evaluates the state twice and the guard at both ends of each step. Here the guard is evaluated
once, at the state at the end of the step; only if it has fallen below zero is the root searched, between the ends of
the step. The state between the ends is that of the formula used in the step.

A root is found by inverse interpolation, to the accuracy with which the states are known: `SHARPNESS` times the
relative tolerance of a step. Most need two evaluations of the guard. Where IDA iterates by itself and ``as_ida`` is
set, the search is IDA's (regula falsi after Illinois down to rounding, Hiebert and Shampine, SAND80-0180), the state at
a step's end is its interpolant, and roots and states are those that IDA finds by itself to the last bit.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine import adams
from gearidae.engine.events.asperity_events import first_grazing_minimum, note_step_start
from gearidae.engine.events.events import guard
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.motion.pair_forces import is_eliminated, set_deflections
from gearidae.engine.sundials import memory
from gearidae.engine.sundials import names as sun
from gearidae.engine.sundials.ida_memory import DKY, IDA, YP, Y
from gearidae.engine.sundials.interpolation import solution_at

SHARPNESS: Final = 0.01
"""Of the relative tolerance; a tenth of it changes no number of steps beyond scatter, ten times as much some."""
DIPS: Final = 16  # of asperities that are looked for in an interval
TRIES: Final = 3  # by which the interval has to be halved, or is halved

_ROUNDING: Final = 100.0 * float(np.finfo(float).eps)


class Arrays(NamedTuple):
    """The arrays of a `Stepper`, without its model, as Python hands them over."""

    handles: NDArray[np.int64]
    y: Floats
    yp: Floats
    dky: Floats
    spare: Floats
    clock: Floats


class Stepper(NamedTuple):
    """What a native run steps with.

    It is some sixty numbers to a compiled function: those that take it at every step are put into their callers.

    Attributes
    ----------
    handles : ndarray of int64
        Of SUNDIALS' objects, see `gearidae.engine.sundials.ida_memory`.
    y, yp, dky, spare : ndarray, shape (n,)
        State and rates at the time reached, and work space.
    clock : ndarray, shape (1,)
        Time reached, over tau.
    """

    handles: NDArray[np.int64]
    m: Model
    y: Floats
    yp: Floats
    dky: Floats
    spare: Floats
    clock: Floats


@compiled(inline=True)
def evaluate_guard(s: Stepper, t: float) -> float:
    """Evaluate the guard and count the evaluation."""
    s.m.work.search.evaluations += 1
    return guard(s.m, t, s.y)


@compiled(inline=True)
def begin_interval(s: Stepper, low: float) -> None:
    """Search from the time reached on, where the guard is `low`."""
    search = s.m.work.search
    search.low, search.low_time = low, s.clock[0]
    if s.m.scene.population.flanks != 0:
        note_step_start(s.m, s.y)


@compiled(inline=True)
def state_at(s: Stepper, t: float, roughly: bool) -> None:
    """Set state and rates to those at a time within the last step.

    Where nodes are eliminated, their deflections are solved for, or `roughly` interpolated between the ends of steps.
    """
    if s.m.work.adams.order_used > 0:
        adams.between(s.m.work.adams, t, s.y, s.yp)
    else:
        solution_at(s.handles[IDA], t, s.handles[Y], s.handles[YP])
    if is_eliminated(s.m):
        set_deflections(s.m, t, s.y, roughly)


@compiled(inline=True)
def state_for_sample(s: Stepper, t: float) -> None:
    """State at a time within the last step, beside that at its end: in ``s.dky``."""
    if s.m.work.driver.resting != 0:
        for j in range(s.y.size):
            s.dky[j] = s.y[j]
    elif s.m.work.adams.order_used > 0:
        adams.between(s.m.work.adams, t, s.dky, s.spare)
    else:
        sun.IDAGetDky(s.handles[IDA], t, 0, s.handles[DKY])
    if is_eliminated(s.m):
        set_deflections(s.m, t, s.dky, False)


@compiled
def go_to_dip(s: Stepper, high: float) -> float:
    """Look where an asperity may dip below its guard within the interval; go there if it does.

    Returns
    -------
    float
        The guard at the time reached, which is `high` at the end of the interval unless there is a dip.
    """
    end, low = s.clock[0], s.m.work.search.low_time
    share = first_grazing_minimum(s.m, s.y, end - low)
    if share <= 0.0:
        return high
    s.clock[0] = low + share * (end - low)
    state_at(s, s.clock[0], False)
    value = evaluate_guard(s, s.clock[0])
    if value < 0.0:
        return value
    s.clock[0] = end
    state_at(s, end, False)
    return evaluate_guard(s, end)


@compiled
def find_dips(s: Stepper) -> None:
    """Look for dips before a root that has been found, and find the first of them instead."""
    for _ in range(DIPS):
        root = s.clock[0]
        value = go_to_dip(s, 1.0)
        if s.clock[0] == root:
            return
        find_root(s, value, True)


@compiled(inline=True)
def rounding(s: Stepper) -> float:
    """Rounding error of times in this step."""
    return _ROUNDING * (abs(s.m.work.search.step_end) + abs(memory.step(s.handles[IDA])))


@compiled
def _inverse(a: float, at_a: float, b: float, at_b: float, c: float, at_c: float) -> float:
    """Root by inverse interpolation: where the parabola through (value, argument) of three points has value zero."""
    return (
        a * at_b * at_c / ((at_a - at_b) * (at_a - at_c))
        + b * at_a * at_c / ((at_b - at_a) * (at_b - at_c))
        + c * at_a * at_b / ((at_c - at_a) * (at_c - at_b))
    )


@compiled
def find_root(s: Stepper, high: float, roughly: bool) -> None:
    """Find when the guard has fallen, which is above zero at the interval's beginning and `high` at its end.

    `roughly` as for `state_at`.
    """
    search = s.m.work.search
    a, b, low = search.low_time, s.clock[0], search.low
    tolerance = max(rounding(s), search.sharpness * (b - a))
    c, left, here = a, low, b  # what was an end before, the guard there, and where the state is taken
    tries, wide = 0, b - a
    # the secant estimate is accepted without bracketing from the far side
    while b - a > tolerance and (b - a) * high < tolerance * (high - low):
        here = b - (b - a) * high / (high - low)
        if left != low and left != high:
            here = _inverse(a, low, b, high, c, left)
        here += 0.5 * tolerance  # to be past the root, if it lies there
        tries += 1
        if tries % TRIES == 0:
            slow = b - a > 0.5 * wide
            wide = b - a
            if slow:
                here = 0.5 * (a + b)
        here = min(max(here, a + 0.25 * tolerance), b - 0.25 * tolerance)
        state_at(s, here, roughly)
        value = evaluate_guard(s, here)
        if value < 0.0:
            c, left, b, high = b, high, here, value
        else:
            c, left, a, low = a, low, here, value
    s.clock[0] = b
    if here != b:
        state_at(s, b, roughly)


@compiled
def find_root_as_ida(s: Stepper, high: float) -> None:
    """Find the first root of the guard in a step by IDA's rule."""
    tolerance = rounding(s)
    search = s.m.work.search
    a, b, low = search.low_time, s.clock[0], search.low
    weight = 1.0
    side, before = 0, -1  # which end has moved: 1 the upper, 2 the lower
    while abs(b - a) > tolerance:
        if side == before:
            weight *= 2.0 if side == 2 else 0.5
        else:
            weight = 1.0
        middle = b - (b - a) * high / (high - weight * low)
        inward = tolerance / abs(b - a)  # of the interval: how far to stay from its ends
        inward = 0.1 if inward < 0.2 else 0.5 * inward
        if abs(middle - a) < 0.5 * tolerance:
            middle = a + inward * (b - a)
        if abs(b - middle) < 0.5 * tolerance:
            middle = b - inward * (b - a)
        state_at(s, middle, False)
        value = evaluate_guard(s, middle)
        before = side
        if value < 0.0:
            b, high, side = middle, value, 1
        else:
            a, low, side = middle, value, 2
    s.clock[0] = b
    state_at(s, b, False)
