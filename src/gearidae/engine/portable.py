"""The portable driver: the same residual, Jacobian and guard through scikit-sundae's public API.

Slower by the cost of its Python callbacks, and free of any assumption about how SUNDIALS was built. The formulas are
IDA's own, so that a run is less accurate at the same tolerance (`gearidae.engine.adams`); histories and
events are dealt with as in the native driver (`gearidae.engine.step`). Between steps it interpolates
for itself, because the API has no dense output.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from sksundae.ida import IDA

from gearidae.compiled import compiled
from gearidae.engine.entry_points import (
    finish_step_at,
    first_grazing_minimum_at,
    guard_at,
    jacobian_at,
    note_step_start_at,
    observe_at,
    residual_at,
    rest_step_at,
)
from gearidae.engine.events.events import ROOT, STOP
from gearidae.engine.events.stops import next_stop
from gearidae.engine.integrate.driver import (
    BLOCK_SECONDS,
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
from gearidae.engine.integrate.resting import longest_step
from gearidae.engine.integrate.start import first_step
from gearidae.engine.model.addresses import Addresses
from gearidae.engine.model.state import Floats, Model, Record
from gearidae.engine.model.work_record import MOST_LEAVINGS
from gearidae.engine.motion.block_jacobian import dense_jacobian, store_size
from gearidae.engine.motion.static_solve import fold_gap
from gearidae.engine.observers.standing.judge import STOP_STEPS
from gearidae.engine.setup.problem import Problem
from gearidae.engine.step import has_room, prepare_restart, prepare_start
from gearidae.errors import SceneError
from gearidae.records import Statistics

STATES_HIGH = 600
"""States at most: the Jacobian is a full matrix here."""
_POINTS = 6  # number of former returns used by an interpolation
_CROWDED = 0.3  # of the way to be interpolated: the least distance of the third point


def run(
    problem: Problem,
    rtol: float,
    total: int,
    statistics: Statistics,
    resume: Floats | None = None,
    reader: SampleReader | None = None,
) -> Iterator[Block]:
    """Run a problem, block by block; see `gearidae.engine.native.run`."""
    m = problem.prepare(rtol, total, as_ida=True)
    if m.scene.states > STATES_HIGH:
        raise SceneError(
            "backend",
            "sksundae",
            f"solves no more than {STATES_HIGH} states at once, and this elastic scene has {m.scene.states}: "
            'use the native driver, or contact.bodies = "rigid"',
        )
    y, out = problem.start.copy(), Output.empty(len(problem.columns))
    driver, progress = m.work.driver, m.state.progress
    driver.time = 0.0 if resume is None else problem.restore(resume, y)
    solver = _Solver(problem, m, y)
    if (
        total > 0 and progress.next_sample == 0
    ):  # the state there, whatever rounding has made of the sample's time
        if reader is not None and reader.sample == 0:
            reader.read(problem, float(driver.time), y.copy)
        observe_at(solver.addresses.base, float(driver.time), y, out.rows[0])
        driver.rows = progress.next_sample = 1
    solver.start(y)
    between = (np.zeros_like(y), np.zeros_like(y))
    handed_out, yp = time.monotonic(), np.zeros_like(y)
    while driver.done == 0 and driver.error == 0:
        flag, *reached = solver.step(y)
        if driver.error != 0:  # the data belong to the last accepted time
            break
        y, yp = reached
        yield from _samples(problem, solver, out, y, reader)
        if driver.since % STOP_STEPS == 0 or m.work.leavings == MOST_LEAVINGS:
            problem.judge.follow(float(driver.time))
        if not has_room(driver.events, driver.passages, driver.impacts, out):
            yield out.block(m, driver.time)
        afresh = finish_step_at(solver.addresses.base, float(driver.time), y, yp, between, flag, out)
        if driver.error in MODEL_CHANGES:
            progress.restarts += 1
        checkpoint = driver.since >= CHECKPOINT_STEPS
        if (afresh or checkpoint) and driver.done == 0 and driver.error == 0:
            prepare_restart(m, float(driver.time), y, yp)
            solver.count()
            if checkpoint:
                driver.since = 0
                yield _ready(problem, m, out, statistics, y, yp)
            solver.start(y)
        if time.monotonic() - handed_out > BLOCK_SECONDS:
            solver.count()
            update_statistics(statistics, progress)
            yield out.block(m, float(driver.time), None, problem.kept(float(driver.time), y, yp))
            handed_out = time.monotonic()
    solver.count()
    update_statistics(statistics, progress)
    statistics.ending = solver.ending or ending_of_flag(
        int(driver.error), bool(m.scene.nodes > 0 or m.scene.population.flanks > 0)
    )
    if driver.error < 0 and m.scene.nodes > 0:
        statistics.note_fold(fold_gap(m, driver.time, y) * m.scene.length_unit)
    if driver.done != 0 or driver.error in MODEL_CHANGES:
        yield _ready(problem, m, out, statistics, y, yp)
    else:
        yield out.block(m, driver.time, None, problem.kept(driver.time, y, yp))


def _ready(problem: Problem, m: Model, out: Output, statistics: Statistics, y: Floats, yp: Floats) -> Block:
    """Yield a block with a checkpoint."""
    update_statistics(statistics, m.state.progress)
    reached = float(m.work.driver.time)
    return out.block(m, reached, problem.checkpoint(reached, y), problem.kept(reached, y, yp))


def _samples(
    problem: Problem, solver: _Solver, out: Output, y: Floats, reader: SampleReader | None
) -> Iterator[Block]:
    """Write the samples up to the time reached; yields full blocks on the way."""
    m, trail = solver.m, solver.trail
    driver, progress = m.work.driver, m.state.progress
    while (due := sample_time(m, int(progress.next_sample))) <= driver.time:
        state = y if due == driver.time else trail.at(due)
        if reader is not None and progress.next_sample == reader.sample:
            reader.read(problem, due, state.copy)
        observe_at(solver.addresses.base, due, state, out.rows[driver.rows])
        progress.next_sample += 1
        driver.rows += 1
        if driver.rows == out.rows.shape[0]:
            yield out.block(m, due)


class _Solver:
    """scikit-sundae's IDA over fresh callbacks, since it keeps the event history on the function it is given."""

    def __init__(self, problem: Problem, m: Model, y: Floats) -> None:
        first = m.scene.error_weights_at
        self.m, self.addresses, self._atol = m, Addresses(m), 1.0 / m.rows[first : first + y.size]
        self._driver: Record = m.work.driver
        self._guard_calls = 0
        self._last: Any = None
        self._counted = (0, 0)  # of its evaluations, what the run's counters already have
        self.ending: Ending | None = None
        self._dip_time = math.inf  # time of a dip to stop at
        self.trail = Trail(self._driver.time, y, y)

    def start(self, y: Floats) -> None:
        """Set consistent rates and the first step, and start a fresh IDA at the time reached."""
        m, t, yp = self.m, float(self._driver.time), np.zeros_like(y)
        prepare_start(m, t, y, yp)
        stop = next_stop(m)
        self._stop, self._dip_time = stop, math.inf
        self._last, self._counted = None, (0, 0)
        self.trail = Trail(t, y, yp)
        if self._driver.resting != 0:
            return
        self._make(y.size, first_step(m, t, y, yp, stop - t))
        self._ida.init_step(t, y, yp)
        self._note(y)

    def _note(self, y: Floats) -> None:
        """Note the asperities at a state from which the next step goes on."""
        if self.m.scene.population.flanks > 0:
            note_step_start_at(self.addresses.base, float(self._driver.time), y)

    def _grazing_minimum(self, t: float, y: Floats) -> float:
        """Time in the step up to t at which an asperity dips below its guard and comes back; infinite if none does."""
        before = float(self._driver.time)
        if self.m.scene.population.flanks == 0 or t <= before:
            return math.inf
        share = first_grazing_minimum_at(self.addresses.base, t, y, t - before)
        return before + share * (t - before) if share > 0.0 else math.inf

    def _stop_at_dip(self, grazing: float) -> None:
        """Take the last step anew, and stop where an asperity dips: its root is then found."""
        t, y, yp = self.trail.last
        self.count()
        self._make(y.size, 0.25 * (grazing - t))
        self._ida.init_step(t, y, yp)
        self._last, self._counted, self._dip_time = None, (0, 0), grazing

    def _make(self, n: int, step: float) -> None:
        m, address = self.m, self.addresses.base
        column_major = np.empty(n * n)
        # what scikit-sundae passes is read-only, which is another type to numba
        state, rates = np.empty(n), np.empty(n)
        blocks = np.empty(store_size(m) if m.scene.nodes > 0 else 0)

        def resfn(t: float, y: Floats, yp: Floats, out: Floats) -> None:
            state[:], rates[:] = y, yp
            residual_at(address, t, state, rates, out)

        def jacfn(t: float, y: Floats, yp: Floats, res: Floats, cj: float, out: Floats) -> None:
            state[:] = y
            if blocks.size > 0:
                dense_jacobian(m, t, cj, state, blocks, out)
                return
            jacobian_at(address, t, cj, state, column_major)
            out[:] = column_major.reshape(n, n).T

        def falling(t: float, y: Floats, yp: Floats, out: Floats) -> None:
            self._guard_calls += 1
            state[:] = y
            out[0] = guard_at(address, t, state)

        vars(falling)["direction"] = [-1]
        self._history = vars(falling)  # scikit-sundae keeps the events there
        self._ida = IDA(
            resfn,
            jacfn=jacfn,
            eventsfn=falling,
            num_events=1,
            rtol=0.0,
            atol=self._atol,
            first_step=step,
            max_step=float(longest_step(m)),
            max_num_steps=10_000_000,
            max_conv_fails=CONVERGENCE_FAILURES_HIGH,
        )

    def step(self, y: Floats) -> tuple[int, Floats, Floats]:
        """Go on to the end of the next step, a stop or a root; a failure is noted as the driver's error."""
        driver = self._driver
        driver.since += 1
        if driver.resting != 0:
            driver.time, flag = rest_step_at(self.addresses.base, float(driver.time), y)
            self.trail.add(float(driver.time), y, np.zeros_like(y))
            return flag, y, np.zeros_like(y)
        try:
            result = self._ida.step(self.m.scene.end, method="onestep", tstop=min(self._stop, self._dip_time))
        except KeyError as error:  # a status of SUNDIALS that scikit-sundae has no name for
            driver.error = min(int(error.args[0]), -1)
            return int(driver.error), y, y
        self._last = result
        flag = int(result.status)
        if flag < 0 or not np.isfinite(result.y).all():
            driver.error = flag if flag < 0 else -1
            self.ending = None if flag < 0 else Ending.NOT_FINITE
            return flag, result.y, result.yp
        grazing = self._grazing_minimum(result.t, result.y.copy()) if self._dip_time == math.inf else math.inf
        if grazing < math.inf:
            self._stop_at_dip(grazing)
            return self.step(y)
        if flag == STOP and result.t == self._dip_time < self._stop:
            flag, self._dip_time = 0, math.inf
        driver.time = result.t
        if driver.time >= self._dip_time:
            self._dip_time = math.inf
        self._note(result.y.copy())
        self.m.state.progress.steps += flag != ROOT
        self.trail.add(result.t, result.y, result.yp)
        if flag == ROOT:
            # drop the history, which would be copied whole at every further step
            for name in ("_i", "_t", "_y", "_yp"):
                self._history[name].clear()
        if flag not in (STOP, ROOT):
            unseen = guard_at(self.addresses.base, result.t, result.y.copy()) < 0.0
            flag = ROOT if unseen else 0  # below zero for the whole step: IDA looks for changes of sign only
        return flag, result.y, result.yp

    def count(self) -> None:
        """Add what this solver's counters have gained."""
        progress = self.m.state.progress
        if self._last is not None:
            residuals, jacobians = int(self._last.nfev), int(self._last.njev)
            progress.residual_evaluations += residuals - self._counted[0]
            progress.jacobian_evaluations += jacobians - self._counted[1]
            self._counted = (residuals, jacobians)
        progress.guard_evaluations += self._guard_calls
        self._guard_calls = 0


