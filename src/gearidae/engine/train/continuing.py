"""A train that goes on: its state as words, taken back by the same scene, or carried over to another.

A train's checkpoint is what its records, its state vector and the energies at its start hold, and behind that the
checkpoint of every mesh as that of a pair. Addresses, constants and what follows from the state are made from the
scene, and never read.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.engine.continuing import carry_over, forget_balance, refuse_other_bodies
from gearidae.engine.setup.checkpoint import depth_of, pack
from gearidae.engine.setup.checkpoint_checks import refused, require
from gearidae.engine.setup.start import Start
from gearidae.engine.train.build import TrainProblem, make_train
from gearidae.engine.train.layout import TrainOutput, which_rest
from gearidae.engine.train.observe import kinetic_energy_of, write_stored
from gearidae.engine.train.record import record_at_shaft
from gearidae.engine.train.rest import switch_rest
from gearidae.engine.train.start import begin_anew, take_up, write_own_state
from gearidae.engine.train.sticking import find_kept, switch_sticking
from gearidae.records import EventKind, Words
from gearidae.records.quantity import COUNT_HIGH
from gearidae.scene.scene import TrainScene

_OF_TRAIN: Final = ("whole_pitches", "time", "step", "throughput", "peak_kinetic", "kinetic", "last_root")
_OF_SHAFT: Final = ("begin", "slip", "kept", "rest_begin", "rest_time", "min_speed", "max_speed")
_OF_MESH: Final = ("largest", "largest_time", "smallest", "smallest_time", "separation")
_OF_JOINT: Final = ("age",)
"""Numbers of the records that a run carries on, with those that a run after it carries on, too."""
_COUNTS: Final = (
    "roots",
    "next_sample",
    "next_look",
    "steps",
    "evaluations",
    "refused",
    "guards",
    "restarts",
    "flight_steps",
)
"""Numbers of one run of the train."""
_LAYOUT: Final = int(
    hashlib.sha256(repr((_OF_TRAIN, _OF_SHAFT, _OF_MESH, _OF_JOINT, _COUNTS)).encode()).hexdigest()[:8], 16
)
_HEADER: Final = 5
"""Words in front: layout, and four of the scene."""


def pack_train(problem: TrainProblem) -> Words:
    """Put the state of a train into one vector of words."""
    tm = problem.model
    numbers = [tm.train[0][name] for name in (*_OF_TRAIN, *_COUNTS)]
    numbers += [record[name] for record in tm.shafts for name in _OF_SHAFT]
    numbers += [record[name] for record in tm.meshes for name in _OF_MESH]
    numbers += [record[name] for record in tm.joints for name in _OF_JOINT]
    own = np.array([*numbers, *tm.y, *problem.energies, problem.kinetic], dtype=np.float64)
    parts: list[Floats] = [np.array([_LAYOUT, *problem.digest]), own]
    for k, pair in enumerate(problem.problems):
        words = pack(pair.model, pair.digest, pair.depth, _own_state(problem, k))
        parts += [np.array([float(words.size)]), words]
    return np.concatenate(parts)


def _own_state(problem: TrainProblem, k: int) -> Floats:
    """State of a mesh's pair in its own units, with the time in its record."""
    tm, m = problem.model, problem.problems[k].model
    m.state.time = float(tm.train[0].time) / float(tm.meshes[k]["time_unit"])
    write_own_state(tm, k)
    return tm.own.copy()


