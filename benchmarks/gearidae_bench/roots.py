"""Find events and kinks within a step, and take the histories through them."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.engine.events.events import guard
from gearidae.engine.events.histories import accept
from gearidae.engine.events.sliding import follow_sliding
from gearidae.engine.events.stops import next_stop, pass_knot
from gearidae.engine.integrate.driver import Output
from gearidae.engine.model.state import GEARS, Model, W
from gearidae.engine.observers import adhesion_loss
from gearidae.engine.step import switch
from gearidae_bench.compiling import compiled
from gearidae_bench.kinks import watch
from gearidae_bench.steps import dop853_value, gauss_step, hermite_value, rates

__all__ = [
    "CALLS",
    "CHATTER",
    "CONTINUE",
    "CUBIC",
    "DOP853",
    "EVENTS",
    "FAILED",
    "GAUSS",
    "LOSS",
    "REST",
    "RESTART",
    "STEPS",
    "find_root",
    "handle_event",
    "pass_events",
    "pass_stops",
    "reach",
]

Floats = NDArray[np.float64]
Counts = NDArray[np.int64]

CUBIC: Final = 0
DOP853: Final = 1
GAUSS: Final = 2
"""How to know the state within a step: by a cubic, by the method's own interpolant, by a step that ends there."""

STEPS, CALLS, EVENTS, FAILED = range(4)
"""Columns of the counters; FAILED is not zero where a run had to be given up: what `handle_event` returns, or -1 where
steps became too small."""

CONTINUE, RESTART, CHATTER = range(3)
"""What is to be done after an event: go on, begin anew, or give up as events follow without progress in time."""

REST, LOSS = range(2)
"""Columns of a run's sums: time over tau in which the gear has been held at rest, and the adhesion loss, scaled."""

_ROOT_TOLERANCE = 1e-15  # of the step's end time
_MOST_TRIALS = 60


@compiled()
def _value(
    method: int,
    m: Model,
    t: float,
    y: Floats,
    h: float,
    theta: float,
    scale: Floats,
    k: Floats,
    zero: Floats,
    trial: Floats,
    new: Floats,
    f_new: Floats,
    dense: Floats,
    out: Floats,
) -> None:
    """State at ``t + theta`` within a step of h: from the interpolant, or for Gauss by a step that ends there."""
    if method == CUBIC:
        hermite_value(y, k[0], new, f_new, h, theta / h, out)
    elif method == DOP853:
        dop853_value(y, dense, theta / h, out)
    else:
        gauss_step(m, t, y, theta, scale, k, zero, trial, out)


@compiled(makes_arrays=True)
def find_root(
    method: int,
    m: Model,
    t: float,
    y: Floats,
    h: float,
    start: float,
    low: float,
    high: float,
    scale: Floats,
    k: Floats,
    zero: Floats,
    trial: Floats,
    new: Floats,
    f_new: Floats,
    dense: Floats,
    out: Floats,
    heights: Floats,
    armed: bool,
) -> float:
    """Find where the guard falls between ``t + start`` and ``t + h``, given its values `low` and `high` there.

    Regula falsi after Illinois. Returns the place just behind the root, with its state in `out`.
    """
    a, b = start, h
    state = np.empty(y.size)
    weight, side = 1.0, 0
    out[:] = new
    for _ in range(_MOST_TRIALS):
        if b - a <= _ROOT_TOLERANCE * (t + h):
            break
        share = min(max(high / (high - weight * low), 1e-3), 1.0 - 1e-3)
        place = b - (b - a) * share
        _value(method, m, t, y, h, place, scale, k, zero, trial, new, f_new, dense, state)
        middle = watch(m, t + place, state, heights, armed)
        if middle < 0.0:
            b, high = place, middle
            out[:] = state
            weight = 0.5 * weight if side == 1 else 1.0
            side = 1
        else:
            a, low = place, middle
            weight = 2.0 * weight if side == -1 else 1.0
            side = -1
    return b


@compiled()
def handle_event(m: Model, t: float, y: Floats, room: Floats) -> int:
    """Have the engine deal with the event at t, which `accept` has reached; `CONTINUE`, `RESTART` or `CHATTER`.

    The engine asks its own drivers to begin anew at a mesh mark where their steps are longer than the tip relief
    takes to part a pair. The other methods rely on their error test alone: their step is said to have no length.
    """
    switched = switch(m, t, y, y, (0.0, 0.0), Output(room, room, room, room), (0, 0))
    if switched.error != 0:
        return CHATTER
    return RESTART if switched.restart else CONTINUE


@compiled()
def reach(m: Model, t: float, y: Floats, slopes: Floats) -> None:
    """Follow the histories to an accepted time, and the energy lost in joining if the balance is wanted.

    `slopes` is y' there.
    """
    accept(m, t, y)
    if m.scene.follow.balance != 0 and m.scene.kind == GEARS:
        m.work.quadrature.gear_acceleration = slopes[W]
        adhesion_loss.step(m, t, y, slopes[W])


@compiled()
def pass_stops(m: Model, t: float, y: Floats, room: Floats) -> bool:
    """Enter the next segments of the schedules that have a knot at t; whether there is one."""
    passed = False
    while t < m.scene.end and t >= next_stop(m):
        pass_knot(m, t, room, 0)
        if m.scene.friction.may_stick != 0:
            follow_sliding(m, t, y, room, 0)
        passed = True
    return passed


@compiled()
def pass_events(
    method: int,
    m: Model,
    t: float,
    y: Floats,
    h: float,
    later: float,
    before: float,
    k: Floats,
    zero: Floats,
    trial: Floats,
    new: Floats,
    f_new: Floats,
    dense: Floats,
    there: Floats,
    room: Floats,
    counts: Counts,
) -> tuple[float, bool]:
    """Take the history through the events within a step that ends `later`, one after the other.

    Returns the step's end, or the time of an event at which the equations jump, with its state in `there`; and whether
    they do.
    """
    start = 0.0
    after = guard(m, later, new)
    while before > 0.0 > after:
        start = find_root(
            method,
            m,
            t,
            y,
            h,
            start,
            before,
            after,
            zero,
            k,
            zero,
            trial,
            new,
            f_new,
            dense,
            there,
            zero,
            False,
        )
        counts[EVENTS] += 1
        if m.scene.follow.balance != 0:
            rates(m, t + start, there, zero, trial)
        reach(m, t + start, there, trial)
        action = handle_event(m, t + start, there, room)
        if action == CHATTER:
            counts[FAILED] = action
        if action != CONTINUE:
            return t + start, True
        before = guard(m, t + start, there)
        after = guard(m, later, new)
    return later, False