class Trail:
    """Where the last few returns were, for Hermite interpolation of degree five between the last two.

    The third point must not crowd the others: what the solver returns is smooth only to the tolerance, and divided
    differences over a short way (a root just before a step's end) would magnify that.
    """

    def __init__(self, t: float, y: Floats, yp: Floats) -> None:
        self._points = [(t, y.copy(), yp.copy())]

    @property
    def last(self) -> tuple[float, Floats, Floats]:
        """Time, state and rates of the last return."""
        return self._points[-1]

    def add(self, t: float, y: Floats, yp: Floats) -> None:
        """Note a return."""
        self._points = [*self._points[1 - _POINTS :], (t, y.copy(), yp.copy())]

    def at(self, t: float) -> Floats:
        """Interpolate the state at a time between the last two returns."""
        *earlier, before, after = self._points
        apart = _CROWDED * (after[0] - before[0])
        third = [point for point in earlier if before[0] - point[0] >= apart][-1:]
        times, states, rates = zip(*third, before, after, strict=True)
        return _hermite(np.array(times), np.array(states), np.array(rates), t)


@compiled(makes_arrays=True)
def _hermite(times: Floats, states: Floats, rates: Floats, t: float) -> Floats:
    """Newton's divided differences over doubled nodes: states and rates at all of them are met."""
    count, n = states.shape
    size = 2 * count
    nodes = np.empty(size)
    table = np.empty((size, n))
    for i in range(count):
        nodes[2 * i] = nodes[2 * i + 1] = times[i]
        table[2 * i] = table[2 * i + 1] = states[i]
    for level in range(1, size):
        for i in range(size - 1, level - 1, -1):
            if nodes[i] == nodes[i - level]:
                table[i] = rates[i // 2]
            else:
                table[i] = (table[i] - table[i - 1]) / (nodes[i] - nodes[i - level])
    value = table[size - 1].copy()
    for i in range(size - 2, -1, -1):
        value = value * (t - nodes[i]) + table[i]
    return value