def restore_train(problem: TrainProblem, words: Words) -> None:
    """Take the state of a train back, in place, once its bounds have been checked.

    Raises
    ------
    SceneError
        If it is of another scene, or not as a run of this scene leaves it.
    """
    tm = problem.model
    if words.ndim != 1 or words.size < _HEADER:
        raise refused(f"{words.size} numbers", "too short to be one")
    if words[0] != float(_LAYOUT):
        raise refused("its layout", "of another version of gearidae; run the scene again")
    if tuple(words[1:_HEADER]) != problem.digest:
        raise refused("its scene", "not of this scene")
    tables = ((tm.shafts, _OF_SHAFT), (tm.meshes, _OF_MESH), (tm.joints, _OF_JOINT))
    counts = len(_OF_TRAIN) + len(_COUNTS), *(len(names) * len(records) for records, names in tables)
    sizes = (*counts, tm.y.size, problem.energies.size, 1)
    begin = _HEADER + sum(sizes)
    meshes = list(_meshes_of(problem, words, begin))
    # copies: compiled functions take arrays that may be written only
    parts = np.split(words[_HEADER:begin].copy(), np.cumsum(sizes)[:-1])
    for part in parts:
        require(bool(np.isfinite(part).all()), "the state", "finite")
    of_train, of_shafts, of_meshes, of_joints, y, energies, kinetic = parts
    whole = of_train[len(_OF_TRAIN) :]
    require(bool(((whole >= 0) & (whole < COUNT_HIGH) & (whole % 1.0 == 0.0)).all()), "counters", "counts")
    require(bool(np.isin(of_shafts[1 :: len(_OF_SHAFT)], (-1.0, 0.0, 1.0)).all()), "slip", "-1, 0 or 1")
    require(bool(np.isin(of_shafts[2 :: len(_OF_SHAFT)], (0.0, 1.0)).all()), "kept", "0 or 1")
    for pair, mine in zip(problem.problems, meshes, strict=True):
        pair.restore(mine, np.empty(tm.own.size))
    for name, value in zip((*_OF_TRAIN, *_COUNTS), of_train, strict=True):
        tm.train[0][name] = value
    require(bool((of_joints >= 0.0).all()), "age", "0 or more")
    for (records, names), values in zip(tables, (of_shafts, of_meshes, of_joints), strict=True):
        for record, numbers in zip(records, values.reshape(len(records), -1), strict=True):
            for name, value in zip(names, numbers, strict=True):
                record[name] = value
    tm.y[:], problem.energies[:], problem.kinetic = y, energies, float(kinetic[0])
    take_up(tm)


def _meshes_of(problem: TrainProblem, words: Words, begin: int) -> Iterator[Words]:
    """Yield the words of each mesh, which stand behind the others with their numbers."""
    for pair in problem.problems:
        if begin >= words.size or not 0 < words[begin] <= words.size - begin - 1:
            raise refused(f"{words.size} numbers", "not as many as this scene has")
        end = begin + 1 + int(words[begin])
        mine = words[begin + 1 : end].copy()
        if depth_of(mine, pair.digest) != pair.depth:
            raise refused("contact model", "not one that this scene has")
        yield mine
        begin = end
    if begin != words.size:
        raise refused(f"{words.size} numbers", "not as many as this scene has")


def end_of_train(scene: TrainScene, words: Words, began: float) -> Start:
    """Check a checkpoint against the scene of its run, and return the start of a run that goes on from there.

    Parameters
    ----------
    scene : Scene
        Of the run.
    words : ndarray of 8-byte words
        Its checkpoint.
    began : float
        When it began [s].

    Raises
    ------
    SceneError
        If the checkpoint is not of this scene, or damaged.
    """
    problem = make_train(scene, Start(began))
    restore_train(problem, words)
    return Start(float(problem.model.train[0].time), None, scene, words, began)


def train_from(scene: TrainScene, start: Start, out: TrainOutput) -> TrainProblem:
    """Lay out a train that goes on where another run has ended: time, motion, histories and energies go on.

    Parameters
    ----------
    scene : Scene
        It may differ in torques, coatings and settings of the run.
    start : Start
        From `end_of_train`.
    out : TrainOutput
        Of the first block: what new torques do not hold any longer slips at once.

    Raises
    ------
    SceneError
        If the scenes differ in what may not.
    """
    assert isinstance(start.scene, TrainScene)
    assert start.words is not None
    refuse_other_bodies(start.scene, scene)
    old = make_train(start.scene, Start(start.began))
    restore_train(old, start.words)
    new = make_train(scene, start)
    _carry_state(old, new)
    _carry_meshes(old, new)
    take_up(new.model)
    _carry_rest(old, new, out)
    return new


