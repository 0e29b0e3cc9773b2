r"""One step of a run, from one accepted time to the next. Read this page first: it has the step in its order.

    advance                 steps until a block of output is full
        next_time
            propose         IDA predicts the state at the end of a step, and has `iterate`
                correct     it until it meets the equations of motion, and
                test        it: the error of the formula decides whether IDA takes the step or tries a shorter one
            locate          the first event within the step: the root of the smallest of all guards
        sample              what is written out lies on the polynomial of the step
        finish_step
            accept          histories of the tooth pairs follow to the accepted time
            account         observers add up works, losses, extremes and exposures, and change nothing
            switch          what has happened there: laws, histories, friction and schedules take their new branches
        restart             where the equations have jumped, with consistent rates and nothing known of the past

Within a step all equations are smooth: histories, sides of laws, directions of slip and segments of schedules change
in `switch` alone, so that each of IDA's attempts at a step solves one and the same problem. IDA keeps the loop of
attempts; it is entered in `propose` and calls `iterate` back. The portable driver
(`gearidae.engine.portable`) has its own way from one time to the next, by scikit-sundae, and everything from
`finish_step` on in common.

What one stage tells the next is an argument or a result. ``m.work`` keeps what has to outlive a step: the history of
the formula (``adams``), what is left to search of a step that had a root (``search``), and where the run stands between
blocks (``driver``), which only this module writes while a run steps.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from gearidae.arrays import Ints
from gearidae.compiled import compiled, compiled_once
from gearidae.engine import adams
from gearidae.engine.compiling import SOLVER
from gearidae.engine.elastic.static_condensation import begin_deflections
from gearidae.engine.events.asperity_events import record_switches, switch_asperities
from gearidae.engine.events.cutoff import begin_within, note_within, watches_cutoff
from gearidae.engine.events.events import ROOT, STOP, chatters, guard, handle_mesh
from gearidae.engine.events.histories import accept
from gearidae.engine.events.law_switches import (
    laws_chatter,
    misses_laws,
    note_iterate_of_laws,
    note_law_iterates,
    note_law_jump,
    note_step_of_laws,
    set_law_sides,
    set_law_window,
    switch_shafts,
)
from gearidae.engine.events.pair_events import PairEvent, find_event, take_event
from gearidae.engine.events.record import EVENTS_AT_ONCE
from gearidae.engine.events.sliding import follow_creeping, follow_sliding
from gearidae.engine.events.stops import keeps_checkpoint, next_stop, pass_knot, stop_guard
from gearidae.engine.friction.ageing import begin_ageing, follow_ageing
from gearidae.engine.integrate.correction import correct
from gearidae.engine.integrate.driver import (
    BOUND_EXCEEDED,
    CHATTER,
    CHECKPOINT_STEPS,
    LAW_CHATTER,
    LIGHT,
    MANY_EVENTS,
    Output,
    sample_time,
)
from gearidae.engine.integrate.resting import begin_rest, comes_to_rest, longest_step, rest_step
from gearidae.engine.integrate.roots import (
    Arrays,
    Stepper,
    begin_interval,
    evaluate_guard,
    find_dips,
    find_root,
    find_root_as_ida,
    go_to_dip,
    rounding,
    state_at,
    state_for_sample,
)
from gearidae.engine.integrate.start import first_step, rebase, set_rates
from gearidae.engine.integrate.step_control import (
    below_gap_bound,
    change_wanted,
    configure_ida,
    control_step,
    max_stable_order,
)
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.record_types import FREE
from gearidae.engine.model.state import PHASE, Floats, Model, W
from gearidae.engine.model.work_record import MOST_LEAVINGS
from gearidae.engine.motion.observe import observe
from gearidae.engine.motion.pair_forces import finish_deflections, is_eliminated, set_deflections
from gearidae.engine.motion.residual import residual
from gearidae.engine.observers import adhesion_loss, balance, friction_losses, impacts
from gearidae.engine.observers.exposures import accumulation as exposures
from gearidae.engine.observers.exposures.contacts import add_asperity_switches
from gearidae.engine.observers.extremes import extrema as extremes
from gearidae.engine.observers.finish import finish_account
from gearidae.engine.observers.impacts import IMPACTS_AT_ONCE, write_impacts
from gearidae.engine.observers.passages import PASSAGES_AT_ONCE, write_passages
from gearidae.engine.pairs.orbit import follow_orbit, orbit_anew
from gearidae.engine.pairs.tooth_pairs import flank_of_history, in_flight, list_known
from gearidae.engine.sundials import names as sun
from gearidae.engine.sundials.ida_memory import IDA, YP, Y
from gearidae.engine.sundials.interpolation import solution_at

MOST_CORRECTIONS: Final = 4
SLOWEST: Final = 0.9  # a correction this large, over the last, is called divergence
NOTHING: Final = 1e-9  # a correction this small, over the tolerance, needs no second
NEWTON_TOLERANCE: Final = 0.1  # of what IDA would leave
GROWTH: Final = 1.1  # of the estimate of what is left, per step
LEAST: Final = 1e-4  # of that estimate
FAILED: Final = 902  # what SUNDIALS answers with shorter steps
_FALLEN_AT_ONCE: Final = 4
"""Times that guards are looked at again after an event; one suffices but where the new speeds turn a gap round, too."""
_CLOSE: Final = 16.0 * float(np.finfo(float).eps)
"""Of the end's time: so shortly before it IDA refuses to start anew, and can do without."""


