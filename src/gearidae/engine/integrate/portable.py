"""The portable driver: the same residual, Jacobian and guard through scikit-sundae's public API.

Slower by the cost of its Python callbacks, and free of any assumption about how SUNDIALS was built. The formulas are
IDA's own, so that a run is less accurate at the same tolerance (`gearidae.engine.integrate.adams`); histories and
events are
dealt with as in the native driver. Between steps it interpolates for itself, because the API has no dense output.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sksundae.ida import IDA

from gearidae.compiled import compiled
from gearidae.engine.elastic.block_jacobian import dense_jacobian, store_size
from gearidae.engine.elastic.static_solve import fold_gap
from gearidae.engine.energy.balance import enter, follow
from gearidae.engine.events.events import (
    CROWDED,
    EVENTS_AT_ONCE,
    RESTART,
    accept,
    guard,
    handle,
    ledger_can_wait,
    pass_knot,
)
from gearidae.engine.integrate.driver import (
    BLOCK_EVENTS,
    BLOCK_ROWS,
    CHECKPOINT_STEPS,
    CODES,
    CONVERGENCE_FAILURES_HIGH,
    Block,
    Ending,
    Tally,
    ending_of_flag,
    sample_time,
)
from gearidae.engine.integrate.start import PHASE_HIGH, first_step, rebase, set_rates
from gearidae.engine.model import layout as at
from gearidae.engine.model.observe import observe
from gearidae.engine.model.problem import Problem
from gearidae.engine.model.residual import jacobian, residual
from gearidae.engine.model.tooth_pairs import in_flight
from gearidae.records import Ledger

__all__ = ["run"]

Floats = NDArray[np.float64]

_BLOCK_STEPS = 5_000  # some tenths of a second
_TSTOP, _ROOT = 1, 2  # flags of IDA's
_POINTS = 6  # returns that an interpolation looks back over
_CROWDED = 0.3  # of the way to be interpolated: the least distance of the third point


# The run's counters, kept in checkpoints.
_NEXT_SAMPLE, _STEPS, _RESIDUALS, _JACOBIANS, _GUARD_CALLS, _RESTARTS, _FLIGHT, COUNTERS = range(8)


def run(
    problem: Problem, rtol: float, total: int, tally: Tally, resume: Floats | None = None
) -> Iterator[Block]:
    """Run a problem, block by block; see `gearidae.engine.integrate.native.run`."""
    d, y, t = problem.data, problem.start.copy(), 0.0
    yp = np.zeros_like(y)
    problem.set_tolerance(rtol)
    counters = np.zeros(COUNTERS, np.int64)
    output = _Output(problem, total)
    if resume is not None:
        t = problem.restore(resume, y, counters)
        output.next_sample = int(counters[_NEXT_SAMPLE])
        tally.steps, tally.residual_evaluations, tally.jacobian_evaluations = map(int, counters[1:4])
        tally.guard_evaluations, tally.restarts, tally.flight_steps = map(int, counters[4:])
    else:
        output.sample(t, y, _Trail(t, y, y))
    knots = [*problem.knots[int(d[at.NEXT_KNOT]) :], problem.end]
    solver, trail = _start(problem, rtol, t, y, knots[0])
    since = 0
    elastic = d[at.NODES] > 0.0
    while knots:
        result = solver.step(knots[-1], method="onestep", tstop=knots[0])
        since += 1
        flag = result.status
        if flag < 0 or not np.isfinite(result.y).all():
            tally.ending = ending_of_flag(flag) if flag < 0 else Ending.NOT_FINITE
            if elastic:
                tally.note_fold(fold_gap(d, t) * d[at.SIGMA])
            break
        t, y, yp = result.t, result.y, result.yp
        trail.add(t, y, yp)
        tally.steps += flag != _ROOT
        yield from output.sample(t, y, trail)
        accept(d, t, y)
        if flag != _ROOT or not ledger_can_wait(d, t, y):
            follow(d, t, y, yp, flag != 0 or d[at.PASSED] != 0.0)
        tally.flight_steps += in_flight(d)
        restart = d[at.KIND] == at.GEARS and abs(y[at.PHASE]) > PHASE_HIGH
        if flag == _ROOT:
            solver.forget_events()
            output.event_count, action = handle(d, t, y, output.events, output.event_count)
            restart |= action == RESTART
            if action == CROWDED:
                tally.ending = Ending.CHATTER
                break
        elif flag == _TSTOP:
            knots.pop(0)
            if knots:
                output.event_count = pass_knot(d, t, output.events, output.event_count)
                restart = True
        if d[at.PASSED] != 0.0:
            tally.ending = ending_of_flag(CODES[1], elastic)
            tally.restarts += 1
            solver.count(tally)
            yield output.flush(t, problem.ledger(t, y, yp), _checkpoint(problem, t, y, output, tally))
            return
        checkpoint = since >= CHECKPOINT_STEPS
        if (restart or checkpoint) and knots:
            follow(d, t, y, yp, True)
            rebase(d, y)
            tally.restarts += 1
            solver.count(tally)
            if checkpoint:
                since = 0
                yield output.flush(t, problem.ledger(t, y, yp), _checkpoint(problem, t, y, output, tally))
            solver, trail = _start(problem, rtol, t, y, knots[0])
        elif since % _BLOCK_STEPS == 0 or output.event_count > BLOCK_EVENTS - EVENTS_AT_ONCE:
            yield output.flush(t, problem.ledger(t, y, yp))
    solver.count(tally)
    yield output.flush(
        t, problem.ledger(t, y, yp), None if knots else _checkpoint(problem, t, y, output, tally)
    )


def _checkpoint(problem: Problem, t: float, y: Floats, output: _Output, tally: Tally) -> Floats:
    counters = [
        output.next_sample,
        tally.steps,
        tally.residual_evaluations,
        tally.jacobian_evaluations,
        tally.guard_evaluations,
        tally.restarts,
        tally.flight_steps,
    ]
    return problem.checkpoint(t, y, np.array(counters, np.int64))


class _Solver:
    """scikit-sundae's IDA over fresh callbacks, since it keeps the event history on the function it is given."""

    def __init__(self, problem: Problem, atol: Floats, step: float) -> None:
        d, n = problem.data, problem.start.size
        self._guard_calls = 0
        column_major = np.empty(n * n)
        blocks = np.empty(store_size(d) if d[at.NODES] > 0.0 else 0)

        def resfn(t: float, y: Floats, yp: Floats, out: Floats) -> None:
            residual(d, t, y, yp, out)

        def jacfn(t: float, y: Floats, yp: Floats, res: Floats, cj: float, out: Floats) -> None:
            if blocks.size > 0:
                dense_jacobian(d, t, cj, y, blocks, out)
                return
            jacobian(d, t, cj, y, column_major)
            out[:] = column_major.reshape(n, n).T

        def falling(t: float, y: Floats, yp: Floats, out: Floats) -> None:
            self._guard_calls += 1
            out[0] = guard(d, t, y)

        vars(falling)["direction"] = [-1]
        self._history = vars(falling)  # scikit-sundae keeps the events there
        self._ida = IDA(
            resfn,
            jacfn=jacfn,
            eventsfn=falling,
            num_events=1,
            rtol=0.0,
            atol=atol,
            first_step=step,
            max_num_steps=10_000_000,
            max_conv_fails=CONVERGENCE_FAILURES_HIGH,
        )
        self._last: Any = None

    def begin(self, t: float, y: Floats, yp: Floats) -> None:
        self._ida.init_step(t, y, yp)

    def step(self, t: float, method: str, tstop: float) -> Any:
        self._last = self._ida.step(t, method=method, tstop=tstop)
        return self._last

    def forget_events(self) -> None:
        """Drop the history, which would be copied whole at every further step."""
        for name in ("_i", "_t", "_y", "_yp"):
            self._history[name].clear()

    def count(self, tally: Tally) -> None:
        """Add this solver's counters."""
        if self._last is not None:
            tally.residual_evaluations += int(self._last.nfev)
            tally.jacobian_evaluations += int(self._last.njev)
        tally.guard_evaluations += self._guard_calls


