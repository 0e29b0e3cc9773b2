"""Compiled loops of the explicit and collocation methods, with the engine's own history and event handling.

Events are handled by the engine's `handle`; the loops add the root search. At a turning point of a gap and at full
stretch the force has a kink, and a one-step method keeps its order only if a step ends there.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearidae.engine.events.events import guard
from gearidae.engine.events.histories import accept
from gearidae.engine.events.record import EVENT_NUMBERS, EVENTS_AT_ONCE
from gearidae.engine.events.schedule_knots import pass_knot
from gearidae.engine.model.state import MATERIALS, Model
from gearidae_bench.compiling import compiled
from gearidae_bench.kinks import arm, begin_step, dip_in_step, watch
from gearidae_bench.roots import (
    CALLS,
    CHATTER,
    CUBIC,
    DOP853,
    EVENTS,
    FAILED,
    GAUSS,
    STEPS,
    find_root,
    handle_event,
    pass_events,
)
from gearidae_bench.steps import (
    STAGES,
    dop853_prepare,
    dop853_step,
    dop853_value,
    gauss_step,
    hermite_value,
    rates,
    rk4_step,
)

__all__ = ["run_dop853", "run_gauss", "run_rk4"]

Floats = NDArray[np.float64]
Counts = NDArray[np.int64]


@compiled(makes_arrays=True)
def run_rk4(
    m: Model, y: Floats, end: float, times: Floats, states: Floats, step: float, counts: Counts
) -> None:
    """Steps of one length, histories followed at each; events are found on the cubic through the step's ends.

    Parameters
    ----------
    m : Model
        The scene, see `gearidae.engine.model.state`; changes in place.
    y : ndarray, shape (n,)
        State at time 0; ends as the last one.
    end : float
        End of the run, over tau.
    times : ndarray, shape (m,)
        When to write the state, increasing, over tau.
    states : ndarray, shape (m, n)
        Filled in.
    step : float
        Over tau.
    counts : ndarray of int64, shape (4,)
        Filled in.
    """
    n = y.size
    k, dense = np.zeros((STAGES, n)), np.zeros((7, n))
    zero, trial, new, f_new, there = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    room = np.empty((EVENTS_AT_ONCE, EVENT_NUMBERS))
    total = math.ceil(end / step)
    h = end / total
    sample = 0
    rates(m, 0.0, y, zero, k[0])
    before = guard(m, 0.0, y)
    for number in range(total):
        t, later = number * h, (number + 1) * h if number + 1 < total else end
        rk4_step(m, t, y, h, k, zero, trial, new)
        rates(m, later, new, zero, f_new)
        while sample < times.size and times[sample] <= later:
            hermite_value(y, k[0], new, f_new, h, (times[sample] - t) / h, states[sample])
            sample += 1
        fallen = before > 0.0 > guard(m, later, new)
        if fallen:
            pass_events(CUBIC, m, t, y, h, before, k, zero, trial, new, f_new, dense, there, room, counts)
            if counts[FAILED] != 0:
                return
        accept(m, later, new)
        y[:] = new
        if fallen:
            rates(m, later, y, zero, k[0])
        else:
            k[0] = f_new
        before = guard(m, later, y)
        if not math.isfinite(y[0]):
            counts[FAILED] = -1
            return
    counts[STEPS] = total
    counts[CALLS] = 5 * total


@compiled(makes_arrays=True)
def run_dop853(
    m: Model, y: Floats, end: float, times: Floats, states: Floats, atol: Floats, land: bool, counts: Counts
) -> None:
    """Steps of order eight under error control.

    Parameters are those of `run_rk4`, with absolute tolerances in place of the step, and with `land`: whether a step
    shall end at every event and kink, or the history be taken through them at the step's end.
    """
    n = y.size
    k, dense = np.zeros((STAGES, n)), np.zeros((7, n))
    zero, trial, new, f_new, there = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    room, heights = np.empty((EVENTS_AT_ONCE, EVENT_NUMBERS)), np.empty(MATERIALS * m.scene.histories)
    sample, t, h = 0, 0.0, 1e-3
    rejected = False
    rates(m, 0.0, y, zero, k[0])
    armed = land and arm(m, y, heights)
    before = begin_step(m, 0.0, y, heights, armed)
    while t < end:
        last = t + h >= end
        if last:
            h = end - t
        error = dop853_step(m, t, y, h, atol, k, zero, trial, new)
        counts[CALLS] += 12
        if not error < 1.0:
            h *= max(0.2, 0.9 * error**-0.125) if error < math.inf else 0.2
            rejected = True
            if h < 1e-14 * end:
                counts[FAILED] = -1
                return
            continue
        factor = 10.0 if error == 0.0 else min(10.0, 0.9 * error**-0.125)
        planned = h * (min(factor, 1.0) if rejected else factor)
        rejected = False
        later = end if last else t + h
        after = watch(m, later, new, heights, armed)
        share = dip_in_step(m, new, h, before, after)
        if share > 0.0:  # a step that ends there
            h, last = share * h, False
            dop853_step(m, t, y, h, atol, k, zero, trial, new)
            counts[CALLS] += 12
            later = t + h
            after = watch(m, later, new, heights, armed)
        fallen = before > 0.0 > after
        if fallen or (sample < times.size and times[sample] < later):
            dop853_prepare(m, t, y, h, k, zero, trial, new, dense)
            counts[CALLS] += 3
        if fallen and land:
            h_root = find_root(
                DOP853,
                m,
                t,
                y,
                h,
                0.0,
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
                heights,
                armed,
            )
            counts[EVENTS] += 1
            last = last and h_root == h
            later = t + h_root
            # beyond a kink the step saw another law: make it again, up to there
            h = h_root
            dop853_step(m, t, y, h, atol, k, zero, trial, new)
            counts[CALLS] += 12
            if sample < times.size and times[sample] < later:
                dop853_prepare(m, t, y, h, k, zero, trial, new, dense)
                counts[CALLS] += 3
        while sample < times.size and times[sample] < later:
            dop853_value(y, dense, (times[sample] - t) / h, states[sample])
            sample += 1
        if sample < times.size and times[sample] == later:
            states[sample] = new
            sample += 1
        if fallen and not land:
            pass_events(DOP853, m, t, y, h, before, k, zero, trial, new, f_new, dense, there, room, counts)
        accept(m, later, new)
        y[:] = new
        t = later
        if fallen and land:
            action = handle_event(m, t, y, room)
            # where forces jump, it is enough that another step begins
            if action == CHATTER or (action != 0 and m.scene.population.flanks == 0):
                counts[FAILED] = action
        if counts[FAILED] != 0:
            return
        if fallen:
            rates(m, t, y, zero, k[0])
        else:
            k[0] = k[12]
        armed = land and arm(m, y, heights)
        before = begin_step(m, t, y, heights, armed)
        counts[STEPS] += 1
        h = planned
        if last:
            break


@compiled(makes_arrays=True)
def run_gauss(
    m: Model,
    y: Floats,
    end: float,
    times: Floats,
    states: Floats,
    scale: Floats,
    tolerance: float,
    knots: Floats,
    counts: Counts,
) -> None:
    """Collocation of order twelve, with a step's end at every event, schedule knot and sample: the reference.

    The error of the embedded rule of order six, in units of `scale`, is held to `tolerance`; that of the method is
    far below it between the knots of the force law's tables, where only three derivatives are continuous. A jump of
    the equations (stick, slip, the schedule's `knots` over tau) only begins another step. Parameters are otherwise
    those of `run_rk4`.
    """
    n = y.size
    k, dense = np.zeros((STAGES, n)), np.zeros((7, n))
    zero, trial, new, f_new, there = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    room, heights = np.empty((EVENTS_AT_ONCE, EVENT_NUMBERS)), np.empty(MATERIALS * m.scene.histories)
    sample, t, h = 0, 0.0, 1e-3
    rates(m, 0.0, y, zero, k[0])
    armed = arm(m, y, heights)
    before = begin_step(m, 0.0, y, heights, armed)
    while t < end:
        stop = times[sample] if sample < times.size else end
        if stop <= t:
            states[sample] = y
            sample += 1
            continue
        knot = m.state.next_knot
        if knot < knots.size:
            if knots[knot] <= t:
                pass_knot(m, t, room, 0)
                rates(m, t, y, zero, k[0])
                before = begin_step(m, t, y, heights, armed)
                continue
            stop = min(stop, knots[knot])
        cut = t + h >= stop
        step = stop - t if cut else h
        error = gauss_step(m, t, y, step, scale, k, zero, trial, new) / tolerance
        counts[CALLS] += 60
        if not error < 1.0:
            h = step * (max(0.2, 0.9 * error ** (-1.0 / 7.0)) if error < math.inf else 0.3)
            if h < 1e-14 * end:
                counts[FAILED] = -1
                return
            continue
        wider = step * (4.0 if error == 0.0 else min(4.0, 0.9 * error ** (-1.0 / 7.0)))
        h = max(h, wider) if cut else wider
        later = stop if cut else t + step
        after = watch(m, later, new, heights, armed)
        share = dip_in_step(m, new, step, before, after)
        if share > 0.0:  # a step that ends there
            step = share * step
            gauss_step(m, t, y, step, scale, k, zero, trial, new)
            later = t + step
            after = watch(m, later, new, heights, armed)
        fallen = before > 0.0 > after
        if fallen:
            step = find_root(
                GAUSS,
                m,
                t,
                y,
                step,
                0.0,
                before,
                after,
                scale,
                k,
                zero,
                trial,
                new,
                f_new,
                dense,
                there,
                heights,
                armed,
            )
            counts[EVENTS] += 1
            later = t + step
            new[:] = there
        accept(m, later, new)
        y[:] = new
        t = later
        if fallen:
            action = handle_event(m, t, y, room)
            if action == CHATTER:
                counts[FAILED] = action
                return
        rates(m, t, y, zero, k[0])
        armed = arm(m, y, heights)
        before = begin_step(m, t, y, heights, armed)
        counts[STEPS] += 1
    while sample < times.size:
        states[sample] = y
        sample += 1