# -- the loop --------------------------------------------------------------------------------------------------------


@compiled
def advance(address: int, arrays: Arrays, out: Output, budget: int) -> None:
    """Run until a block of output is full, `budget` steps are done or the run is over.

    Parameters
    ----------
    address : int
        Where the model lies, from `Addresses`; its ``work.driver`` says where the run stands.
    out : Output
        Samples and rows of this block.
    budget : int
        Steps to do at most.
    """
    m = model_at(address)
    s = Stepper(arrays.handles, m, arrays.y, arrays.yp, arrays.dky, arrays.spare, arrays.clock)
    driver = m.work.driver
    flag = driver.pending - 1
    if driver.pending < 0:  # a fresh start
        m.work.adams.wanted = m.work.adams.native_newton
        driver.error = restart(s, next_stop(m))
        driver.pending = 0
    while (
        driver.error == 0
        and driver.done == 0
        and budget > 0
        # asked before the step: what happens at its end is recorded where it is dealt with, which cannot be repeated
        and has_room(driver.events, driver.passages, driver.impacts, out)
        and m.work.leavings < MOST_LEAVINGS
    ):
        if driver.pending == 0:
            if (
                driver.resting != 0
            ):  # nothing moves, so that time alone is searched, and each look counts as a step
                looks = m.state.progress.guard_evaluations
                s.clock[0], flag = rest_step(m, s.clock[0], s.y)
                budget -= m.state.progress.guard_evaluations - looks
            else:
                flag = next_time(s)
            budget -= 1
            driver.since += 1
            if flag < 0:
                driver.error = flag
                break
        driver.time = s.clock[0]
        # Samples come before the histories follow: within the step forces are those of the branches that it had.
        if not sample(s, out.rows):  # the block is full: the step waits with its flag
            driver.pending = flag + 1
            break
        driver.pending = 0
        afresh = finish_step(m, s.clock[0], s.y, s.yp, (s.dky, s.spare), flag, out)
        # A checkpoint holds no history of a formula. Every run begins anew at it, so that one that is resumed there
        # goes on to the last bit like one that has not been interrupted.
        checkpoint = driver.since >= CHECKPOINT_STEPS
        if (afresh or checkpoint) and driver.done == 0 and driver.error == 0:
            add_counters(s)
            prepare_restart(m, s.clock[0], s.y, s.yp)
            if checkpoint:
                driver.since = 0
                driver.pending = -1
                break
            driver.error = restart(s, next_stop(m))
    add_counters(s)


