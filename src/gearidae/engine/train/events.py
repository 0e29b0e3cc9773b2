"""Events of a train: guards of all meshes and shafts, and what is done where they fall.

All that happens between two gears is dealt with by what deals with it in a run of a pair, mesh by mesh; shafts and
torques come behind. As there, the least of all guards is positive while all wait, and what has happened disarms its
own.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.arrays import Floats
from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import TRAIN
from gearidae.engine.events.asperity_events import record_switches, switch_asperities
from gearidae.engine.events.cutoff import begin_within, note_within, watches_cutoff
from gearidae.engine.events.events import mesh_guard
from gearidae.engine.events.histories import accept
from gearidae.engine.events.law_switches import laws_chatter, note_law_jump, set_law_sides
from gearidae.engine.events.mesh_marks import cross_mark, crossed_mark, relief_step
from gearidae.engine.events.pair_events import find_event, take_event
from gearidae.engine.events.stops import next_stop, pass_knot
from gearidae.engine.integrate.driver import LAW_CHATTER, MANY_EVENTS
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import EMPTY, Model, W
from gearidae.engine.observers import adhesion_loss
from gearidae.engine.pairs.tooth_pairs import (
    flank_of_history,
    in_flight,
    list_known,
)
from gearidae.engine.train.layout import TrainModel, TrainOutput
from gearidae.engine.train.motion import mesh_state, motion
from gearidae.engine.train.record import take_from_mesh
from gearidae.engine.train.rest import any_held, rest_guard, switch_rest
from gearidae.engine.train.sticking import sticking_guard, switch_sticking

_ABOVE_ZERO: Final = 1e-300
ROOTS_HIGH: Final = 1_000
"""More roots than this within `CROWDED` of the time is chatter."""
CROWDED: Final = 1e-12
SAME: Final = 1e-13
"""Of the time: knots of drive and load that are one have times in the units of two meshes."""
FALLEN_AT_ONCE: Final = 4
"""Guards that one after the other fall at the same time, at most: what has been dealt with may let others fall."""


@compiled
def train_way_left(tm: TrainModel, y: Floats) -> float:
    """Way of the load's gear to where the run ends, in pitches; infinite where time alone ends it."""
    train = tm.train[0]
    return float(train.stop_pitches - abs(y[train.load] + train.whole_pitches - train.stop_from))


@compiled_once(TRAIN)
def train_guard(tm: TrainModel, t: float, y: Floats, evaluated: bool) -> float:
    """Root function of a train at a time [s]: it falls through zero at the first of all possible events.

    Parameters
    ----------
    evaluated : bool
        Whether the last evaluation of the motion was at this state, of which held shafts and friction need it.
    """
    train, least = tm.train[0], math.inf
    train.guards += 1
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        m = model_at(mesh.address)
        mesh_state(tm, k, m, y, tm.own)
        least = min(least, mesh_guard(m, t / mesh.time_unit, tm.own))
    if not evaluated and (train.flanks != 0 or any_held(tm)):
        motion(tm, t, y, tm.rates[15])
    if train.flanks != 0:
        least = min(least, sticking_guard(tm, y))
    least = min(least, rest_guard(tm, y), train_way_left(tm, y))
    return least if least != 0.0 else _ABOVE_ZERO


@compiled
def next_train_stop(tm: TrainModel) -> float:
    """Time of the coming knot of drive or load, of the coming checkpoint, or the end of the run [s]."""
    train = tm.train[0]
    stop = min(train.end, train.pause)
    for k in (train.drive_mesh, train.load_mesh):
        m = model_at(tm.meshes[k].address)
        if m.state.next_knot < m.scene.knot_count:
            stop = min(stop, next_stop(m) * tm.meshes[k].time_unit)
    return float(stop)


@compiled
def pass_knots(tm: TrainModel, t: float, out: TrainOutput) -> bool:
    """Enter the next segments of the schedules that have a knot at a time [s]; whether the run ends there."""
    train = tm.train[0]
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        m = model_at(mesh.address)
        if m.state.next_knot < m.scene.knot_count and next_stop(m) * mesh.time_unit <= t * (1.0 + SAME):
            count = pass_knot(m, t / mesh.time_unit, tm.few, 0)
            take_from_mesh(tm, k, count, out)
    return bool(t >= train.end)


