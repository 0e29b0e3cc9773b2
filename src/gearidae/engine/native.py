"""The native driver: SUNDIALS IDA driven from one compiled loop with compiled callbacks.

Python sees only full blocks: `gearidae.engine.step.advance` steps until a block of output is full, a budget of steps
is used up, or the run is over, and can be called again where it left off.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator

import numpy as np

from gearidae.compiled import compiled
from gearidae.engine.callbacks import callbacks
from gearidae.engine.entry_points import observe_at
from gearidae.engine.integrate.driver import (
    BLOCK_SECONDS,
    BLOCK_STEPS,
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
from gearidae.engine.integrate.roots import SHARPNESS, Arrays, Stepper, state_for_sample
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import MOTION, Floats, Model
from gearidae.engine.motion.static_solve import fold_gap
from gearidae.engine.observers.standing.judge import STICKS, STOP_STEPS
from gearidae.engine.setup.problem import Problem
from gearidae.engine.step import advance
from gearidae.engine.sundials import names as sun
from gearidae.engine.sundials.ida_memory import HANDLES, FunctionOffsets, close_solver, open_solver
from gearidae.records import Statistics

FIRST_STEPS = 1_000
"""Steps of the first block, before it is known what a step costs; of elastic bodies and discrete asperities, one."""
GROWTH_HIGH = 50
"""By how much a block may have more steps than the one before."""


@compiled
def state_at_sample(address: int, arrays: Arrays, t: float) -> None:
    """`state_for_sample`, for Python."""
    m = model_at(address)
    s = Stepper(arrays.handles, m, arrays.y, arrays.yp, arrays.dky, arrays.spare, arrays.clock)
    state_for_sample(s, t)


def prepare_loop() -> None:
    """Compile the loop over steps and what IDA calls in a motion, or take them from the cache."""
    advance.prepare(0, Arrays(np.zeros(HANDLES, np.int64), *np.zeros((5, 1))), Output.empty(1), 1)  # type: ignore[attr-defined]
    callbacks(MOTION, False)


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
    """Set the error weights of a motion whose nodes are eliminated as for a rigid contact; its number of states."""
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
    m = problem.prepare(rtol, total, as_ida=as_ida)
    s = make_arrays(problem, m, as_ida)
    if resume is not None:
        s.clock[0] = problem.restore(resume, s.y)
    address = problem.addresses.base
    unknowns = s.y.size
    if m.scene.nodes > 0 and not as_ida:
        unknowns = _weigh_motion(m)
    functions = callbacks(unknowns, bool(m.scene.nodes > 0), as_ida)
    offsets = FunctionOffsets(sun.linear_solver_offsets(), sun.newton_offsets())
    with Output.lent(len(problem.columns)) as out:
        if total > 0 and m.state.progress.next_sample == 0:
            if reader is not None and reader.sample == 0:
                reader.read(problem, float(s.clock[0]), lambda: s.y)
            observe_at(address, float(s.clock[0]), s.y, out.rows[0])
            m.work.driver.rows = m.state.progress.next_sample = 1
        try:
            vectors = (s.y, s.yp, s.dky)
            if open_solver(s.handles, address, functions, offsets, vectors, CONVERGENCE_FAILURES_HIGH) != 0:
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
        advance(problem.addresses.base, s, room, budget)
        budget = _next_budget(budget, time.monotonic() - started)
        if m.scene.stop == STICKS:
            budget = min(budget, STOP_STEPS)
        problem.judge.follow(float(s.clock[0]))
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
    address, due = problem.addresses.base, float(sample_time(problem.model, reader.sample))

    def state() -> Floats:
        state_at_sample(address, s, due)
        return s.dky

    reader.read(problem, due, state)