@compiled
def has_room(events: int, passages: int, impacts: int, out: Output) -> bool:
    """Whether all that happens at one more accepted time finds room in the block; else the block is yielded first."""
    room = out.events.shape[0] - EVENTS_AT_ONCE, out.passages.shape[0] - PASSAGES_AT_ONCE
    left = out.impacts.shape[0] - IMPACTS_AT_ONCE
    return bool(events <= room[0] and passages <= room[1] and impacts <= left)


@compiled(inline=True)
def next_time(s: Stepper) -> int:
    """Go to the first of the end of the next step, a stop and a root; IDA's flag."""
    search = s.m.work.search
    if search.rest != 0:  # a root has been dealt with: the rest of its step is searched with the new branches
        begin_interval(s, evaluate_guard(s, s.clock[0]))
        if abs(search.step_end - s.clock[0]) <= rounding(s):
            search.rest = 0
    if search.rest == 0 and search.stop != 0:  # no root is left before the stop
        return go_to_stop(s)
    flag = propose(s)
    return locate(s) if flag >= 0 else flag


# -- propose, correct, test ------------------------------------------------------------------------------------------


@compiled(inline=True)
def propose(s: Stepper) -> int:
    """Go to the end of the interval to search: that of a step which had a root, or of a new step; IDA's flag."""
    search, handles = s.m.work.search, s.handles
    if search.rest != 0:
        # The step has been accepted, and its polynomial is not made anew: an event that does not jump the equations
        # changes them by less than the tolerance over the rest of one step.
        s.clock[0] = search.step_end
        state_at(s, s.clock[0], True)
        return 0
    flag = sun.IDASolve(
        handles[IDA], s.m.scene.end, s.clock.ctypes.data, handles[Y], handles[YP], sun.IDA_ONE_STEP
    )
    if flag < 0:
        return flag
    adams.store_step(s.m.work.adams, s.clock[0], s.yp)
    if is_eliminated(s.m):
        finish_deflections(s.m, s.clock[0], s.y)
    if search.as_ida != 0:
        solution_at(handles[IDA], s.clock[0], handles[Y], handles[YP])
    if flag == sun.IDA_TSTOP_RETURN:  # the step itself may end a rounding error beside the stop
        search.stop, search.stop_time = 1, s.clock[0]
        sun.IDAGetCurrentTime(handles[IDA], s.clock.ctypes.data)
        state_at(s, s.clock[0], False)
    return flag


class Attempt(NamedTuple):
    """A step that IDA tries, as it lets a nonlinear solver see it.

    Attributes
    ----------
    t, step : float
        End and length of the step, over tau. The length is no difference of times, which rounding would spoil.
    cj : float
        IDA's leading coefficient.
    tolerance : float
        Of Newton's iteration.
    predicted, rates : ndarray, shape (n,)
        The state to start from and IDA's rates for it.
    correction, y, yp : ndarray, shape (n,)
        The sum of all corrections, zero at first, and state and rates with it.
    delta : ndarray, shape (n,)
        Work space.
    weights : ndarray, shape (n,)
        Of the norm; replaced by those with which IDA tests the step, see `gearidae.engine.integrate.step_control`.
    """

    t: float
    step: float
    cj: float
    tolerance: float
    predicted: Floats
    rates: Floats
    correction: Floats
    y: Floats
    yp: Floats
    delta: Floats
    weights: Floats


@compiled
def residual_of_attempt(m: Model, t: float, y: Floats, yp: Floats, out: Floats) -> None:
    """Residual at the end of a step that IDA tries by itself.

    It is not a number where the step passes over a law's jump: the iteration then fails, and IDA tries a shorter step.
    """
    residual(m, t, y, yp, out)
    if m.scene.law_watched == 0 or t <= m.work.adams.time:
        return
    if note_iterate_of_laws(m, t, y):
        for j in range(out.size):
            out[j] = math.nan


