"""The native driver: SUNDIALS IDA driven from one compiled loop with compiled callbacks.

Python sees only full blocks: `advance` steps, follows histories, handles roots and writes samples until a block of
output is full, a budget of steps is used up, or the run is over, and can be called again where it left off.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine.elastic.static_solve import fold_gap
from gearidae.engine.energy.balance import enter, follow
from gearidae.engine.events.events import (
    CROWDED,
    EVENTS_AT_ONCE,
    RESTART,
    accept,
    handle,
    ledger_can_wait,
    pass_knot,
)
from gearidae.engine.integrate import adams
from gearidae.engine.integrate.driver import (
    BLOCK_EVENTS,
    BLOCK_ROWS,
    BLOCK_STEPS,
    CHECKPOINT_STEPS,
    CODES,
    Block,
    Ending,
    Tally,
    ending_of_flag,
    sample_time,
)
from gearidae.engine.integrate.root_finding import (
    AS_IDA,
    CALLS,
    SEARCH,
    SHARP,
    SHARPNESS,
    next_time,
    start_search,
)
from gearidae.engine.integrate.start import PHASE_HIGH, first_step, rebase, set_rates
from gearidae.engine.integrate.step_control import change_wanted, tell
from gearidae.engine.model import layout as at
from gearidae.engine.model.observe import observe
from gearidae.engine.model.problem import Problem
from gearidae.engine.model.tooth_pairs import in_flight
from gearidae.engine.sundials import names as sun
from gearidae.engine.sundials.callbacks import callbacks
from gearidae.engine.sundials.ida_memory import DKY, HANDLES, SOLVER, YP, Y, close, open_solver

__all__ = ["book", "restart", "run", "state_for_sample"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Progress of a run, kept between calls of `advance`.
(
    NEXT_SAMPLE,
    ROWS,
    EVENTS,
    PENDING,
    DONE,
    ERROR,
    STEPS,
    RESIDUALS,
    JACOBIANS,
    ERROR_FAILURES,
    CONVERGENCE_FAILURES,
    RESTARTS,
    GUARD_CALLS,
    SINCE,
    FLIGHT,
    PROGRESS,
) = range(16)
COUNTERS = PROGRESS
LEDGER_ORDER = 4  # that of the ledger's quadrature
# progress[ERROR]: what events, histories and folds may end a run with; negative numbers are IDA's own
CHATTER, BEYOND = CODES


@compiled(makes_arrays=True)
def _count(solver: int, desk: Floats, search: Floats, progress: Ints) -> None:
    """Add IDA's counters, which start from zero at each re-initialisation, the desk's and the search's."""
    cell = np.zeros(1, np.int64)
    sun.IDAGetNumSteps(solver, cell.ctypes.data)
    progress[STEPS] += cell[0]
    evaluations = int(desk[adams.EVALUATIONS])  # of residual and Jacobian at once
    progress[RESIDUALS] += evaluations
    progress[JACOBIANS] += evaluations
    if desk[adams.OWN] == 0.0:
        sun.IDAGetNumResEvals(solver, cell.ctypes.data)
        progress[RESIDUALS] += cell[0]
        sun.IDAGetNumJacEvals(solver, cell.ctypes.data)
        progress[JACOBIANS] += cell[0]
    sun.IDAGetNumErrTestFails(solver, cell.ctypes.data)
    progress[ERROR_FAILURES] += cell[0]
    sun.IDAGetNumNonlinSolvConvFails(solver, cell.ctypes.data)
    progress[CONVERGENCE_FAILURES] += cell[0] + int(desk[adams.FAILURES])
    progress[GUARD_CALLS] += int(search[CALLS])
    search[CALLS] = 0.0
    desk[adams.EVALUATIONS] = desk[adams.FAILURES] = 0.0


@compiled
def restart(
    handles: Ints,
    desk: Floats,
    d: Floats,
    t: float,
    y: Floats,
    yp: Floats,
    scale: Floats,
    rtol: float,
    stop: float,
) -> int:
    """Set consistent rates and the first step, and (re-)initialise IDA at t; its flag is returned."""
    solver = handles[SOLVER]
    set_rates(d, t, y, yp)
    enter(d, t, y, yp)
    flag = sun.IDAReInit(solver, t, handles[Y], handles[YP])
    flag |= sun.IDASetInitStep(solver, first_step(d, t, y, yp, scale, rtol, stop - t))
    flag |= sun.IDASetStopTime(solver, stop)
    if desk[adams.OWN] != 0.0:
        adams.begin(desk, t, y, yp)
        flag |= tell(solver, desk)
    return flag


@compiled
def state_for_sample(handles: Ints, desk: Floats, t: float, dky: Floats, spare: Floats) -> None:
    """State at a time within the last step, beside that at its end."""
    if desk[adams.USED] > 0.0:
        adams.between(desk, t, dky, spare)
    else:
        sun.IDAGetDky(handles[SOLVER], t, 0, handles[DKY])


