"""The native driver: SUNDIALS IDA driven from one compiled loop with compiled callbacks.

Python sees only full blocks: `advance` steps, follows histories, handles roots and writes samples until a block of
output is full, a budget of steps is used up, or the run is over, and can be called again where it left off.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator

import numpy as np

from gearidae.arrays import Ints
from gearidae.compiled import compiled
from gearidae.engine import adams
from gearidae.engine.elastic.static_condensation import begin_deflections
from gearidae.engine.events.stops import next_stop
from gearidae.engine.integrate.accepted_step import finish_step, has_room, prepare_restart, prepare_start
from gearidae.engine.integrate.callbacks import callbacks
from gearidae.engine.integrate.driver import (
    BLOCK_SECONDS,
    BLOCK_STEPS,
    CHECKPOINT_STEPS,
    CONVERGENCE_FAILURES_HIGH,
    MODEL_CHANGES,
    Block,
    Ending,
    Output,
    SampleReader,
    ending_of_flag,
    sample_time,
    update_statistics,
)
from gearidae.engine.integrate.entry_points import observe_at
from gearidae.engine.integrate.resting import longest_step, rest_step
from gearidae.engine.integrate.root_finding import SHARPNESS, Arrays, Stepper, next_time, start_search
from gearidae.engine.integrate.start import first_step
from gearidae.engine.integrate.step_control import configure_ida
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.motion.observe import observe
from gearidae.engine.motion.pair_forces import is_eliminated, set_deflections
from gearidae.engine.motion.static_solve import fold_gap
from gearidae.engine.setup.problem import Problem
from gearidae.engine.sundials import names as sun
from gearidae.engine.sundials.ida_memory import DKY, HANDLES, IDA, YP, Places, Y, close_solver, open_solver
from gearidae.records import Statistics

FIRST_STEPS = 1_000
"""Steps of the first block, before it is known what a step costs; of elastic bodies and discrete asperities, one."""
GROWTH_HIGH = 50
"""By how much a block may have more steps than the one before."""


@compiled
def _new(cell: Ints, counted: Ints, which: int) -> int:
    """What one of IDA's counters has gained since it was last added."""
    gained = int(cell[0] - counted[which])
    counted[which] = cell[0]
    return gained


@compiled(makes_arrays=True)
def _count(s: Stepper) -> None:
    """Add what counters of IDA, which start from zero at each re-initialisation, formulas and root search gained."""
    progress, a, search, ida = s.m.state.progress, s.m.work.adams, s.m.work.search, s.handles[IDA]
    cell, counted = np.zeros(1, np.int64), s.m.work.driver.counted
    sun.IDAGetNumSteps(ida, cell.ctypes.data)
    progress.steps += _new(cell, counted, 0)
    progress.residual_evaluations += a.evaluations  # of residual and Jacobian at once
    progress.jacobian_evaluations += a.evaluations
    if a.native_newton == 0:
        sun.IDAGetNumResEvals(ida, cell.ctypes.data)
        progress.residual_evaluations += _new(cell, counted, 1)
        sun.IDAGetNumJacEvals(ida, cell.ctypes.data)
        progress.jacobian_evaluations += _new(cell, counted, 2)
    sun.IDAGetNumErrTestFails(ida, cell.ctypes.data)
    progress.error_test_failures += _new(cell, counted, 3)
    sun.IDAGetNumNonlinSolvConvFails(ida, cell.ctypes.data)
    progress.convergence_failures += _new(cell, counted, 4) + a.failures
    progress.guard_evaluations += search.evaluations
    search.evaluations = a.evaluations = a.failures = 0