def _start(problem: Problem, rtol: float, t: float, y: Floats, stop: float) -> tuple[_Solver, _Trail]:
    """Set consistent rates and the first step, and start a fresh IDA at t."""
    d, yp = problem.data, np.zeros_like(y)
    set_rates(d, t, y, yp)
    enter(d, t, y, yp)
    step = first_step(d, t, y, yp, problem.tolerance_scale, rtol, stop - t)
    solver = _Solver(problem, rtol * problem.tolerance_scale, step)
    solver.begin(t, y, yp)
    return solver, _Trail(t, y, yp)


class _Output:
    """Collects samples and events into blocks."""

    def __init__(self, problem: Problem, total: int) -> None:
        self._problem, self._total = problem, total
        self.next_sample = 0
        self._rows = np.empty((BLOCK_ROWS, len(problem.columns)))
        self._row_count = 0
        self.events = np.empty((BLOCK_EVENTS, 5))
        self.event_count = 0

    def sample(self, t: float, y: Floats, trail: _Trail) -> Iterator[Block]:
        """Write the samples up to t; hands out full blocks on the way."""
        blocks = []
        while (
            self.next_sample < self._total
            and (at_time := sample_time(self.next_sample, self._total, self._problem.end)) <= t
        ):
            state = y if at_time == t else trail.at(at_time)
            observe(self._problem.data, at_time, state, self._rows[self._row_count])
            self.next_sample += 1
            self._row_count += 1
            if self._row_count == BLOCK_ROWS:
                blocks.append(self.flush(at_time))
        return iter(blocks)

    def flush(self, t: float, ledger: Ledger | None = None, checkpoint: Floats | None = None) -> Block:
        """Hand out what has been collected."""
        block = Block(
            self._rows[: self._row_count].copy(),
            self.events[: self.event_count].copy(),
            t * self._problem.time_unit,
            checkpoint,
            ledger,
        )
        self._row_count = self.event_count = 0
        return block


class _Trail:
    """Where the last few returns were, for Hermite interpolation of degree five between the last two.

    The third point must not crowd the others: what the solver returns is smooth only to the tolerance, and divided
    differences over a short way (a root just before a step's end) would magnify that.
    """

    def __init__(self, t: float, y: Floats, yp: Floats) -> None:
        self._points = [(t, y.copy(), yp.copy())]

    def add(self, t: float, y: Floats, yp: Floats) -> None:
        self._points = [*self._points[1 - _POINTS :], (t, y.copy(), yp.copy())]

    def at(self, t: float) -> Floats:
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