@compiled(inline=True)
def book(
    desk: Floats, d: Floats, t: float, y: Floats, yp: Floats, dky: Floats, spare: Floats, flag: int
) -> None:
    """Keep the ledger up to an accepted time, and what IDA's flag says of it, before it is handled.

    Where a pair turns round nothing has to be kept. In flight, where torques and drag are all that is left to
    integrate, formulas that look back far take steps that are too long for the quadrature: these are divided.
    """
    if flag == sun.IDA_ROOT_RETURN and ledger_can_wait(d, t, y):
        return
    now = flag != 0 or d[at.PASSED] != 0.0
    parts, start = 1, d[at.LEDGER_TIME]
    if desk[adams.USED] > LEDGER_ORDER and in_flight(d) and d[at.KIND] == at.GEARS:
        parts = int(d[at.LEDGER_PARTS])
        start = max(start, desk[adams.NOW] - desk[adams.LAST_STEP])
    for part in range(1, parts + 1):
        time, state, rates = t, y, yp
        if part < parts:
            time, state, rates = start + (t - start) * part / parts, dky, spare
            adams.between(desk, time, dky, spare)
        follow(d, time, state, rates, now or part < parts)


@compiled
def advance(
    handles: Ints,
    desk: Floats,
    search: Floats,
    d: Floats,
    y: Floats,
    yp: Floats,
    dky: Floats,
    spare: Floats,
    clock: Floats,
    scale: Floats,
    rtol: float,
    end: float,
    knots: Floats,
    total: int,
    rows: Floats,
    events: Floats,
    progress: Ints,
    budget: int,
) -> float:
    """Run until a block of output is full, `budget` steps are done or the run is over.

    Parameters
    ----------
    handles : ndarray of int64
        From `open_solver`.
    desk, d, y, yp, dky : ndarray
        The arrays given to `open_solver`.
    spare : ndarray, shape (n,)
        Work space.
    search : ndarray, shape (SEARCH,)
        See `gearidae.engine.integrate.root_finding`.
    clock : ndarray, shape (1,)
        Time reached, over tau.
    scale, rtol, end, knots
        See `gearidae.engine.model.problem.Problem`.
    total : int
        Number of samples in the whole run.
    rows : ndarray, shape (m, columns)
        Samples of this block.
    events : ndarray, shape (k, 5)
        Events of this block.
    progress : ndarray of int64, shape (PROGRESS,)
        Where the run stands; ROWS and EVENTS are set to zero by the caller between calls.
    budget : int
        Steps to do at most.

    Returns
    -------
    float
        Time reached, over tau.
    """
    solver = handles[SOLVER]
    knot = int(d[at.NEXT_KNOT])
    stop = knots[knot] if knot < knots.size else end
    room = events.shape[0] - EVENTS_AT_ONCE
    flag = progress[PENDING] - 1
    if progress[PENDING] < 0:  # a fresh start
        desk[adams.WANTED] = desk[adams.OWN]
        progress[ERROR] = restart(handles, desk, d, clock[0], y, yp, scale, rtol, stop)
        start_search(d, clock[0], y, search)
        progress[PENDING] = 0
    while progress[ERROR] == 0 and progress[DONE] == 0 and budget > 0 and progress[EVENTS] < room:
        if progress[PENDING] == 0:
            flag = next_time(solver, handles[Y : YP + 1], desk, d, y, yp, clock, end, search)
            budget -= 1
            progress[SINCE] += 1
            if flag < 0:
                progress[ERROR] = flag
                break
        t = clock[0]
        sample = sample_time(progress[NEXT_SAMPLE], total, end)
        while sample <= t and progress[ROWS] < rows.shape[0]:
            state_for_sample(handles, desk, sample, dky, spare)
            observe(d, sample, dky, rows[progress[ROWS]])
            progress[ROWS] += 1
            progress[NEXT_SAMPLE] += 1
            sample = sample_time(progress[NEXT_SAMPLE], total, end)
        if sample <= t:  # the block is full: the step waits with its flag
            progress[PENDING] = flag + 1
            break
        progress[PENDING] = 0
        accept(d, t, y)
        book(desk, d, t, y, yp, dky, spare, flag)
        if d[at.PASSED] != 0.0:
            progress[ERROR] = BEYOND
        if in_flight(d):
            progress[FLIGHT] += 1
        afresh = d[at.KIND] == at.GEARS and abs(y[at.PHASE]) > PHASE_HIGH
        afresh |= change_wanted(desk, d, y, yp)
        if flag == sun.IDA_ROOT_RETURN:
            progress[EVENTS], action = handle(d, t, y, events, progress[EVENTS])
            afresh |= action == RESTART
            if action == CROWDED:
                progress[ERROR] = CHATTER
        elif flag == sun.IDA_TSTOP_RETURN:
            if knot < knots.size:
                progress[EVENTS] = pass_knot(d, t, events, progress[EVENTS])
                knot += 1
                stop = knots[knot] if knot < knots.size else end
                afresh = True
            else:
                progress[DONE] = 1
        checkpoint = progress[SINCE] >= CHECKPOINT_STEPS
        afresh |= checkpoint
        if afresh and progress[DONE] == 0 and progress[ERROR] == 0:
            _count(solver, desk, search, progress)
            follow(d, t, y, yp, afresh)
            rebase(d, y)
            progress[RESTARTS] += 1
            if checkpoint:
                progress[SINCE] = 0
                progress[PENDING] = -1
                break
            progress[ERROR] = restart(handles, desk, d, t, y, yp, scale, rtol, stop)
            start_search(d, t, y, search)
    if progress[DONE] != 0 or progress[ERROR] != 0:
        _count(solver, desk, search, progress)
    return float(clock[0])