@compiled(inline=True)
def iterate(n: int, m: Model, attempt: Attempt) -> int:
    """Correct a prediction until what is left is far below the tolerance, and set the weights that test it.

    SUNDIALS iterates with an old Jacobian, through a dozen vector operations a correction. A motion's forces come with
    their slopes at no great cost, and its equations are solved in a few operations
    (`gearidae.engine.integrate.correction`), so that every correction here uses the Jacobian at the current iterate:
    the remaining error is of second order, and one correction is mostly enough.

    Parameters
    ----------
    n : int
        Unknowns.

    Returns
    -------
    int
        0, or a return code for SUNDIALS.
    """
    a, cj, correction, predicted = m.work.adams, attempt.cj, attempt.correction, attempt.predicted
    by_adams = a.used != 0
    if by_adams:
        first = m.scene.error_weights_at
        for j in range(n):  # an attempt that has failed has left others
            attempt.weights[j] = m.rows[first + j]
        cj = adams.rates_at_end(n, a, attempt.step, max_stable_order(a, attempt.step), predicted, correction)
    else:
        a.order_used = 0
        a.attempts += 1
        for j in range(n):
            a.predicted_rates[j] = attempt.rates[j]
    a.new_step = attempt.step
    # What is left after one correction is estimated from the last second one. The estimate grows with every step until
    # a second correction is needed, which renews it.
    a.contraction_rate *= GROWTH
    last = math.inf
    m.work.not_converged = 0
    for _ in range(MOST_CORRECTIONS):
        for j in range(n):
            attempt.y[j] = predicted[j] + correction[j]
            attempt.yp[j] = cj * correction[j] + a.predicted_rates[j]
        a.omega_sq = correct(m, attempt.t, cj, attempt.y, attempt.yp, attempt.delta)
        a.evaluations += 1
        for j in range(n):
            correction[j] += attempt.delta[j]
        norm = math.sqrt(adams.weighed_squares(n, attempt.delta, attempt.weights) / n)
        if m.work.not_converged != 0:
            break
        if last < math.inf:
            if norm > SLOWEST * last:
                break
            a.contraction_rate = max(norm / last, LEAST)
        # A tenth of the third of a tolerance that IDA would leave: it is no smooth function of time, and disturbs the
        # differences that choose step and order.
        converged = a.contraction_rate * norm <= NEWTON_TOLERANCE * attempt.tolerance
        if norm <= NOTHING * attempt.tolerance or converged:
            for j in range(n):
                a.new_state[j] = predicted[j] + correction[j]
                a.new_differences[0, j] = cj * correction[j] + a.predicted_rates[j]
            # Two faults that no estimate of the error sees: a state where forces are extrapolated, and a jump of a law
            # that the step passes over. A shorter step is tried.
            if below_gap_bound(m, a) or (m.scene.law_watched != 0 and _passes_jump(n, m, attempt)):
                return FAILED
            if by_adams:
                control_step(n, m, attempt.step, correction, attempt.weights)
            return 0
        last = norm
    a.failures += 1
    a.contraction_rate = 1.0
    if m.scene.law_watched != 0:  # iterates that go to and fro over a law's jump do not converge
        for j in range(n):
            attempt.delta[j] = predicted[j] + correction[j]
        note_law_iterates(m, attempt.t, attempt.y, attempt.delta)
    return FAILED


@compiled
def _passes_jump(n: int, m: Model, attempt: Attempt) -> bool:
    """Whether the step that has been solved passes over a law's jump; one between its last iterates is counted, too."""
    for j in range(n):
        attempt.delta[j], attempt.y[j] = attempt.y[j], m.work.adams.new_state[j]
    note_law_iterates(m, attempt.t, attempt.delta, attempt.y)
    return misses_laws(m, attempt.t, attempt.y, True)


# -- locate ----------------------------------------------------------------------------------------------------------


