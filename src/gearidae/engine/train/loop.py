"""Steps of a train's motion until a block of output is full: attempt, locate, sample, accept, account, switch."""

from __future__ import annotations

import math
from typing import Final

from gearidae.arrays import Floats
from gearidae.compiled import compiled
from gearidae.engine.events.record import EVENTS_AT_ONCE
from gearidae.engine.integrate.driver import BOUND_EXCEEDED, CHATTER
from gearidae.engine.train.ageing import follow_ageing
from gearidae.engine.train.creeping import stop_creeping_shafts
from gearidae.engine.train.events import (
    accept_all,
    next_train_stop,
    pass_knots,
    rebase_train,
    switch_all,
    train_guard,
    train_way_left,
)
from gearidae.engine.train.formula import attempt, make_polynomial, next_length, state_at
from gearidae.engine.train.layout import TrainModel, TrainOutput
from gearidae.engine.train.motion import motion
from gearidae.engine.train.observe import (
    account,
    follow_forces,
    follow_shafts,
    note_forces,
    observe_train,
    shaft_angle,
    wants_polynomial,
)
from gearidae.engine.train.rest import any_held
from gearidae.engine.train.search import choose_all, first_root, guard_at, locate
from gearidae.formulas.interpolation import cubic
from gearidae.formulas.roots import HALVINGS, zero_of_cubic

UNDERFLOW: Final = -3
"""IDA's flag for steps that have become too small."""
LEAST_STEP: Final = 1e-15
"""Of the time, or of the fastest time of the meshes."""
LAST: Final = 1e-10
"""Of a step: what would be left of the way to a stop is taken with it."""
LOOKS: Final = 2001
"""Times at which every run is looked at to be judged, whatever is sampled: enough for mean speeds and their spread.

Where shafts come to rest or turn round is known besides."""


@compiled
def _due(tm: TrainModel, first: float, index: int, count: int) -> float:
    """Time of one of so many looks at a run [s]: the first at the start, the last at the end itself, none beyond."""
    train = tm.train[0]
    if index >= count:
        return math.inf
    if index == count - 1:
        return float(train.end)
    if index == 0:
        return float(train.start)
    return float((first + index) * ((train.end - train.start) / (count - 1)))


@compiled
def sample_due(tm: TrainModel) -> float:
    """Time of the coming sample [s]."""
    return _due(tm, tm.train[0].first_sample, tm.train[0].next_sample, tm.train[0].samples)


@compiled
def look_due(tm: TrainModel) -> float:
    """Time of the coming look by which the run is judged [s]."""
    return _due(tm, tm.train[0].first_look, tm.train[0].next_look, LOOKS)


@compiled
def next_due(tm: TrainModel) -> tuple[float, bool]:
    """Time of the coming sample or look [s], whichever is first, and whether it is a look."""
    sample, look = sample_due(tm), look_due(tm)
    return min(sample, look), look < sample


@compiled
def has_room_for(tm: TrainModel, of_looks: bool, out: TrainOutput) -> bool:
    """Whether a block has room for one more sample, or look."""
    train = tm.train[0]
    return bool(train.looks < out.looks.shape[0] if of_looks else train.rows < out.samples.shape[0])


@compiled
def write_due(tm: TrainModel, due: float, of_looks: bool, y: Floats, out: TrainOutput) -> None:
    """Write the sample, or look, that is due at a time [s] with this state."""
    train = tm.train[0]
    if of_looks:
        observe_train(tm, due, y, out.looks[train.looks])
        train.looks += 1
        train.next_look += 1
    else:
        observe_train(tm, due, y, out.samples[train.rows])
        train.rows += 1
        train.next_sample += 1


@compiled
def _sample_step(tm: TrainModel, time: float, h: float, out: TrainOutput) -> bool:
    """Write the samples and looks of a step up to a time, by its polynomial; whether the block had room for them."""
    train, n = tm.train[0], 2 * len(tm.shafts)
    while True:
        due, of_looks = next_due(tm)
        if due > time:
            return True
        if not has_room_for(tm, of_looks, out):
            return False
        state_at(tm, min((due - train.time) / h, 1.0), n, tm.between)
        write_due(tm, due, of_looks, tm.between, out)


@compiled
def _note_zero(tm: TrainModel, h: float, out: TrainOutput) -> None:
    """Note where the speed of the judged shaft has changed its sign in a step of the length h, at its end."""
    train, at = tm.train[0], len(tm.shafts) + tm.train[0].judged
    w, later, rate, later_rate = tm.y[at], tm.new[at], tm.rates[0, at], tm.rates[12, at]
    if w * later >= 0.0:
        return
    share = zero_of_cubic(0.0, 1.0, HALVINGS, 0.0, math.copysign(1.0, w), h, w, rate, later, later_rate)[1]
    angles = shaft_angle(tm, train.judged, tm.y), shaft_angle(tm, train.judged, tm.new)
    out.zeros[train.zeros, 0] = train.time + share * h
    out.zeros[train.zeros, 1] = cubic(share, h, angles[0], w, angles[1], later)
    train.zeros += 1