def run(
    problem: Problem,
    rtol: float,
    total: int,
    tally: Tally,
    resume: Floats | None = None,
    as_ida: bool = False,
) -> Iterator[Block]:
    """Run a problem, block by block.

    Parameters
    ----------
    problem : Problem
        Its data change as the run goes on.
    rtol : float
        Relative tolerance.
    total : int
        Number of samples, the first at time 0 and the last at the end; 0 for none.
    tally : Tally
        Filled in; complete once the last block is out.
    resume : ndarray, optional
        Checkpoint of an earlier run of the same problem, tolerance and sampling, to go on from.
    as_ida : bool
        Whether formulas, iteration and the state at a step's end are IDA's own: slower, less accurate, and equal to the
        portable driver to the last bit.

    Yields
    ------
    Block
    """
    d, y, clock = problem.data, problem.start.copy(), np.zeros(1)
    yp, dky, spare = np.zeros_like(y), np.zeros_like(y), np.zeros_like(y)
    rows, events = np.empty((BLOCK_ROWS, len(problem.columns))), np.empty((BLOCK_EVENTS, 5))
    handles, progress = np.zeros(HANDLES, np.int64), np.zeros(PROGRESS, np.int64)
    desk, search = np.zeros(adams.DESK), np.zeros(SEARCH)
    search[AS_IDA], search[SHARP] = as_ida, SHARPNESS * rtol
    progress[PENDING] = -1
    if resume is not None:
        clock[0] = problem.restore(resume, y, progress)
        progress[[ROWS, EVENTS]] = 0
    elif total > 0:
        observe(d, 0.0, y, rows[0])
        progress[[ROWS, NEXT_SAMPLE]] = 1
    try:
        problem.set_tolerance(rtol)
        elastic = d[at.NODES] > 0.0
        calls = callbacks(y.size, bool(elastic), as_ida)
        flag = open_solver(
            handles,
            calls.model,
            calls.steps,
            calls.newton,
            calls.vectors,
            sun.places(),
            sun.newton_places(),
            sun.vector_places(),
            desk,
            d,
            y,
            yp,
            dky,
        )
        if flag != 0:
            tally.ending = Ending.SOLVER_FAILURE
            return
        beyond = False
        while progress[DONE] == 0 and progress[ERROR] == 0 and not beyond:
            time = advance(
                handles,
                desk,
                search,
                d,
                y,
                yp,
                dky,
                spare,
                clock,
                problem.tolerance_scale,
                rtol,
                problem.end,
                problem.knots,
                total,
                rows,
                events,
                progress,
                BLOCK_STEPS,
            )
            _fill_tally(tally, progress, elastic)
            if progress[ERROR] < 0 and elastic:
                tally.note_fold(fold_gap(d, d[at.LAST_TIME]) * d[at.SIGMA])
            if progress[ERROR] == BEYOND:  # whoever goes on from here starts afresh
                progress[[ERROR, PENDING]] = 0, -1
                progress[RESTARTS] += 1
                beyond = True
            ready = progress[PENDING] < 0 or progress[DONE] != 0
            yield Block(
                rows[: progress[ROWS]].copy(),
                events[: progress[EVENTS]].copy(),
                time * problem.time_unit,
                problem.checkpoint(time, y, progress) if ready else None,
                problem.ledger(time, y, yp) if progress[PENDING] <= 0 else None,
            )
            progress[[ROWS, EVENTS]] = 0
    finally:
        close(handles)


def _fill_tally(tally: Tally, progress: Ints, elastic: bool) -> None:
    tally.steps = int(progress[STEPS])
    tally.residual_evaluations = int(progress[RESIDUALS])
    tally.jacobian_evaluations = int(progress[JACOBIANS])
    tally.error_test_failures = int(progress[ERROR_FAILURES])
    tally.convergence_failures = int(progress[CONVERGENCE_FAILURES])
    tally.restarts = int(progress[RESTARTS])
    tally.guard_evaluations = int(progress[GUARD_CALLS])
    tally.flight_steps = int(progress[FLIGHT])
    tally.ending = ending_of_flag(int(progress[ERROR]), elastic)