@compiled(inline=True)
def locate(s: Stepper) -> int:
    """Go back to the first root of the guard in the interval that ends at the time reached, if there is one; the flag.

    The guard is the least of all distances to the next events, and each of them is above zero while it waits: one
    evaluation at the end of a step says that nothing has happened.
    """
    search = s.m.work.search
    high, end = evaluate_guard(s, s.clock[0]), s.clock[0]
    if s.m.scene.population.flanks != 0 and search.low > 0.0 < high:
        high = go_to_dip(s, high)  # an asperity may touch and part again within the step
    if search.low > 0.0 > high:
        search.step_end = end
        search.rest = 1
        if search.as_ida != 0:
            find_root_as_ida(s, high)
        else:
            # Deflections are interpolated while the root is searched, which is a tenth of the cost, and solved for
            # once it is found.
            find_root(s, high, True)
            if is_eliminated(s.m):
                set_deflections(s.m, s.clock[0], s.y, False)
                if (
                    evaluate_guard(s, s.clock[0]) > 0.0
                ):  # the interpolated deflections have been too far ahead
                    s.clock[0] = search.step_end
                    state_at(s, search.step_end, False)
                    find_root(s, high, False)
        if s.m.scene.population.flanks != 0:
            find_dips(s)
        return sun.IDA_ROOT_RETURN
    unseen = search.low <= 0.0 and high < 0.0
    begin_interval(s, high)
    search.rest = 0
    if unseen:
        # a guard has been below zero for the whole step: it is dealt with here, and hides no other any longer
        return sun.IDA_ROOT_RETURN
    if search.stop != 0:
        return go_to_stop(s)
    return 0


@compiled(inline=True)
def go_to_stop(s: Stepper) -> int:
    """Go to a stop, after all roots before it have been dealt with; the flag."""
    s.m.work.search.stop = 0
    s.clock[0] = s.m.work.search.stop_time
    state_at(s, s.clock[0], False)
    return sun.IDA_TSTOP_RETURN


# -- sample ----------------------------------------------------------------------------------------------------------


@compiled(inline=True)
def sample(s: Stepper, rows: Floats) -> bool:
    """Write the samples up to the time reached; whether the block has room for them all."""
    m, driver, progress = s.m, s.m.work.driver, s.m.state.progress
    due = sample_time(m, progress.next_sample)
    while due <= s.clock[0] and driver.rows < rows.shape[0]:
        state_for_sample(s, due)
        observe(m, due, s.dky, rows[driver.rows])
        driver.rows += 1
        progress.next_sample += 1
        due = sample_time(m, progress.next_sample)
    return due > s.clock[0]


# -- accept, account, switch: common to both drivers -----------------------------------------------------------------


