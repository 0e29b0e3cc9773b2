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
from gearidae.engine.train.search import begin_part, choose_all, first_dip


@compiled
def _rates(tm: TrainModel, t: float, y: Floats, out: Floats) -> None:
    motion(tm, t, y, out)


@compiled
def _guard(tm: TrainModel, t: float, y: Floats) -> float:
    return train_guard(tm, t, y, False)


@compiled
def _begin_search(tm: TrainModel, t: float, y: Floats) -> None:
    """Note the asperities at a state from which the next step goes on."""
    train_guard(tm, t, y, False)
    begin_part(tm, y)


@compiled
def _dip(tm: TrainModel, span: float, y: Floats) -> float:
    return first_dip(tm, span, y)


@compiled
def _write(tm: TrainModel, due: float, of_looks: bool, y: Floats, out: TrainOutput) -> None:
    write_due(tm, due, of_looks, y, out)


@compiled
def _begin(tm: TrainModel) -> float:
    """Evaluate the motion at the accepted time, and return the time of the coming stop [s]."""
    train = tm.train[0]
    motion(tm, train.time, tm.y, tm.rates[0])
    if train.discrete != 0:
        choose_all(tm, tm.y)
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
        self._dip_time = math.inf  # of an asperity between two steps, to stop at
        self._trail: Trail | None = None

    def advance(self, out: TrainOutput, most: int, take: Callable[[], None]) -> None:
        """Take steps until the run is done or so many have been taken; `take` takes over what a full block has."""
        tm = self._tm
        train = tm.train[0]
        for _ in range(most):
            if train.done != 0 or train.error != 0 or train.time >= train.pause:
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
        train = tm.train[0]
        self._stop, self._dip_time = _begin(tm), math.inf
        time = float(train.time)
        self._make(min(0.1 * math.sqrt(self._rtol) * float(train.tau), 0.5 * (self._stop - time)))
        self._trail = Trail(time, tm.y, tm.rates[0])
        self._ida.init_step(time, tm.y.copy(), tm.rates[0].copy())
        if train.discrete:
            _begin_search(tm, time, tm.y)

    def _make(self, first_step: float) -> None:
        """Make an IDA with fresh callbacks: scikit-sundae keeps the events on the function that it is given."""
        tm = self._tm
        n, size = 2 * len(tm.shafts), tm.y.size
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
            first_step=first_step,
            max_step=longest if longest < math.inf else 0.0,
            max_num_steps=10_000_000,
        )

    def _stop_at_dip(self, share: float) -> None:
        """Take the last step anew, and stop at a share of it, where an asperity dips: its root is then found."""
        assert self._trail is not None
        time, y, yp = self._trail.last
        self._dip_time = time + share * (self._time - time)
        self._make(0.25 * (self._dip_time - time))
        self._ida.init_step(time, y, yp)

    def _step(self) -> bool:
        """Go on to the end of the next step, a stop or a root; whether it is a root."""
        tm = self._tm
        train = tm.train[0]
        try:
            stop = min(self._stop, self._dip_time)
            result = self._ida.step(float(train.end), method="onestep", tstop=stop)
        except KeyError as error:  # a status of SUNDIALS that scikit-sundae has no name for
            train.error = min(int(error.args[0]), -1)
            return False
        flag = int(result.status)
        if flag < 0 or not np.isfinite(result.y).all():
            train.error = min(flag, -1)
            return False
        tm.new[:], self._time = result.y, float(result.t)
        assert self._trail is not None
        if train.discrete:
            share = self._first_dip()
            if share < 1.0:
                self._stop_at_dip(share)
                return self._step()
        if self._time >= self._dip_time:
            self._dip_time = math.inf
        self._trail.add(self._time, result.y, result.yp)
        if flag == ROOT:
            # drop the history, which would be copied whole at every further step
            for name in ("_i", "_t", "_y", "_yp"):
                self._history[name].clear()
            return True
        # below zero for the whole step: IDA looks for changes of sign only
        return bool(_guard(tm, self._time, tm.new) < 0.0)

    def _first_dip(self) -> float:
        """Share of the last step at which an asperity dips below its guard and comes back; 2 if none does.

        It is searched on from the end of the step, and not where the step has been taken anew for a dip.
        """
        tm = self._tm
        assert self._trail is not None
        share, time = 2.0, self._trail.last[0]
        if self._dip_time == math.inf and self._time > time:
            _guard(tm, self._time, tm.new)
            share = _dip(tm, self._time - time, tm.new)
        if not share < 1.0:
            _begin_search(tm, self._time, tm.new)
        return share

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