@compiled
def take_step(tm: TrainModel, stop: float) -> tuple[float, float]:
    """Try steps until one passes; its length, 0 if they become too small, and that of the next one [s]."""
    train = tm.train[0]
    h = min(train.step, train.longest_step)
    if any_held(tm):
        h = min(h, train.rest_step)
    left = stop - train.time
    if h >= (1.0 - LAST) * left:
        h = left
    refused = False
    while True:
        error = attempt(tm, h)
        after = next_length(h, error, refused)
        if error <= 1.0:
            return h, after
        train.refused += 1
        refused, h = True, after
        if h < LEAST_STEP * max(train.time, train.tau):
            return 0.0, 0.0


@compiled
def finish_train_step(tm: TrainModel, time: float, root: bool, stop: float, out: TrainOutput) -> None:
    """Accept a step, account for it, and switch what has happened at its end; common to both drivers.

    Parameters
    ----------
    tm : TrainModel
        With the state at the end in ``new``, and rates at both ends in the first and the thirteenth row of ``rates``.
    time : float
        Of the end [s].
    root : bool
        Whether a guard has fallen there.
    stop : float
        Time of the coming knot, or the end of the run [s].
    out : TrainOutput
        Of the block.
    """
    train, y, new = tm.train[0], tm.y, tm.new
    follow_shafts(tm, time - train.time)
    _note_zero(tm, time - train.time, out)
    flying = accept_all(tm, time, new)
    if train.ages != 0:
        follow_ageing(tm, time, new)
    train.steps += 1
    train.flight_steps += flying == len(tm.meshes)
    if train.balance != 0:
        account(tm, y, new)
    for j in range(y.size):
        y[j] = new[j]
        tm.rates[0, j] = tm.rates[12, j]
    train.time = time
    if flying < 0:
        train.error = BOUND_EXCEEDED
        return
    if root:
        train.fresh = 1
        train.restarts += 1
        if switch_all(tm, time, y, out):
            train.error = CHATTER
        if train_way_left(tm, y) <= 0.0:
            train.done = 1
    if any_held(tm) and stop_creeping_shafts(tm, time, y, out):
        train.fresh = 1
    if time >= stop:
        train.fresh = 1
        if pass_knots(tm, time, out):
            train.done = 1
    if abs(y[train.load]) > train.period:
        rebase_train(tm, y)


@compiled
def has_room(tm: TrainModel, out: TrainOutput) -> bool:
    """Whether a block has room for all that may happen at one time."""
    train = tm.train[0]
    enough = train.events + len(tm.meshes) * EVENTS_AT_ONCE <= out.events.shape[0]
    enough = enough and train.zeros < out.zeros.shape[0]
    return bool(enough and train.rests + len(tm.shafts) <= out.rests.shape[0])


@compiled
def advance_train(tm: TrainModel, out: TrainOutput, most: int) -> None:
    """Take steps until the run is done, the block is full, or so many have been taken."""
    train, y, new = tm.train[0], tm.y, tm.new
    for _ in range(most):
        if train.done != 0 or train.error != 0 or train.time >= train.pause or not has_room(tm, out):
            return
        if train.fresh != 0:
            motion(tm, train.time, y, tm.rates[0])
            if train.discrete != 0:
                note_forces(tm, train.time)  # they jump where asperities have joined or detached
                choose_all(tm, y)
            train.guard, train.fresh = train_guard(tm, train.time, y, True), 0
        stop = next_train_stop(tm)
        h, after = take_step(tm, stop)
        if h == 0.0:
            train.error = UNDERFLOW
            return
        time = stop if h == stop - train.time else train.time + h
        waits = train.guard > 0.0
        searched = waits and train.discrete != 0
        value, share = 1.0 if searched else train_guard(tm, time, new, True), 1.0
        root, due, seen = value < 0.0, next_due(tm)[0], wants_polynomial(tm)
        if searched or (waits and root) or due <= time or seen:
            make_polynomial(tm, h)
            if searched:
                root, share, value = first_root(tm, h)
            elif waits and root:
                share = locate(tm, h, 0.0, train.guard, 1.0, guard_at(tm, h, 1.0))
            if share < 1.0:
                time = train.time + share * h
                state_at(tm, share, y.size, new)
            if not _sample_step(tm, time, h, out):
                return  # the step is taken again with room for its samples
            if seen:
                follow_forces(tm, share, h)
        if share < 1.0:
            motion(tm, time, new, tm.rates[12])
        train.guard, train.step = value, after
        finish_train_step(tm, time, root, stop, out)