@compiled(inline=True)
def finish_step(
    m: Model, t: float, y: Floats, yp: Floats, between: tuple[Floats, Floats], flag: int, out: Output
) -> bool:
    """Accept a step, account for it, and switch what has happened at its end.

    Parameters
    ----------
    m : Model
        The ``events``, ``passages``, ``done`` and ``error`` of ``m.work.driver`` are set.
    t : float
        Accepted time over tau.
    y, yp : ndarray, shape (n,)
        State and rates there; the state changes where the gear sticks.
    between : tuple of two ndarrays, shape (n,)
        Work space.
    flag : int
        0, `STOP` or `ROOT`.
    out : Output
        Of the block; see `has_room`.

    Returns
    -------
    bool
        Whether the integration must restart from here.
    """
    driver = m.work.driver
    events, passages, done, root = driver.events, driver.passages, False, flag == ROOT
    # Histories follow before anything asks for a force: within a step they only move on with the gap.
    accept(m, t, y)
    account(m, t, y, yp, (flag != 0, root), between)
    if m.scene.friction.ages != 0:
        follow_ageing(m, t, y)
    error = BOUND_EXCEEDED if m.state.bound_exceeded != 0 else 0
    if in_flight(m):
        m.state.progress.flight_steps += 1
    if m.scene.law_watched != 0 and m.work.adams.native_newton == 0:
        note_step_of_laws(m, t, y)
    if m.work.law_jumps != 0 and laws_chatter(m, y):
        error = LAW_CHATTER
    afresh = (
        change_wanted(m, y, yp)
        or (driver.resting == 0 and comes_to_rest(m, t, y))
        # whole pitches are taken out at a restart: the phase is held to absolute tolerances, down to 1e-15
        or abs(y[PHASE]) > m.scene.phase_high
    )
    afresh &= m.scene.end - t > _CLOSE * m.scene.end
    if root:
        steps = driver.step, t - driver.step_end
        for again in range(1 + _FALLEN_AT_ONCE):
            # What has been dealt with may let another guard fall at the same time: the speed of a gear that comes to
            # rest is set to zero, which may turn a gap round. Below zero at the beginning of a step such a guard would
            # wait for ever, and as the least of all hide every later event.
            if again > 0 and (error != 0 or guard(m, t, y) > 0.0):
                break
            now = switch(m, t, y, yp, steps, out, (events, passages))
            events, passages = now.events, now.passages
            afresh |= now.restart
            error = now.error if now.error != 0 else error
        done = m.scene.stop != 0 and stop_guard(m, t, y) <= 0.0
        if m.state.rigid_again != 0 and not done and error == 0:
            error = LIGHT
    else:
        driver.step, driver.step_end = t - driver.step_end, t
    if flag == STOP or (root and t >= next_stop(m)):  # a root may lie at the stop itself
        if m.state.next_knot < m.scene.knot_count:
            if keeps_checkpoint(m):
                driver.since = CHECKPOINT_STEPS
            events = pass_knot(m, t, out.events, events)
            if m.scene.friction.may_stick != 0:
                events = follow_sliding(m, t, y, out.events, events)[0]
            afresh = True
        else:
            done = True
    if m.state.hold != FREE:
        events, stopped = follow_creeping(m, t, y, out.events, events)
        afresh |= stopped
    driver.events, driver.passages = events, passages
    driver.done, driver.error = 1 if done else 0, error
    if done or error != 0:
        finish_account(m, t, y, yp)
    return afresh


@compiled(inline=True)
def account(
    m: Model, t: float, y: Floats, yp: Floats, at: tuple[bool, bool], between: tuple[Floats, Floats]
) -> None:
    """Have the observers go on to an accepted time, with sides and mesh marks as they were in the step.

    An observer adds up totals and extremes and never changes the solution. It leaves out what it does not need, and is
    called only if the scene wants it.

    Parameters
    ----------
    t : float
        Time over tau.
    y, yp : ndarray, shape (n,)
        State there and its rate.
    at : tuple of bool
        Whether a stop or a root of the guard is there, and whether it is a root.
    between : tuple of two ndarrays, shape (n,)
        Work space.
    """
    force, closed = math.nan, False
    # The balance follows lags over several steps at once. Nodes of elastic contacts join one by one, which makes
    # kinks; and exposures ask for the lags at any accepted time.
    if m.scene.follow.balance != 0 and (m.scene.nodes > 0 or m.scene.follow.exposures != 0):
        adhesion_loss.step(m, t, y, yp[W])
    if m.scene.follow.friction != 0:
        force = friction_losses.accumulate_friction(m, t, y, at[1], between[0], between[1])
    if m.scene.follow.extremes != 0:
        extremes.step(m, t, y, yp, at[0], between, force)
    if m.scene.follow.balance != 0:
        closed = balance.step(m, t, y, yp, at, between)
    if m.scene.follow.exposures != 0:
        exposures.step(m, t, y, yp, at[1], closed)
    if m.scene.follow.impacts != 0:
        impacts.step(m, t, y, yp, at[1])


class Switched(NamedTuple):
    """What `switch` leaves.

    Attributes
    ----------
    restart : bool
        Whether the integration must begin anew.
    events, passages : int
        Those that the block has then.
    error : int
        What ends the run, or 0.
    """

    restart: bool
    events: int
    passages: int
    error: int


