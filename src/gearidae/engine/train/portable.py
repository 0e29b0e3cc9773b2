"""The portable driver of trains: the same motion, guard and events through scikit-sundae's IDA.

Between events IDA integrates ``y' - f(t, y) = 0`` with its own formulas; works and losses are states, too, whose
tolerance is that of the energy of the motion. It is much slower than `gearidae.engine.train.loop` for its Python
callbacks, and independent of its formula. Extremes are those of accepted times.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from sksundae.ida import IDA

from gearidae.arrays import Floats
from gearidae.compiled import compiled
from gearidae.engine.events.events import ROOT
from gearidae.engine.portable import Trail
from gearidae.engine.setup.problem import OWN_SAFETY
from gearidae.engine.train.events import next_train_stop, train_guard
from gearidae.engine.train.layout import TrainModel, TrainOutput
from gearidae.engine.train.loop import finish_train_step, has_room, has_room_for, next_due, write_due
from gearidae.engine.train.motion import motion
from gearidae.engine.train.observe import note_forces
from gearidae.engine.train.rest import any_held


@compiled
def _rates(tm: TrainModel, t: float, y: Floats, out: Floats) -> None:
    motion(tm, t, y, out)


@compiled
def _guard(tm: TrainModel, t: float, y: Floats) -> float:
    return train_guard(tm, t, y, False)


@compiled
def _write(tm: TrainModel, due: float, of_looks: bool, y: Floats, out: TrainOutput) -> None:
    write_due(tm, due, of_looks, y, out)


@compiled
def _begin(tm: TrainModel) -> float:
    """Evaluate the motion at the accepted time, and return the time of the coming stop [s]."""
    train = tm.train[0]
    motion(tm, train.time, tm.y, tm.rates[0])
    train.fresh = 0
    return next_train_stop(tm)


@compiled
def _longest(tm: TrainModel) -> float:
    """Longest step [s]."""
    train = tm.train[0]
    return min(train.longest_step, train.rest_step) if any_held(tm) else train.longest_step


@compiled
def _finish(tm: TrainModel, time: float, root: bool, stop: float, out: TrainOutput) -> None:
    """Do what is to be done at the end of a step, with the forces there."""
    motion(tm, time, tm.new, tm.rates[12])
    note_forces(tm, time)
    finish_train_step(tm, time, root, stop, out)


class PortableDriver:
    """Takes steps of a train with IDA, as `advance_train` does with a formula of its own.

    Parameters
    ----------
    tm : TrainModel
        At its start.
    energy : float
        Energy of the motion, by which works are judged [J].
    rtol : float
    """

    def __init__(self, tm: TrainModel, energy: float, rtol: float) -> None:
        n, size = 2 * len(tm.shafts), tm.y.size
        self._tm, self._rtol = tm, rtol
        tolerance = np.full(size, rtol * energy)
        tolerance[:n] = 1.0 / tm.weights
        # IDA's norm is a mean over all states, and its formulas damp: see `OWN_SAFETY`
        self._tolerance = tolerance * math.sqrt(n / size) / OWN_SAFETY
        self._ida: Any = None
        self._history: dict[str, Any] = {}
        self._stop = self._time = math.inf
        self._trail: Trail | None = None

    def advance(self, out: TrainOutput, most: int, take: Callable[[], None]) -> None:
        """Take steps until the run is done or so many have been taken; `take` takes over what a full block has."""
        tm = self._tm
        train = tm.train[0]
        for _ in range(most):
            if train.done != 0 or train.error != 0:
                return
            if not has_room(tm, out):
                take()
            if train.fresh != 0 or self._ida is None:
                self._start()
            root = self._step()
            if train.error == 0:
                self._sample(out, take)
                _finish(tm, self._time, root, self._stop, out)

    def _start(self) -> None:
        """Start a fresh IDA at the accepted time: forces and directions have changed there."""
        tm = self._tm
        train, n, size = tm.train[0], 2 * len(tm.shafts), tm.y.size
        self._stop = _begin(tm)
        # what scikit-sundae passes is read-only, which is another type to numba
        state, rates, moved = np.empty(size), np.empty(size), np.empty(size)
        small = 1e-5 / (tm.weights * self._rtol)

        def residual(t: float, y: Floats, yp: Floats, out: Floats) -> None:
            state[:] = y
            _rates(tm, t, state, rates)
            out[:] = yp - rates

        def jacobian(t: float, y: Floats, yp: Floats, res: Floats, cj: float, out: Floats) -> None:
            state[:] = y
            _rates(tm, t, state, rates)
            out[:] = 0.0
            np.fill_diagonal(out, cj)
            for j in range(n):  # works act on nothing
                before, state[j] = state[j], state[j] + small[j]
                _rates(tm, t, state, moved)
                state[j] = before
                out[:, j] -= (moved - rates) / small[j]

        def falling(t: float, y: Floats, yp: Floats, out: Floats) -> None:
            state[:] = y
            out[0] = _guard(tm, t, state)

        vars(falling)["direction"] = [-1]
        self._history = vars(falling)  # scikit-sundae keeps the events there
        longest = _longest(tm)
        self._ida = IDA(
            residual,
            jacfn=jacobian,
            eventsfn=falling,
            num_events=1,
            rtol=0.0,
            atol=self._tolerance,
            first_step=min(0.1 * math.sqrt(self._rtol) * float(train.tau), 0.5 * (self._stop - train.time)),
            max_step=longest if longest < math.inf else 0.0,
            max_num_steps=10_000_000,
        )
        self._trail = Trail(float(train.time), tm.y, tm.rates[0])
        self._ida.init_step(float(train.time), tm.y.copy(), tm.rates[0].copy())

    def _step(self) -> bool:
        """Go on to the end of the next step, a stop or a root; whether it is a root."""
        tm = self._tm
        train = tm.train[0]
        try:
            result = self._ida.step(float(train.end), method="onestep", tstop=self._stop)
        except KeyError as error:  # a status of SUNDIALS that scikit-sundae has no name for
            train.error = min(int(error.args[0]), -1)
            return False
        flag = int(result.status)
        if flag < 0 or not np.isfinite(result.y).all():
            train.error = min(flag, -1)
            return False
        tm.new[:], self._time = result.y, float(result.t)
        assert self._trail is not None
        self._trail.add(self._time, result.y, result.yp)
        if flag == ROOT:
            # drop the history, which would be copied whole at every further step
            for name in ("_i", "_t", "_y", "_yp"):
                self._history[name].clear()
            return True
        # below zero for the whole step: IDA looks for changes of sign only
        return bool(_guard(tm, self._time, tm.new) < 0.0)

    def _sample(self, out: TrainOutput, take: Callable[[], None]) -> None:
        """Write the samples up to the end of the step."""
        tm = self._tm
        assert self._trail is not None
        while (coming := next_due(tm))[0] <= self._time:
            due, of_looks = coming
            if not has_room_for(tm, of_looks, out):
                take()
            state = tm.new if due == self._time else self._trail.at(due)
            _write(tm, due, of_looks, state, out)