def _carry_state(old: TrainProblem, new: TrainProblem) -> None:
    """Carry motion, extremes and energies of the train over; they are in SI units."""
    source, tm = old.model, new.model
    tm.y[:] = source.y
    for records, others, names in (
        (tm.train, source.train, _OF_TRAIN),
        (tm.shafts, source.shafts, _OF_SHAFT),
        (tm.meshes, source.meshes, _OF_MESH),
        (tm.joints, source.joints, _OF_JOINT),
    ):
        for name in names:
            records[name] = others[name]
    train = tm.train[0]
    begin_anew(tm)
    train.stop_from = float(train.whole_pitches) + float(tm.y[train.load])


def _carry_meshes(old: TrainProblem, new: TrainProblem) -> None:
    """Carry the contacts of all meshes over, and book by how much they store more with other materials."""
    before, after = np.zeros(old.energies.size), np.zeros(old.energies.size)
    write_stored(old.model, old.model.y, before)
    coatings = [[mesh.coating for mesh in problem.scene.train.meshes] for problem in (old, new)]
    for k, (source, pair) in enumerate(zip(old.problems, new.problems, strict=True)):
        others = coatings[0][k] != coatings[1][k]
        carry_over(source, _own_state(old, k), pair, pair.start.copy(), population=others)
    follows, followed = new.scene.run.balance, old.scene.run.balance
    if follows != followed:
        for pair in new.problems:
            forget_balance(pair.model)
    write_stored(new.model, new.model.y, after)
    if follows == followed:
        new.energies[:], new.kinetic = old.energies, old.kinetic
        change = (after - before).reshape(-1, 3)
        new.energies[::3] += change[:, 0] + change[:, 1]
        return
    new.model.y[2 * len(new.model.shafts) :] = 0.0
    # what contacts that close have lost so far is no loss of this balance
    new.energies[:], new.kinetic = after, float(kinetic_energy_of(new.model, new.model.y))
    new.energies[::3] += after.reshape(-1, 3)[:, 1]
    train = new.model.train[0]
    train.throughput = train.peak_kinetic = train.kinetic = new.kinetic


def _carry_rest(old: TrainProblem, new: TrainProblem, out: TrainOutput) -> None:
    """Let shafts slip that are not held any longer; where nothing rubs now, or did before, the speed says the slip."""
    tm = new.model
    t = float(tm.train[0].time)
    rested = which_rest(old.model)
    for i, (before, shaft) in enumerate(zip(old.model.shafts, tm.shafts, strict=True)):
        if before["rubs"] == shaft["rubs"]:
            continue
        speed = float(tm.y[len(tm.shafts) + i])
        if rested[i]:
            shaft["rest_time"] += t - shaft["rest_begin"]
            record_at_shaft(tm, t, float(EventKind.SLIP), i, out)
        shaft["slip"], shaft["rest_begin"] = math.copysign(1.0, speed) if speed else 0.0, t
        shaft["kept"] = 0
    if tm.train[0].flanks != 0:
        switch_sticking(tm, t, tm.y, out)
    else:
        switch_rest(tm, t, tm.y, out)
    kept = tm.shafts["kept"].copy()
    if kept.any():  # by flanks of meshes that may have no friction now
        tm.shafts["kept"] = 0
        find_kept(tm, t, tm.y)
    for i, lost in enumerate(kept > tm.shafts["kept"]):
        if lost:
            tm.shafts[i]["rest_time"] += t - tm.shafts[i]["rest_begin"]
            record_at_shaft(tm, t, float(EventKind.SLIP), i, out)