@compiled
def switch(
    m: Model,
    t: float,
    y: Floats,
    yp: Floats,
    steps: tuple[float, float],
    out: Output,
    filled: tuple[int, int],
) -> Switched:
    """Deal with all guards that have fallen at t.

    Several may fall at one time, as pairs on the path have equal gaps. Each is asked by itself whether it has, since
    the guard of the step is the least of them and does not say whose it is. Whoever acts disarms its guard.

    Parameters
    ----------
    m, t, y, yp, out
        As for `finish_step`.
    steps : tuple of float
        Lengths of the last whole step and of the present one up to t, over tau.
    filled : tuple of int
        Events and passages that the block has already.
    """
    events, joined, error = out.events, False, 0
    count, crossed, restart = handle_mesh(m, t, y, steps, events, filled[0])
    for i in range(list_known(m, y) if m.scene.population.flanks == 0 else 0):
        k = m.work.known[i]
        event = find_event(m, y, flank_of_history(m, k), m.state.history[k].pair, k)
        if event.touches or event.stretches or event.turns:
            joined |= event.turns and m.state.history[k].direction < 0.0
            account_event(m, t, y, yp, event)  # energies are those of the branch that ends here
            count = take_event(m, t, y, event, events, count)
    if m.scene.population.flanks != 0:
        if switch_asperities(m, y):
            restart = True
            if m.scene.follow.exposures != 0:
                add_asperity_switches(m, y)
        count, too_many = record_switches(m, t, y, events, count)
        if too_many:
            error = MANY_EVENTS
    # Friction decides behind the pairs and before the laws: limits follow from the loads of the new branches.
    if m.scene.friction.may_stick != 0:
        count, jumped = follow_sliding(m, t, y, events, count)
        restart |= jumped
    if m.scene.guarded != 0:
        count, jumped = switch_shafts(m, t, y, events, count)
        restart |= jumped
    if m.scene.law_switches != 0 and set_law_sides(m, t, y):
        note_law_jump(m, t, y, True)
        restart = True
    if watches_cutoff(m):
        restart |= note_within(m, y)
    resume_account(m, t, y, crossed, joined)
    passages = filled[1]
    if crossed and m.scene.follow.passages != 0:
        passages = write_passages(m, t, y, events, (filled[0], count), out.passages, passages)
    if m.scene.follow.impacts != 0 and count > filled[0]:
        driver = m.work.driver
        driver.impacts = write_impacts(m, t, y, yp, events, (filled[0], count), out.impacts, driver.impacts)
    if chatters(m, t):
        error = CHATTER
    return Switched(restart, count, passages, error)


# -- restart ---------------------------------------------------------------------------------------------------------


@compiled
def restart(s: Stepper, stop: float) -> int:
    """Set consistent rates and the first step, and (re-)initialise IDA at the time reached; its flag is returned.

    The past is of no use where a force has jumped: a polynomial through it would be wrong by the jump.
    """
    ida, m, t = s.handles[IDA], s.m, s.clock[0]
    prepare_start(m, t, s.y, s.yp)
    adams.begin(m.work.adams, t, s.y, s.yp)
    if m.work.driver.resting != 0:
        return 0
    flag = sun.IDAReInit(ida, t, s.handles[Y], s.handles[YP])
    m.work.driver.counted[:] = 0
    flag |= sun.IDASetInitStep(ida, first_step(m, t, s.y, s.yp, stop - t))
    # no step goes beyond a knot: the torques behind it are other ones, and its attempts would see both
    flag |= sun.IDASetStopTime(ida, stop)
    flag |= sun.IDASetMaxStep(ida, longest_step(m))
    if m.work.adams.native_newton != 0:
        if m.scene.nodes > 0:
            begin_deflections(m, t, s.y)
        flag |= configure_ida(ida, m)
    begin_interval(s, evaluate_guard(s, t))
    m.work.search.rest = m.work.search.stop = 0
    return flag


