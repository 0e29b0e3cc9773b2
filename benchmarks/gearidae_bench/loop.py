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
from gearidae.engine.events.stops import next_stop
from gearidae.engine.model.record_types import AT_REST, HELD_GEAR
from gearidae.engine.model.state import MATERIALS, Model
from gearidae.engine.observers.balance import note_changes
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
    LOSS,
    REST,
    STEPS,
    find_root,
    handle_event,
    pass_events,
    pass_stops,
    reach,
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


@compiled()
def _is_held(m: Model) -> bool:
    """Whether dry friction holds the gear at rest."""
    return bool(m.state.hold == HELD_GEAR or m.state.hold == AT_REST)


@compiled(makes_arrays=True)
def run_rk4(
    m: Model, y: Floats, end: float, times: Floats, states: Floats, step: float, counts: Counts, sums: Floats
) -> None:
    """Steps of one length, histories followed at each; events are found on the cubic through the step's ends.

    Where the equations jump (stick, slip, a schedule's knot) a step ends and the next one begins anew: between them the
    steps are equal, and at most `step`.

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
    sums : ndarray, shape (2,)
        Likewise: time at rest, and the adhesion loss if ``m.scene.follow.balance`` is set.
    """
    n = y.size
    k, dense = np.zeros((STAGES, n)), np.zeros((7, n))
    zero, trial, new, f_new, there = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    room = np.empty((EVENTS_AT_ONCE, EVENT_NUMBERS))
    t, sample, passed = 0.0, 0, 0
    begin, stop, total, h, before = 0.0, 0.0, 0, 0.0, 0.0
    while t < end:
        if passed == total:  # equal steps to the next stop
            begin, stop, passed = t, next_stop(m), 0
            total = math.ceil((stop - begin) / step)
            h = (stop - begin) / total
            rates(m, t, y, zero, k[0])
            before = guard(m, t, y)
        passed += 1
        later = begin + passed * h if passed < total else stop
        rk4_step(m, t, y, later - t, k, zero, trial, new)
        rates(m, later, new, zero, f_new)
        held, reached, jumped = _is_held(m), later, False
        fallen = before > 0.0 > guard(m, later, new)
        if fallen:
            reached, jumped = pass_events(
                CUBIC, m, t, y, h, later, before, k, zero, trial, new, f_new, dense, there, room, counts
            )
        while sample < times.size and times[sample] <= reached:
            hermite_value(y, k[0], new, f_new, h, (times[sample] - t) / h, states[sample])
            sample += 1
        sums[REST] += reached - t if held else 0.0
        counts[STEPS] += 1
        if jumped:
            y[:] = there
            passed = total
        else:
            reach(m, later, new, f_new)
            y[:] = new
        t = reached
        if not math.isfinite(y[0]):
            counts[FAILED] = -1
        if counts[FAILED] != 0:
            return
        if t < end and t >= next_stop(m):
            pass_stops(m, t, y, room)
            passed = total
        if passed < total:
            if fallen:
                rates(m, t, y, zero, k[0])
            else:
                k[0] = f_new
            before = guard(m, t, y)
    counts[CALLS] = 5 * counts[STEPS]
    if m.scene.follow.balance != 0:
        sums[LOSS] = m.state.energy.adhesion_loss + note_changes(m, y)[0]


@compiled(makes_arrays=True)
def run_dop853(
    m: Model,
    y: Floats,
    end: float,
    times: Floats,
    states: Floats,
    atol: Floats,
    land: bool,
    counts: Counts,
    sums: Floats,
) -> None:
    """Steps of order eight under error control.

    Parameters are those of `run_rk4`, with absolute tolerances in place of the step, and with `land`: whether a step
    shall end at every event and kink, or the history be taken through them at the step's end. Where the equations
    jump a step ends in any case.
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
        stop = next_stop(m)
        cut = t + h >= stop
        step = stop - t if cut else h
        error = dop853_step(m, t, y, step, atol, k, zero, trial, new)
        counts[CALLS] += 12
        if not error < 1.0:
            h = step * (max(0.2, 0.9 * error**-0.125) if error < math.inf else 0.2)
            rejected = True
            if h < 1e-14 * end:
                counts[FAILED] = -1
                return
            continue
        factor = 10.0 if error == 0.0 else min(10.0, 0.9 * error**-0.125)
        wider = step * (min(factor, 1.0) if rejected else factor)
        h = max(h, wider) if cut else wider
        rejected = False
        later = stop if cut else t + step
        after = watch(m, later, new, heights, armed)
        share = dip_in_step(m, new, step, before, after)
        if share > 0.0:  # a step that ends there
            step = share * step
            dop853_step(m, t, y, step, atol, k, zero, trial, new)
            counts[CALLS] += 12
            later = t + step
            after = watch(m, later, new, heights, armed)
        held, jumped, fallen = _is_held(m), False, before > 0.0 > after
        if fallen or (sample < times.size and times[sample] < later):
            dop853_prepare(m, t, y, step, k, zero, trial, new, dense)
            counts[CALLS] += 3
        if fallen and land:
            root = find_root(
                DOP853,
                m,
                t,
                y,
                step,
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
            # beyond a kink the step saw another law: make it again, up to there
            later = later if root == step else t + root
            step = root
            dop853_step(m, t, y, step, atol, k, zero, trial, new)
            counts[CALLS] += 12
            if sample < times.size and times[sample] < later:
                dop853_prepare(m, t, y, step, k, zero, trial, new, dense)
                counts[CALLS] += 3
        elif fallen:
            later, jumped = pass_events(
                DOP853, m, t, y, step, later, before, k, zero, trial, new, f_new, dense, there, room, counts
            )
        while sample < times.size and times[sample] < later:
            dop853_value(y, dense, (times[sample] - t) / step, states[sample])
            sample += 1
        sums[REST] += later - t if held else 0.0
        if jumped:
            y[:] = there
        else:
            reach(m, later, new, k[12])
            y[:] = new
        while sample < times.size and times[sample] == later:
            states[sample] = y
            sample += 1
        t = later
        if fallen and land and handle_event(m, t, y, room) == CHATTER:
            counts[FAILED] = CHATTER
        if counts[FAILED] != 0:
            return
        stopped = pass_stops(m, t, y, room)
        if fallen or stopped:
            rates(m, t, y, zero, k[0])
        else:
            k[0] = k[12]
        armed = land and arm(m, y, heights)
        before = begin_step(m, t, y, heights, armed)
        counts[STEPS] += 1
    if m.scene.follow.balance != 0:
        sums[LOSS] = m.state.energy.adhesion_loss + note_changes(m, y)[0]


@compiled(makes_arrays=True)
def run_gauss(
    m: Model,
    y: Floats,
    end: float,
    times: Floats,
    states: Floats,
    scale: Floats,
    tolerance: float,
    counts: Counts,
) -> None:
    """Collocation of order twelve, with a step's end at every event, schedule knot and sample: the reference.

    The error of the embedded rule of order six, in units of `scale`, is held to `tolerance`; that of the method is
    far below it between the knots of the force law's tables, where only three derivatives are continuous. A jump of
    the equations (stick, slip, a schedule's knot) only begins another step. Parameters are otherwise those of
    `run_rk4`.
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
        if pass_stops(m, t, y, room):
            rates(m, t, y, zero, k[0])
            before = begin_step(m, t, y, heights, armed)
        stop = min(stop, next_stop(m))
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
