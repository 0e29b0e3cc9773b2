"""The native driver: SUNDIALS IDA driven from one compiled loop with compiled callbacks.

Python sees only full blocks: `advance` steps, follows histories, handles roots and writes samples until a block of
output is full, a budget of steps is used up, or the run is over, and can be called again where it left off.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine import layout as at
from gearidae.engine import sundials as sun
from gearidae.engine.blocks import store_size
from gearidae.engine.callbacks import callbacks
from gearidae.engine.events import CROWDED, EVENTS_AT_ONCE, RESTART, accept, handle, pass_knot
from gearidae.engine.ledger import enter, follow
from gearidae.engine.observe import observe
from gearidae.engine.problem import Problem
from gearidae.engine.run import (
    BLOCK_EVENTS,
    BLOCK_ROWS,
    BLOCK_STEPS,
    CHECKPOINT_STEPS,
    CODES,
    CONVERGENCE_FAILURES_HIGH,
    Block,
    Ending,
    Tally,
    ending_of_flag,
    sample_time,
)
from gearidae.engine.settle import fold_gap
from gearidae.engine.start import PHASE_HIGH, first_step, rebase, set_rates

__all__ = ["callbacks", "run"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Handles: addresses of what SUNDIALS has made.
CONTEXT, SOLVER, Y, YP, DKY, MATRIX, LINEAR, HANDLES = range(8)

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
# progress[ERROR]: what events, histories and folds may end a run with; negative numbers are IDA's own
CHATTER, BEYOND = CODES


@compiled
def open_solver(
    handles: Ints,
    model: Ints,
    steps: Ints,
    where: Ints,
    d: Floats,
    y: Floats,
    yp: Floats,
    dky: Floats,
) -> int:
    """Create IDA with a linear solver of our own over the caller's arrays; 0 if all went well.

    Parameters
    ----------
    handles : ndarray of int64, shape (HANDLES,)
        Filled in.
    model, steps : ndarray of int64
        See `gearidae.engine.callbacks.Callbacks`.
    where : ndarray of int64
        From `gearidae.engine.sundials.places`.
    d, y, yp, dky : ndarray
        User data, state, rates and work space: must outlive the solver.
    """
    n = y.size
    flag = sun.SUNContext_Create(0, handles[CONTEXT:].ctypes.data)
    if flag != 0:
        return flag
    context = handles[CONTEXT]
    sun.SUNContext_ClearErrHandlers(context)
    handles[Y] = sun.N_VMake_Serial(n, y.ctypes.data, context)
    handles[YP] = sun.N_VMake_Serial(n, yp.ctypes.data, context)
    handles[DKY] = sun.N_VMake_Serial(n, dky.ctypes.data, context)
    sun.N_VEnableFusedOps_Serial(handles[Y], 1)  # the clones that IDA makes inherit them
    # the matrix is a column to keep numbers in, so the dense solver is made for another and its steps replaced
    handles[MATRIX] = sun.SUNDenseMatrix(1, 1, context)
    single = sun.N_VMake_Serial(1, y.ctypes.data, context)
    handles[LINEAR] = sun.SUNLinSol_Dense(single, handles[MATRIX], context)
    sun.N_VDestroy(single)
    sun.SUNMatDestroy(handles[MATRIX])
    handles[MATRIX] = sun.SUNDenseMatrix(store_size(d) if d[at.NODES] > 0.0 else n * (n + 1), 1, context)
    sun.replace(handles[LINEAR], where, steps)
    solver = sun.IDACreate(context)
    handles[SOLVER] = solver
    flag |= sun.IDAInit(solver, model[0], d[at.LAST_TIME], handles[Y], handles[YP])
    flag |= sun.IDAWFtolerances(solver, model[3])
    flag |= sun.IDASetUserData(solver, d.ctypes.data)
    flag |= sun.IDASetLinearSolver(solver, handles[LINEAR], handles[MATRIX])
    flag |= sun.IDASetJacFn(solver, model[1])
    flag |= sun.IDASetMaxNumSteps(solver, -1)
    flag |= sun.IDASetMaxConvFails(solver, CONVERGENCE_FAILURES_HIGH)
    falling = np.full(1, -1, np.int32)
    flag |= sun.IDARootInit(solver, 1, model[2])
    flag |= sun.IDASetRootDirection(solver, falling.ctypes.data)
    flag |= sun.IDASetNoInactiveRootWarn(solver)
    return flag


@compiled
def close(handles: Ints) -> None:
    """Free what `open_solver` has made."""
    cell = np.empty(1, np.int64)
    if handles[SOLVER] != 0:
        cell[0] = handles[SOLVER]
        sun.IDAFree(cell.ctypes.data)
    if handles[LINEAR] != 0:
        sun.SUNLinSolFree(handles[LINEAR])
    if handles[MATRIX] != 0:
        sun.SUNMatDestroy(handles[MATRIX])
    for k in (Y, YP, DKY):
        if handles[k] != 0:
            sun.N_VDestroy(handles[k])
    if handles[CONTEXT] != 0:
        cell[0] = handles[CONTEXT]
        sun.SUNContext_Free(cell.ctypes.data)
    handles[:] = 0


@compiled
def _count(solver: int, progress: Ints) -> None:
    """Add IDA's counters, which start from zero at each re-initialisation."""
    cell = np.zeros(1, np.int64)
    sun.IDAGetNumSteps(solver, cell.ctypes.data)
    progress[STEPS] += cell[0]
    sun.IDAGetNumResEvals(solver, cell.ctypes.data)
    progress[RESIDUALS] += cell[0]
    sun.IDAGetNumJacEvals(solver, cell.ctypes.data)
    progress[JACOBIANS] += cell[0]
    sun.IDAGetNumErrTestFails(solver, cell.ctypes.data)
    progress[ERROR_FAILURES] += cell[0]
    sun.IDAGetNumNonlinSolvConvFails(solver, cell.ctypes.data)
    progress[CONVERGENCE_FAILURES] += cell[0]
    sun.IDAGetNumGEvals(solver, cell.ctypes.data)
    progress[GUARD_CALLS] += cell[0]


