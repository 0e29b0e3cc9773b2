"""Shafts that creep towards rest: without a vibration no speed turns round, so that no guard falls.

As `gearidae.engine.events.sliding.stop_creeping` of a pair, for all shafts that meshes in contact join.
"""

from __future__ import annotations

from typing import Final

from gearidae.arrays import Floats
from gearidae.compiled import compiled
from gearidae.engine.events.sliding import A_WHILE
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.record_types import STUCK
from gearidae.engine.train.box import missing_friction
from gearidae.engine.train.flanks import balance_frictions, slide_of
from gearidae.engine.train.layout import TrainModel, TrainOutput, is_at_rest
from gearidae.engine.train.motion import motion
from gearidae.engine.train.sticking import decide, find_kept, note_rests, record_rests

LACKING: Final = 1.0
"""Friction that may be missing where creeping shafts are held, over the force that counts as none: as for a pair."""


@compiled
def stop_creeping_shafts(tm: TrainModel, t: float, y: Floats, out: TrainOutput) -> bool:
    """Bring shafts to rest that creep towards it, by less than a tolerance, and whom friction then holds.

    What a rising torque draws along creeps as slowly, and is held for a moment only.

    Parameters
    ----------
    t : float
        Accepted time [s].
    y : ndarray
        State; speeds of shafts that come to rest are set to zero.
    out : TrainOutput
        Of the block.

    Returns
    -------
    bool
        Whether any has been brought to rest.
    """
    n, trial = len(tm.shafts), tm.between
    for i in range(n):
        tm.shafts[i].slow = int(abs(y[n + i]) <= tm.shafts[i].creeps)
    if not _any_creeps(tm):
        return False
    note_rests(tm)
    while True:
        for j in range(y.size):
            trial[j] = y[j]
        for i in range(n):
            trial[n + i] *= tm.shafts[i].slow == 0
        _stick(tm)
        if _stay(tm, t, trial) and _stay(tm, t + A_WHILE * tm.train[0].tau, trial):
            break
        _restore(tm)
        if not _any_creeps(tm):
            motion(tm, t, y, tm.rates[15])  # what is asked of the last evaluation is of this state
            return False
    for i in range(n):
        y[n + i] = trial[n + i]
    decide(tm, t, y, LACKING)
    record_rests(tm, t, out)
    return True


@compiled
def _any_creeps(tm: TrainModel) -> bool:
    """Leave out slow shafts that a mesh in contact joins to others; whether any is left that is not at rest.

    The forces of the last evaluation of the motion tell what is in contact.
    """
    joined = True
    while joined:
        joined = False
        for k in range(len(tm.meshes)):
            a, b = tm.shafts[tm.meshes[k].a], tm.shafts[tm.meshes[k].b]
            if a.slow != b.slow and model_at(tm.meshes[k].address).work.pair_forces.count > 0:
                a.slow = b.slow = 0
                joined = True
    creeping = 0
    for i in range(len(tm.shafts)):
        creeping += tm.shafts[i].slow != 0 and not is_at_rest(tm.shafts[i])
    return creeping > 0


@compiled
def _stick(tm: TrainModel) -> None:
    """Hold all slow shafts, and have all pairs that rub between them roll."""
    for i in range(len(tm.shafts)):
        shaft = tm.shafts[i]
        if shaft.rubs != 0 and shaft.slow != 0:
            shaft.slip = 0.0
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        m = model_at(mesh.address)
        slow = mesh.flanks != 0 and tm.shafts[mesh.a].slow != 0
        for i in range(m.work.pair_forces.count if slow else 0):
            noted = m.work.pair_forces.pair[i]
            if slide_of(m, noted) != 0:
                m.state.history[noted.history].slide = STUCK


@compiled
def _restore(tm: TrainModel) -> None:
    """Take the directions back that have been noted."""
    for i in range(len(tm.shafts)):
        shaft = tm.shafts[i]
        shaft.slip, shaft.kept = shaft.before, int(shaft.rubs == 0 and shaft.rested != 0)
    for k in range(len(tm.meshes)):
        m = model_at(tm.meshes[k].address)
        for i in range(m.scene.histories if tm.meshes[k].flanks != 0 else 0):
            m.state.history[i].slide = m.work.friction.before_slide[i]


@compiled
def _stay(tm: TrainModel, t: float, trial: Floats) -> bool:
    """Whether friction holds all slow shafts at a time, at rest in a state; others are slow no longer."""
    n, train = len(tm.shafts), tm.train[0]
    for i in range(n):
        tm.shafts[i].kept = 0
    find_kept(tm, t, trial)
    lost = 0
    for i in range(n):
        shaft = tm.shafts[i]
        held = is_at_rest(shaft) and (train.elements > 0 or abs(shaft.torque) <= shaft.limit)
        if shaft.slow != 0 and not held:
            shaft.slow, lost = 0, 1
    if train.elements == 0 or lost != 0:
        return lost == 0
    found = balance_frictions(tm, True)
    for j in range(train.elements):
        a, b = tm.shafts[tm.elements[j].a], tm.shafts[tm.elements[j].b]
        if a.slow != 0 and not (found and abs(missing_friction(j, tm.gram, tm.box)) <= LACKING):
            a.slow, b.slow, lost = 0, 0, 1
    return lost == 0