@compiled
def restart(s: Stepper, stop: float) -> int:
    """Set consistent rates and the first step, and (re-)initialise IDA at the time reached; its flag is returned."""
    ida, m, t = s.handles[IDA], s.m, s.clock[0]
    prepare_start(m, t, s.y, s.yp)
    adams.begin(m.work.adams, t, s.y, s.yp)
    if m.work.driver.resting != 0:
        return 0
    flag = sun.IDAReInit(ida, t, s.handles[Y], s.handles[YP])
    m.work.driver.counted[:] = 0
    flag |= sun.IDASetInitStep(ida, first_step(m, t, s.y, s.yp, stop - t))
    flag |= sun.IDASetStopTime(ida, stop)
    flag |= sun.IDASetMaxStep(ida, longest_step(m))
    if m.work.adams.native_newton != 0:
        if m.scene.nodes > 0:
            begin_deflections(m, t, s.y)
        flag |= configure_ida(ida, m.work.adams)
    start_search(s)
    return flag


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
def state_at_sample(place: int, arrays: Arrays, t: float) -> None:
    """`state_for_sample`, for Python."""
    m = model_at(place)
    s = Stepper(arrays.handles, m, arrays.y, arrays.yp, arrays.dky, arrays.spare, arrays.clock)
    state_for_sample(s, t)


@compiled(inline=True)
def _sample(s: Stepper, rows: Floats) -> bool:
    """Write the samples up to the time reached; whether the block has room for them all."""
    m, driver, progress = s.m, s.m.work.driver, s.m.state.progress
    sample = sample_time(m, progress.next_sample)
    while sample <= s.clock[0] and driver.rows < rows.shape[0]:
        state_for_sample(s, sample)
        observe(m, sample, s.dky, rows[driver.rows])
        driver.rows += 1
        progress.next_sample += 1
        sample = sample_time(m, progress.next_sample)
    return sample > s.clock[0]


@compiled
def advance(place: int, arrays: Arrays, out: Output, budget: int) -> None:
    """Run until a block of output is full, `budget` steps are done or the run is over.

    Parameters
    ----------
    place : int
        Where the model lies, from `Addresses`; its ``work.driver`` says where the run stands.
    out : Output
        Rows, events and passages of this block.
    budget : int
        Steps to do at most.
    """
    m = model_at(place)
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
        and has_room(driver.events, driver.passages, out)
    ):
        if driver.pending == 0:
            if driver.resting != 0:
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
        if not _sample(s, out.rows):  # the block is full: the step waits with its flag
            driver.pending = flag + 1
            break
        driver.pending = 0
        afresh = finish_step(m, s.y, s.yp, (s.dky, s.spare), flag, out)
        checkpoint = driver.since >= CHECKPOINT_STEPS
        if (afresh or checkpoint) and driver.done == 0 and driver.error == 0:
            _count(s)
            prepare_restart(m, s.y, s.yp)
            if checkpoint:
                driver.since = 0
                driver.pending = -1
                break
            driver.error = restart(s, next_stop(m))
    _count(s)


def _next_budget(budget: int, seconds: float) -> int:
    """Steps of the next block, for one that took some time: a step may cost a microsecond or a tenth of a second."""
    wanted = budget * BLOCK_SECONDS / max(seconds, 1e-9)
    return int(min(max(wanted, 1.0), GROWTH_HIGH * budget, BLOCK_STEPS))


def make_arrays(problem: Problem, m: Model, as_ida: bool) -> Arrays:
    """Make the arrays that a run steps with, at its start."""
    y = problem.start.copy()
    m.work.search.as_ida, m.work.search.sharpness = int(as_ida), SHARPNESS * m.scene.rtol
    m.work.driver.pending = -1
    handles = np.zeros(HANDLES, np.int64)
    return Arrays(handles, y, np.zeros_like(y), np.zeros_like(y), np.zeros_like(y), np.zeros(1))


def _weigh_motion(m: Model) -> int:
    """Set the error weights of a motion whose nodes are eliminated to those of a rigid one; its number of states."""
    motion = int(m.scene.states - m.scene.nodes * m.scene.histories)
    first = int(m.scene.error_weights_at)
    m.rows[first : first + motion] *= math.sqrt(motion / float(m.scene.states))
    return motion