@compiled_once(SOLVER)
def prepare_start(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Set sides of laws, consistent rates, and what observers know of the time before, for a start at t."""
    driver, follow = m.work.driver, m.scene.follow
    set_law_window(m)
    orbit_anew(m)
    follow_orbit(m, t)
    if m.scene.law_switches != 0:
        set_law_sides(m, t, y)
    m.work.adams.time = t
    if m.scene.law_watched != 0:
        note_step_of_laws(m, t, y)
    if watches_cutoff(m):
        begin_within(m, y)
    if m.scene.friction.ages != 0:
        begin_ageing(m, t, y)
    driver.resting = 1 if begin_rest(m, t, y) else 0
    set_rates(m, t, y, yp)
    force = math.nan
    if follow.balance != 0:
        adhesion_loss.begin(m, t)
        balance.begin(m, t, y, yp)
    if follow.friction != 0:
        force = friction_losses.note_friction(m, t, y)
    if follow.extremes != 0:
        extremes.begin(m, t, y, yp, force)
    if follow.exposures != 0:
        exposures.begin(m, t, y, yp)
    if follow.impacts != 0:
        impacts.begin(m, t, y, yp)
    driver.step_end, driver.step = t, 0.0


@compiled
def prepare_restart(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Bring the observers up to the time reached and move whole pitches out of the phase, before a start from here."""
    finish_account(m, t, y, yp)
    rebase(m, y)
    m.state.progress.restarts += 1


# -- observers at an event --------------------------------------------------------------------------------------------


@compiled(inline=True)
def account_event(m: Model, t: float, y: Floats, yp: Floats, event: PairEvent) -> None:
    """Take note of what has happened to a pair, before its history does."""
    if m.scene.follow.balance != 0 and event.turns:
        adhesion_loss.event(m, t, y, yp[W], event.flank, event.pair, event.k, event.gap)
    if m.scene.follow.exposures != 0:
        exposures.event(m, t, y, yp, event)


@compiled
def resume_account(m: Model, t: float, y: Floats, crossed: bool, joined: bool) -> None:
    """Go on behind all events of a root.

    Parameters
    ----------
    t : float
        Time over tau.
    y : ndarray, shape (n,)
        State, which a gear that comes to rest has changed.
    crossed, joined : bool
        Whether the phase has crossed a mark of the mesh, and whether a closing contact has turned round.
    """
    if m.scene.follow.balance != 0:
        if crossed:
            adhesion_loss.resume(m, y)
        balance.resume(m, t, y, crossed, joined)
    if m.scene.follow.friction != 0:
        friction_losses.note_friction(m, t, y)
    if m.scene.follow.extremes != 0:
        extremes.resume(m, t, y)


# -- what a block of steps has cost ----------------------------------------------------------------------------------


@compiled(makes_arrays=True)
def add_counters(s: Stepper) -> None:
    """Add what counters of IDA, which start from zero at each re-initialisation, formulas and root search gained."""
    progress, a, search, ida = s.m.state.progress, s.m.work.adams, s.m.work.search, s.handles[IDA]
    cell, counted = np.zeros(1, np.int64), s.m.work.driver.counted
    sun.IDAGetNumSteps(ida, cell.ctypes.data)
    progress.steps += _gained(cell, counted, 0)
    progress.residual_evaluations += a.evaluations  # of residual and Jacobian at once
    progress.jacobian_evaluations += a.evaluations
    if a.native_newton == 0:
        sun.IDAGetNumResEvals(ida, cell.ctypes.data)
        progress.residual_evaluations += _gained(cell, counted, 1)
        sun.IDAGetNumJacEvals(ida, cell.ctypes.data)
        progress.jacobian_evaluations += _gained(cell, counted, 2)
    sun.IDAGetNumErrTestFails(ida, cell.ctypes.data)
    progress.error_test_failures += _gained(cell, counted, 3)
    sun.IDAGetNumNonlinSolvConvFails(ida, cell.ctypes.data)
    progress.convergence_failures += _gained(cell, counted, 4) + a.failures
    progress.guard_evaluations += search.evaluations
    search.evaluations = a.evaluations = a.failures = 0


@compiled
def _gained(cell: Ints, counted: Ints, which: int) -> int:
    """What one of IDA's counters has gained since it was last added."""
    gained = int(cell[0] - counted[which])
    counted[which] = cell[0]
    return gained
