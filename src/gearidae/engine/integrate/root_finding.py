"""From one accepted time to the next: a step of IDA, and the first root of the guard in it.

IDA finds roots by itself, and asks for the state twice and for the guard at both ends of each step to do so. Here the
guard is looked at once, at the state that the step has left; only where it has fallen is the root searched, between
the ends of the step. The state between the ends is that of the formula that the step was made with.

A root is found by inverse interpolation, and no more sharply than the states are known: `SHARPNESS` times the
relative tolerance of a step. Most take two looks at the guard. Where IDA iterates by itself and AS_IDA is set, the
search is IDA's (regula falsi after Illinois down to rounding, Hiebert and Shampine, SAND80-0180), the state at a
step's end is its interpolant, and roots and states are those that IDA finds by itself to the last bit.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine.events.events import guard
from gearidae.engine.integrate import adams
from gearidae.engine.sundials import memory as ptr
from gearidae.engine.sundials import names as sun

__all__ = ["AS_IDA", "CALLS", "SEARCH", "SHARP", "SHARPNESS", "next_time", "start_search", "state_at"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LOW: Final = 0  # the guard where the interval to look at begins
LOW_TIME: Final = 1
STEP_END: Final = 2  # time at the end of the step
REST: Final = 3  # 1 after a root: the rest of its step has not been looked at
STOP: Final = 4  # 1 while a stop waits for the roots before it
STOP_TIME: Final = 5
CALLS: Final = 6  # of the guard, so far
AS_IDA: Final = 7  # 1 to search as IDA does, and take the state at a step's end from its interpolant
SHARP: Final = 8  # how sharply to find a root, over the length of the interval
SEARCH: Final = 9

SHARPNESS: Final = 0.01
"""Of the relative tolerance; a tenth of it changes no number of steps beyond scatter, ten times as much some."""
TRIES: Final = 3  # by which the interval has to be halved, or is halved

_ROUNDING: Final = 100.0 * float(np.finfo(float).eps)


@compiled
def _look(d: Floats, t: float, y: Floats, search: Floats) -> float:
    """Look at the guard."""
    search[CALLS] += 1.0
    return guard(d, t, y)


@compiled
def start_search(d: Floats, t: float, y: Floats, search: Floats) -> None:
    """Begin at a time at which IDA has been started."""
    search[LOW], search[LOW_TIME] = _look(d, t, y, search), t
    search[REST] = search[STOP] = 0.0


@compiled
def state_at(solver: int, vectors: Ints, desk: Floats, t: float, y: Floats, yp: Floats) -> None:
    """State and rates at a time within the last step.

    Parameters
    ----------
    solver : int
        Address of IDA.
    vectors : ndarray of int64, shape (2,)
        Addresses of the vectors over `y` and `yp`.
    desk : ndarray, shape (DESK,)
        See `gearidae.engine.integrate.adams`.
    t : float
        Time over tau.
    y, yp : ndarray, shape (n,)
        Changed.
    """
    if desk[adams.USED] > 0.0:
        adams.between(desk, t, y, yp)
    else:
        sun.IDAGetSolution(solver, t, vectors[0], vectors[1])


@compiled(inline=True)
def next_time(
    solver: int,
    vectors: Ints,
    desk: Floats,
    d: Floats,
    y: Floats,
    yp: Floats,
    clock: Floats,
    end: float,
    search: Floats,
) -> int:
    """Go on to the end of the next step, a stop or a root, whichever comes first.

    Parameters
    ----------
    solver, vectors, desk, y, yp
        See `state_at`.
    d : ndarray
        The scene, see `layout`.
    clock : ndarray, shape (1,)
        Time over tau; changed.
    end : float
        Time in the direction of which to go.
    search : ndarray, shape (SEARCH,)
        Where the search stands.

    Returns
    -------
    int
        IDA's flag.
    """
    if search[REST] != 0.0:
        search[LOW], search[LOW_TIME] = _look(d, clock[0], y, search), clock[0]
        if abs(search[STEP_END] - clock[0]) <= _rounding(solver, search):
            search[REST] = 0.0
    rest = search[REST] != 0.0
    if rest:
        clock[0] = search[STEP_END]
        state_at(solver, vectors, desk, clock[0], y, yp)
    elif search[STOP] != 0.0:
        return _stop(solver, vectors, desk, y, yp, clock, search)
    else:
        flag = sun.IDASolve(solver, end, clock.ctypes.data, vectors[0], vectors[1], sun.IDA_ONE_STEP)
        if flag < 0:
            return flag
        adams.keep(desk, clock[0], yp)
        if search[AS_IDA] != 0.0:
            sun.IDAGetSolution(solver, clock[0], vectors[0], vectors[1])
        if flag == sun.IDA_TSTOP_RETURN:  # the step itself may end a rounding error beside the stop
            search[STOP], search[STOP_TIME] = 1.0, clock[0]
            sun.IDAGetCurrentTime(solver, clock.ctypes.data)
            state_at(solver, vectors, desk, clock[0], y, yp)
    high = _look(d, clock[0], y, search)
    if search[LOW] > 0.0 > high:
        search[STEP_END] = clock[0]
        search[REST] = 1.0
        if search[AS_IDA] != 0.0:
            _find_as_ida(solver, vectors, desk, d, y, yp, clock, high, search)
        else:
            _find(solver, vectors, desk, d, y, yp, clock, high, search)
        return sun.IDA_ROOT_RETURN
    search[LOW], search[LOW_TIME] = high, clock[0]
    search[REST] = 0.0
    if search[STOP] != 0.0 and not rest:
        return _stop(solver, vectors, desk, y, yp, clock, search)
    return 0


@compiled
def _stop(
    solver: int, vectors: Ints, desk: Floats, y: Floats, yp: Floats, clock: Floats, search: Floats
) -> int:
    """Return at a stop, now that all roots before it are through."""
    search[STOP] = 0.0
    clock[0] = search[STOP_TIME]
    state_at(solver, vectors, desk, clock[0], y, yp)
    return sun.IDA_TSTOP_RETURN


@compiled
def _rounding(solver: int, search: Floats) -> float:
    """What times of this step may differ by."""
    return _ROUNDING * (abs(search[STEP_END]) + abs(ptr.step(solver)))


@compiled
def _inverse(a: float, at_a: float, b: float, at_b: float, c: float, at_c: float) -> float:
    """Root by inverse interpolation: where the parabola through (value, place) of three points has value zero."""
    return (
        a * at_b * at_c / ((at_a - at_b) * (at_a - at_c))
        + b * at_a * at_c / ((at_b - at_a) * (at_b - at_c))
        + c * at_a * at_b / ((at_c - at_a) * (at_c - at_b))
    )


@compiled
def _find(
    solver: int,
    vectors: Ints,
    desk: Floats,
    d: Floats,
    y: Floats,
    yp: Floats,
    clock: Floats,
    high: float,
    search: Floats,
) -> None:
    """Find when the guard has fallen, which is above zero at the interval's beginning and `high` at its end."""
    a, b, low = search[LOW_TIME], clock[0], search[LOW]
    tolerance = max(_rounding(solver, search), search[SHARP] * (b - a))
    c, left, here = a, low, b  # what was an end before, the guard there, and where the state is taken
    tries, wide = 0, b - a
    # near the root the chord shows how far it is: there is no need to close in on it from both sides
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
        state_at(solver, vectors, desk, here, y, yp)
        value = _look(d, here, y, search)
        if value < 0.0:
            c, left, b, high = b, high, here, value
        else:
            c, left, a, low = a, low, here, value
    clock[0] = b
    if here != b:
        state_at(solver, vectors, desk, b, y, yp)


@compiled
def _find_as_ida(
    solver: int,
    vectors: Ints,
    desk: Floats,
    d: Floats,
    y: Floats,
    yp: Floats,
    clock: Floats,
    high: float,
    search: Floats,
) -> None:
    """Find the same as IDA does."""
    tolerance = _rounding(solver, search)
    a, b, low = search[LOW_TIME], clock[0], search[LOW]
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
        state_at(solver, vectors, desk, middle, y, yp)
        value = _look(d, middle, y, search)
        before = side
        if value < 0.0:
            b, high, side = middle, value, 1
        else:
            a, low, side = middle, value, 2
    clock[0] = b
    state_at(solver, vectors, desk, b, y, yp)