@compiled
def accept_all(tm: TrainModel, t: float, y: Floats) -> int:
    """Follow the histories of all meshes to an accepted time [s]; how many of the meshes are out of contact.

    -1 if a gap is beyond the bound of the contacts' model.
    """
    flying, beyond, n = 0, False, len(tm.shafts)
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        m = model_at(mesh.address)
        mesh_state(tm, k, m, y, tm.own)
        time = t / mesh.time_unit
        accept(m, time, tm.own)
        if tm.train[0].balance != 0:
            unit = mesh.driven_radius * mesh.time_unit * mesh.time_unit / mesh.length_unit
            q = m.work.quadrature
            q.gear_speed, q.gear_acceleration = tm.own[W], tm.rates[12, n + mesh.b] * unit
            adhesion_loss.step(m, time, tm.own, q.gear_acceleration)
        if m.scene.law_switches != 0 and laws_chatter(m, tm.own):
            tm.train[0].error = LAW_CHATTER
        flying += in_flight(m)
        beyond |= m.state.bound_exceeded != 0
    return -1 if beyond else flying


@compiled
def _switch_mesh(tm: TrainModel, k: int, m: Model, t: float, y: Floats, out: TrainOutput) -> None:
    """Deal with the guards of a mesh that have fallen, in the order of `gearidae.engine.step.switch`."""
    own, few, count, mesh = tm.own, tm.few, 0, tm.meshes[k]
    mesh_state(tm, k, m, y, own)
    time, crossed = t / mesh.time_unit, crossed_mark(m, own)
    if crossed:
        count = cross_mark(m, time, own, few, count)
        m.state.cycle_events = 0
        if not in_flight(m):
            # a pair that parts by its tip relief before the next step ends would not be seen
            tm.train[0].step = min(tm.train[0].step, relief_step(m, own) * mesh.time_unit)
    if m.scene.population.flanks != 0:
        switch_asperities(m, own)
        count, too_many = record_switches(m, time, own, few, count)
        if too_many:
            tm.train[0].error = MANY_EVENTS
    for i in range(list_known(m, own) if m.scene.population.flanks == 0 else 0):
        history = m.work.known[i]
        event = find_event(m, own, flank_of_history(m, history), m.state.history[history].pair, history)
        if event.touches or event.stretches or event.turns:
            if event.turns and tm.train[0].balance != 0:
                w_rate = m.work.quadrature.gear_acceleration
                adhesion_loss.event(m, time, own, w_rate, event.flank, event.pair, event.k, event.gap)
            count = take_event(m, time, own, event, few, count)
    if m.scene.law_switches != 0 and set_law_sides(m, time, own):
        note_law_jump(m, time, own, True)
    if watches_cutoff(m):
        note_within(m, own)
    if crossed and tm.train[0].balance != 0:
        adhesion_loss.resume(m, own)
    take_from_mesh(tm, k, count, out)


@compiled
def switch_all(tm: TrainModel, t: float, y: Floats, out: TrainOutput) -> bool:
    """Deal with all guards that have fallen at a time [s]; whether roots are too crowded."""
    train = tm.train[0]
    for _ in range(1 + FALLEN_AT_ONCE):
        for k in range(len(tm.meshes)):
            _switch_mesh(tm, k, model_at(tm.meshes[k].address), t, y, out)
        if switch_sticking(tm, t, y, out) if train.flanks != 0 else switch_rest(tm, t, y, out):
            # what it holds up is behind it at once: a step that is too long would see the shaft come to rest again
            train.step = min(train.step, 0.05 * train.tau)
        if train_guard(tm, t, y, False) > 0.0:
            break
    if t - train.last_root > CROWDED * t:
        train.roots = 0
    train.last_root = t
    train.roots += 1
    return bool(train.roots > ROOTS_HIGH)


@compiled
def rebase_train(tm: TrainModel, y: Floats) -> None:
    """Take whole periods of the train out of its angle, with all that is counted along."""
    train = tm.train[0]
    shift = train.period * math.floor(y[train.load] / train.period)
    y[train.load] -= shift
    train.whole_pitches += shift
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        m = model_at(mesh.address)
        pitches = math.floor(mesh.ratio * shift + 0.5)
        m.state.whole_pitches += pitches
        m.state.mesh_mark_below -= pitches
        m.state.mesh_mark_above -= pitches
        for i in range(m.scene.histories):
            if m.state.history[i].pair != EMPTY:
                m.state.history[i].pair -= pitches
        if watches_cutoff(m):
            mesh_state(tm, k, m, y, tm.own)
            begin_within(m, tm.own)
