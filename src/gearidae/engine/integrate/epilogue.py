"""Common work of both drivers at an accepted time and before a restart."""

from __future__ import annotations

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.events.events import CROWDED, RESTART, balance_can_wait, handle
from gearidae.engine.events.histories import accept
from gearidae.engine.events.record import EVENTS_AT_ONCE
from gearidae.engine.events.run_stop import stop_guard
from gearidae.engine.events.schedule_knots import keeps_checkpoint, pass_knot
from gearidae.engine.followers.balance import accumulate_energy, close_balance, restart_quadrature
from gearidae.engine.followers.exposures.follow import expose_step, follow_exposures
from gearidae.engine.followers.extremes.follow import follow_extremes, note_rest, restart_extremes
from gearidae.engine.followers.joining import follow_joining
from gearidae.engine.integrate import adams
from gearidae.engine.integrate.driver import BOUND_EXCEEDED, CHATTER, CHECKPOINT_STEPS, LIGHT
from gearidae.engine.integrate.start import PHASE_HIGH, rebase, set_rates
from gearidae.engine.integrate.step_control import change_wanted
from gearidae.engine.model.state import GEARS, PHASE, Floats, Model, W
from gearidae.engine.pairs.tooth_pairs import in_flight

__all__ = ["ROOT", "STOP", "finish_step", "has_room", "prepare_restart", "prepare_start"]

STOP, ROOT = 1, 2
"""IDA's flags for a stop and for a root."""

BALANCE_ORDER = 4
"""Order of the energy balance's quadrature."""


@compiled
def has_room(count: int, events: Floats) -> bool:
    """Whether all events of one more accepted time find room in the block: else it is handed out first."""
    return bool(count <= events.shape[0] - EVENTS_AT_ONCE)


@compiled(inline=True)
def finish_step(
    m: Model, y: Floats, yp: Floats, between: tuple[Floats, Floats], flag: int, events: Floats
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
    events : ndarray, shape (n, 5)
        Of the block; see `has_room`.

    Returns
    -------
    bool
        Whether the integration must restart from here.
    """
    driver, t = m.work.driver, m.work.driver.time
    accept(m, t, y)
    follow_joining(m, t - m.work.track.time, y, yp[W] if m.scene.kind == GEARS else 0.0, flag != 0)
    follow_extremes(m, t, y, yp, flag != 0, between[0])
    _book(m, t, y, yp, between, flag)
    if m.state.bound_exceeded != 0:
        driver.error = BOUND_EXCEEDED
    if in_flight(m):
        m.state.progress.flight_steps += 1
    afresh = m.scene.kind == GEARS and abs(y[PHASE]) > PHASE_HIGH
    afresh |= change_wanted(m, y, yp)
    if flag == ROOT:
        driver.events, action = handle(m, t, y, events, driver.events)
        afresh |= action == RESTART
        note_rest(m, t, y)
        if action == CROWDED:
            driver.error = CHATTER
        if m.scene.stop != 0 and stop_guard(m, y) <= 0.0:
            driver.done = 1
        if m.state.light != 0 and driver.done == 0 and driver.error == 0:
            driver.error = LIGHT
    else:
        driver.step, driver.step_end = t - driver.step_end, t
    if flag == STOP:
        if m.state.next_knot < m.scene.knot_count:
            if keeps_checkpoint(m):
                driver.since = CHECKPOINT_STEPS
            driver.events = pass_knot(m, t, events, driver.events)
            afresh = True
        else:
            driver.done = 1
    if m.scene.places > 0 and (driver.done != 0 or driver.error != 0):
        follow_exposures(m, t, y, yp, True)
    return afresh


@compiled(inline=True)
def _book(m: Model, t: float, y: Floats, yp: Floats, between: tuple[Floats, Floats], flag: int) -> None:
    """Update the energy balance up to an accepted time, before the event there is handled.

    A turning point needs no sample. In free flight, where only torques and drag are integrated, formulas of high
    order take steps that are too long for the quadrature; these steps are divided.
    """
    if flag == ROOT and balance_can_wait(m, t, y):
        return
    now = flag != 0 or m.state.bound_exceeded != 0
    a, parts, start = m.work.adams, 1, m.work.quadrature.time
    if a.order_used > BALANCE_ORDER and in_flight(m) and m.scene.kind == GEARS:
        parts = m.scene.flight_parts
        start = max(start, a.time - a.last_step)
    for part in range(1, parts + 1):
        time, state, rates = t, y, yp
        if part < parts:
            time, state, rates = start + (t - start) * part / parts, between[0], between[1]
            adams.between(a, time, state, rates)
        accumulate_energy(m, time, state, rates, now or part < parts)
    if m.scene.places > 0:
        if m.scene.nodes == 0:
            if flag != ROOT:
                expose_step(m, t, y, yp)
        elif m.work.quadrature.time == t:  # forces have to be evaluated for it
            follow_exposures(m, t, y, yp, False)


@compiled_once(SOLVER)
def prepare_start(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Set consistent rates, and what the followers of a run know of the time before, for a start at t."""
    set_rates(m, t, y, yp)
    restart_quadrature(m, t, y, yp)
    restart_extremes(m, t, y, yp)
    m.work.driver.step_end, m.work.driver.step = t, 0.0


@compiled
def prepare_restart(m: Model, y: Floats, yp: Floats) -> None:
    """Close the energy balance's interval and move whole pitches out of the phase, before a start from here."""
    close_balance(m, m.work.driver.time, y, yp)
    if m.scene.places > 0:
        follow_exposures(m, m.work.driver.time, y, yp, True)
    rebase(m, y)
    m.state.progress.restarts += 1