@compiled
def _start(
    solver: int,
    handles: Ints,
    d: Floats,
    t: float,
    y: Floats,
    yp: Floats,
    scale: Floats,
    rtol: float,
    stop: float,
) -> int:
    """Set consistent rates and the first step, and (re-)initialise IDA at t."""
    set_rates(d, t, y, yp)
    enter(d, t, y, yp)
    flag = sun.IDAReInit(solver, t, handles[Y], handles[YP])
    flag |= sun.IDASetInitStep(solver, first_step(d, t, y, yp, scale, rtol, stop - t))
    flag |= sun.IDASetStopTime(solver, stop)
    return flag


@compiled
def advance(
    handles: Ints,
    d: Floats,
    y: Floats,
    yp: Floats,
    dky: Floats,
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
    d, y, yp, dky : ndarray
        The arrays given to `open_solver`.
    clock : ndarray, shape (1,)
        Time reached, over tau.
    scale, rtol, end, knots
        See `gearidae.engine.problem.Problem`.
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
        progress[ERROR] = _start(solver, handles, d, clock[0], y, yp, scale, rtol, stop)
        progress[PENDING] = 0
    while progress[ERROR] == 0 and progress[DONE] == 0 and budget > 0 and progress[EVENTS] < room:
        if progress[PENDING] == 0:
            flag = sun.IDASolve(solver, end, clock.ctypes.data, handles[Y], handles[YP], sun.IDA_ONE_STEP)
            budget -= 1
            progress[SINCE] += 1
            if flag < 0:
                progress[ERROR] = flag
                break
        t = clock[0]
        sample = sample_time(progress[NEXT_SAMPLE], total, end)
        while sample <= t and progress[ROWS] < rows.shape[0]:
            sun.IDAGetDky(solver, sample, 0, handles[DKY])
            observe(d, sample, dky, rows[progress[ROWS]])
            progress[ROWS] += 1
            progress[NEXT_SAMPLE] += 1
            sample = sample_time(progress[NEXT_SAMPLE], total, end)
        if sample <= t:  # the block is full: the step waits with its flag
            progress[PENDING] = flag + 1
            break
        progress[PENDING] = 0
        accept(d, t, y)
        follow(d, t, y, yp, flag != 0 or d[at.PASSED] != 0.0)
        if d[at.PASSED] != 0.0:
            progress[ERROR] = BEYOND
        if d[at.NEAR] == 0.0 and d[at.NEAR + 1] == 0.0:
            progress[FLIGHT] += 1
        restart = d[at.KIND] == at.GEARS and abs(y[at.PHASE]) > PHASE_HIGH
        if flag == sun.IDA_ROOT_RETURN:
            progress[EVENTS], action = handle(d, t, y, events, progress[EVENTS])
            restart |= action == RESTART
            if action == CROWDED:
                progress[ERROR] = CHATTER
        elif flag == sun.IDA_TSTOP_RETURN:
            if knot < knots.size:
                progress[EVENTS] = pass_knot(d, t, events, progress[EVENTS])
                knot += 1
                stop = knots[knot] if knot < knots.size else end
                restart = True
            else:
                progress[DONE] = 1
        checkpoint = progress[SINCE] >= CHECKPOINT_STEPS
        if (restart or checkpoint) and progress[DONE] == 0 and progress[ERROR] == 0:
            _count(solver, progress)
            follow(d, t, y, yp, True)
            rebase(d, y)
            progress[RESTARTS] += 1
            if checkpoint:
                progress[SINCE] = 0
                progress[PENDING] = -1
                break
            progress[ERROR] = _start(solver, handles, d, t, y, yp, scale, rtol, stop)
    if progress[DONE] != 0 or progress[ERROR] != 0:
        _count(solver, progress)
    return float(clock[0])


def run(
    problem: Problem, rtol: float, total: int, tally: Tally, resume: Floats | None = None
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

    Yields
    ------
    Block
    """
    d, y, clock = problem.data, problem.start.copy(), np.zeros(1)
    yp, dky = np.zeros_like(y), np.zeros_like(y)
    rows, events = np.empty((BLOCK_ROWS, len(problem.columns))), np.empty((BLOCK_EVENTS, 5))
    handles, progress = np.zeros(HANDLES, np.int64), np.zeros(PROGRESS, np.int64)
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
        calls = callbacks(y.size, bool(elastic))
        flag = open_solver(handles, calls.model, calls.steps, sun.places(), d, y, yp, dky)
        if flag != 0:
            tally.ending = Ending.SOLVER_FAILURE
            return
        beyond = False
        while progress[DONE] == 0 and progress[ERROR] == 0 and not beyond:
            time = advance(
                handles,
                d,
                y,
                yp,
                dky,
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