def run(
    problem: Problem,
    rtol: float,
    total: int,
    statistics: Statistics,
    resume: Floats | None = None,
    as_ida: bool = False,
    reader: SampleReader | None = None,
) -> Iterator[Block]:
    """Run a problem, block by block.

    Parameters
    ----------
    problem : Problem
        Its model changes during the run.
    rtol : float
        Relative tolerance.
    total : int
        Number of samples, the first at time 0 and the last at the end; 0 for none.
    statistics : Statistics
        Filled in; complete once the last block is out.
    resume : ndarray, optional
        Checkpoint of an earlier run of the same problem, tolerance and sampling, to resume from.
    as_ida : bool
        Whether formulas, iteration and the state at a step's end are IDA's own: slower, less accurate, and equal to the
        portable driver to the last bit.
    reader : SampleReader, optional
        Reads the model at some of the samples.
    """
    m = problem.prepare(rtol, total)
    s = make_arrays(problem, m, as_ida)
    out = Output.empty(len(problem.columns))
    if resume is not None:
        s.clock[0] = problem.restore(resume, s.y)
    if total > 0 and m.state.progress.next_sample == 0:
        if reader is not None and reader.sample == 0:
            reader.read(problem, float(s.clock[0]), lambda: s.y)
        observe_at(problem.addresses.place, float(s.clock[0]), s.y, out.rows[0])
        m.work.driver.rows = m.state.progress.next_sample = 1
    place = problem.addresses.place
    unknowns = s.y.size
    if m.scene.nodes > 0 and not as_ida:
        unknowns = _weigh_motion(m)
    functions = callbacks(unknowns, bool(m.scene.nodes > 0), as_ida)
    places = Places(sun.places(), sun.newton_places())
    try:
        vectors = (s.y, s.yp, s.dky)
        if open_solver(s.handles, place, functions, places, vectors, CONVERGENCE_FAILURES_HIGH) != 0:
            statistics.ending = Ending.SOLVER_FAILURE
            return
        yield from _blocks(problem, s, out, statistics, reader)
    finally:
        close_solver(s.handles)


def _blocks(
    problem: Problem, s: Arrays, out: Output, statistics: Statistics, reader: SampleReader | None
) -> Iterator[Block]:
    """Run with an open solver, block by block."""
    m = problem.model
    driver, elastic = m.work.driver, bool(m.scene.nodes > 0)
    costly = elastic or m.scene.population.flanks > 0
    beyond, budget = False, 1 if costly else FIRST_STEPS
    while driver.done == 0 and driver.error == 0 and not beyond:
        started = time.monotonic()
        room = out if reader is None else out.before(m, reader.sample)
        advance(problem.addresses.place, s, room, budget)
        budget = _next_budget(budget, time.monotonic() - started)
        update_statistics(statistics, m.state.progress)
        statistics.ending = ending_of_flag(int(driver.error), elastic or m.scene.population.flanks > 0)
        if driver.error < 0 and elastic:
            statistics.note_fold(fold_gap(m, m.state.time, s.y) * m.scene.length_unit)
        if driver.error in MODEL_CHANGES:  # the run that continues from here restarts
            driver.error, driver.pending = 0, -1
            m.state.progress.restarts += 1
            beyond = True
        reached = float(s.clock[0])
        if reader is not None and driver.pending > 0 and m.state.progress.next_sample == reader.sample:
            _read(problem, s, reader)
        yield out.block(
            m,
            reached,
            problem.checkpoint(reached, s.y) if driver.pending < 0 or driver.done != 0 else None,
            problem.kept(reached, s.y, s.yp) if driver.pending <= 0 else (None, None),
        )


def _read(problem: Problem, s: Arrays, reader: SampleReader) -> None:
    """Have the model read at the sample that the step waits with."""
    place, due = problem.addresses.place, float(sample_time(problem.model, reader.sample))

    def state() -> Floats:
        state_at_sample(place, s, due)
        return s.dky

    reader.read(problem, due, state)
