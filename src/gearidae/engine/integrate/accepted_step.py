"""Common work of both drivers at an accepted time, before a restart and at a start."""

from __future__ import annotations

from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.events.asperity_events import record_switches, switch_asperities
from gearidae.engine.events.events import ROOT, STOP, chatters, guard, handle_mesh
from gearidae.engine.events.histories import accept
from gearidae.engine.events.law_switches import (
    laws_chatter,
    note_law_jump,
    set_law_sides,
    set_law_window,
    set_shaft_sides,
    switch_shafts,
)
from gearidae.engine.events.pair_events import find_event, take_event
from gearidae.engine.events.record import EVENTS_AT_ONCE
from gearidae.engine.events.sliding import follow_creeping, follow_sliding
from gearidae.engine.events.stops import keeps_checkpoint, next_stop, pass_knot, stop_guard
from gearidae.engine.friction.ageing import begin_ageing, follow_ageing
from gearidae.engine.integrate.driver import (
    BOUND_EXCEEDED,
    CHATTER,
    CHECKPOINT_STEPS,
    LAW_CHATTER,
    LIGHT,
    MANY_EVENTS,
    Output,
)
from gearidae.engine.integrate.resting import begin_rest, comes_to_rest
from gearidae.engine.integrate.start import PHASE_HIGH, rebase, set_rates
from gearidae.engine.integrate.step_control import change_wanted
from gearidae.engine.model.record_types import FREE
from gearidae.engine.model.state import PHASE, Floats, Model
from gearidae.engine.observers import dispatch as observers
from gearidae.engine.observers.passages import PASSAGES_AT_ONCE, write_passages
from gearidae.engine.pairs.tooth_pairs import flank_of_history, in_flight, list_known

_FALLEN_AT_ONCE: Final = 4
"""Times that guards are looked at again after an event; one suffices but where the new speeds turn a gap round, too."""


@compiled
def has_room(events: int, passages: int, out: Output) -> bool:
    """Whether all that happens at one more accepted time finds room in the block; else the block is yielded first."""
    room = out.events.shape[0] - EVENTS_AT_ONCE, out.passages.shape[0] - PASSAGES_AT_ONCE
    return bool(events <= room[0] and passages <= room[1])


@compiled(inline=True)
def finish_step(
    m: Model, y: Floats, yp: Floats, between: tuple[Floats, Floats], flag: int, out: Output
) -> bool:
    """Follow histories and energies to an accepted time, and deal with what has happened there.

    Parameters
    ----------
    m : Model
        ``m.work.driver.time`` is the accepted time; its ``events``, ``done`` and ``error`` are set.
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
    driver, t, events = m.work.driver, m.work.driver.time, out.events
    accept(m, t, y)
    observers.step(m, t, y, yp, (flag != 0, flag == ROOT), between)
    if m.scene.friction.ages != 0:
        follow_ageing(m, t, y)
    if m.state.bound_exceeded != 0:
        driver.error = BOUND_EXCEEDED
    if in_flight(m):
        m.state.progress.flight_steps += 1
    if m.work.law_jumps != 0 and laws_chatter(m):
        driver.error = LAW_CHATTER
    afresh = change_wanted(m, y, yp) or comes_to_rest(m, t, y) or abs(y[PHASE]) > PHASE_HIGH
    if flag == ROOT:
        afresh |= handle(m, t, y, yp, out)
        # What has been dealt with may let another guard fall at the same time: the speed of a gear that comes to rest
        # is set to zero, which may turn a gap round. Below zero at the beginning of a step such a guard would wait for
        # ever, and as the least of all hide every later event.
        for _ in range(_FALLEN_AT_ONCE):
            if driver.done != 0 or driver.error != 0 or guard(m, t, y) > 0.0:
                break
            afresh |= handle(m, t, y, yp, out)
        if m.scene.stop != 0 and stop_guard(m, t, y) <= 0.0:
            driver.done = 1
        if m.state.rigid_again != 0 and driver.done == 0 and driver.error == 0:
            driver.error = LIGHT
    else:
        driver.step, driver.step_end = t - driver.step_end, t
    if flag == STOP or (flag == ROOT and t >= next_stop(m)):  # a root may lie at the stop itself
        if m.state.next_knot < m.scene.knot_count:
            if keeps_checkpoint(m):
                driver.since = CHECKPOINT_STEPS
            driver.events = pass_knot(m, t, events, driver.events)
            if m.scene.friction.on != 0:
                driver.events = follow_sliding(m, t, y, events, driver.events)[0]
            afresh = True
        else:
            driver.done = 1
    if m.state.hold != FREE:
        driver.events, stopped = follow_creeping(m, t, y, events, driver.events)
        afresh |= stopped
    if driver.done != 0 or driver.error != 0:
        observers.finish(m, t, y, yp)
    return afresh


@compiled
def handle(m: Model, t: float, y: Floats, yp: Floats, out: Output) -> bool:
    """Deal with all guards that have fallen at t; whether the integration must begin anew there.

    The parameters are those of `finish_step`.
    """
    driver, events, joined = m.work.driver, out.events, False
    first = driver.events
    count, crossed, restart = handle_mesh(m, t, y, events, first)
    for i in range(list_known(m, y) if m.scene.population.flanks == 0 else 0):
        k = m.work.known[i]
        event = find_event(m, y, flank_of_history(m, k), m.state.history[k].pair, k)
        if event.touches or event.stretches or event.turns:
            joined |= event.turns and m.state.history[k].direction < 0.0
            observers.event(m, t, y, yp, event)
            count = take_event(m, t, y, event, events, count)
    if m.scene.population.flanks != 0:
        if switch_asperities(m, y):
            restart = True
            observers.asperity_switches(m, y)
        count, too_many = record_switches(m, t, y, events, count)
        if too_many:
            driver.error = MANY_EVENTS
    if m.scene.friction.on != 0:
        count, jumped = follow_sliding(m, t, y, events, count)
        restart |= jumped
    if m.scene.guarded != 0:
        count, jumped = switch_shafts(m, t, y, events, count)
        restart |= jumped
    if m.scene.law_switches != 0 and set_law_sides(m, t, y):
        note_law_jump(m)
        restart = True
    driver.events = count
    observers.resume(m, t, y, crossed, joined)
    if crossed and m.scene.follow.passages != 0:
        driver.passages = write_passages(m, t, y, events, (first, count), out.passages, driver.passages)
    if chatters(m, t):
        driver.error = CHATTER
    return restart


@compiled_once(SOLVER)
def prepare_start(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Set consistent rates, and what the observers of a run know of the time before, for a start at t."""
    set_law_window(m)
    if m.scene.law_switches != 0:
        set_law_sides(m, t, y)
    if m.scene.guarded != 0:
        set_shaft_sides(m, y)
    if m.scene.friction.ages != 0:
        begin_ageing(m, t, y)
    begin_rest(m, t, y)
    set_rates(m, t, y, yp)
    observers.begin(m, t, y, yp)
    m.work.driver.step_end, m.work.driver.step = t, 0.0


@compiled
def prepare_restart(m: Model, y: Floats, yp: Floats) -> None:
    """Bring the observers up to the time reached and move whole pitches out of the phase, before a start from here."""
    observers.finish(m, m.work.driver.time, y, yp)
    rebase(m, y)
    m.state.progress.restarts += 1
