"""Flanks of a train that begin to rub, slide the other way, stick and slip, with the shafts beside them.

Each pair has its direction of sliding with its history, each shaft that of its slip. What comes to rest is decided on
with all that is at rest already: first the speeds that errors have left are taken out, then Gauss' principle tells
what is held and which way the rest slips (`gearidae.engine.train.box`).
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.arrays import Floats
from gearidae.compiled import compiled
from gearidae.engine.events.record import note_directions, record_changes
from gearidae.engine.events.sliding import STILL
from gearidae.engine.friction.pairs import RUBS
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.record_types import STUCK
from gearidae.engine.model.state import Model
from gearidae.engine.train.box import (
    BOUND,
    FRICTION,
    LEFT,
    LIMIT,
    SMALL,
    STEP,
    UNIT,
    missing_friction,
    solve_free,
)
from gearidae.engine.train.flanks import (
    NO_CONVERGENCE,
    NO_FORCE,
    balance_frictions,
    pair_speeds,
    slide_of,
)
from gearidae.engine.train.layout import TrainModel, TrainOutput, is_at_rest
from gearidae.engine.train.motion import motion
from gearidae.engine.train.record import record_at_shaft, take_from_mesh
from gearidae.records import EventKind

_STICK, _SLIP = float(EventKind.STICK), float(EventKind.SLIP)
_REVERSAL = float(EventKind.SLIDING_REVERSAL)
DETERMINED: Final = 1e-9
"""Share of a shaft's acceleration that elements leave, below which they leave none; rounding is some 1e-16 over the
square of the angle between the rows of two pairs, with masses counted."""


@compiled
def _own_speed(tm: TrainModel, k: int, m: Model, i: int, y: Floats) -> float:
    """Speed of sliding of the i-th pair of a mesh's notes, in the units of the mesh."""
    mesh = tm.meshes[k]
    return float(pair_speeds(tm, k, m, m.work.pair_forces.pair[i], y)[2] * mesh.time_unit / mesh.length_unit)


@compiled
def sticking_guard(tm: TrainModel, y: Floats) -> float:
    """Least of the guards of all flanks with friction, of which the motion has been evaluated last at a state.

    What begins or ends to rub, the speeds of sliding, and what can be held besides.
    """
    least = math.inf
    for k in range(len(tm.meshes)):
        m = model_at(tm.meshes[k].address)
        for i in range(m.work.pair_forces.count if tm.meshes[k].flanks != 0 else 0):
            noted = m.work.pair_forces.pair[i]
            if m.state.history[noted.history].pair != noted.pair:
                continue
            slide, limit = slide_of(m, noted), noted.limit
            if slide == 0:  # a pair far away is no measure of how near the crossing is
                least = min(least, 1.0 if abs(limit) <= RUBS else RUBS - limit)
                continue
            least = min(least, limit - 0.5 * RUBS)
            if slide != STUCK:
                least = min(least, slide * _own_speed(tm, k, m, i, y) + STILL)
    return min(least, _margin(tm)) if tm.train[0].elements > 0 else least


@compiled
def _margin(tm: TrainModel) -> float:
    """How far the elements at rest are from being let go, over the force that counts as none; below zero they are.

    With independent elements the frictions are unique, and so is how far each is from its limit. Else the missing
    friction tells.
    """
    train, least = tm.train[0], math.inf
    for j in range(train.elements):
        least = min(least, (tm.box[LIMIT, j] - abs(tm.box[FRICTION, j])) / tm.box[UNIT, j])
    if least >= 0.0 or train.rank == train.elements:
        return least + 2.0
    if not balance_frictions(tm, True):
        train.error = NO_CONVERGENCE
    most = 0.0
    for j in range(train.elements):
        most = max(most, abs(missing_friction(j, tm.gram, tm.box)))
    return 2.0 - most


@compiled
def begin_sticking(tm: TrainModel, t: float, y: Floats) -> bool:
    """Set the directions of all pairs from the speeds of a start, and decide on what stands still; whether that ends.

    Shafts have their directions by their speeds, those that stand by what they can hold alone.
    """
    n = len(tm.shafts)
    for i in range(n):
        shaft = tm.shafts[i]
        shaft.rest_begin = t
        if shaft.rubs != 0 and y[n + i] == 0.0:
            shaft.slip = 0.0
    motion(tm, t, y, tm.rates[0])
    _begin_to_rub(tm, y)
    if _any_at_rest(tm):
        decide(tm, t, y, SMALL)
    return bool(tm.train[0].error == 0)


@compiled
def _any_at_rest(tm: TrainModel) -> bool:
    """Whether the directions say that a shaft is held or a pair rolls."""
    for i in range(len(tm.shafts)):
        if tm.shafts[i].rubs != 0 and tm.shafts[i].slip == 0.0:
            return True
    for k in range(len(tm.meshes)):
        m = model_at(tm.meshes[k].address)
        for i in range(m.scene.histories if tm.meshes[k].flanks != 0 else 0):
            if m.state.history[i].slide == STUCK:
                return True
    return False


@compiled
def _begin_to_rub(tm: TrainModel, y: Floats) -> tuple[bool, bool]:
    """Give pairs that begin to rub their directions, and take those of others; whether any change, or are at rest."""
    changed = stands = False
    for k in range(len(tm.meshes)):
        m = model_at(tm.meshes[k].address)
        for number in range(m.scene.histories if tm.meshes[k].flanks != 0 else 0):
            h, rubs = m.state.history[number], False
            for i in range(m.work.pair_forces.count if h.slide != 0 else 0):
                noted = m.work.pair_forces.pair[i]
                rubs |= noted.history == number and noted.pair == h.pair and noted.limit >= 0.5 * RUBS
            if h.slide != 0 and not rubs:
                stands |= h.slide == STUCK
                h.slide, changed = 0, True
        for i in range(m.work.pair_forces.count if tm.meshes[k].flanks != 0 else 0):
            noted = m.work.pair_forces.pair[i]
            h = m.state.history[noted.history]
            if h.pair == noted.pair and h.slide == 0 and noted.limit > RUBS:
                speed, changed = _own_speed(tm, k, m, i, y), True
                h.slide = STUCK if abs(speed) <= STILL else int(math.copysign(1.0, speed))
                stands |= h.slide == STUCK
    return changed, stands


@compiled
def switch_sticking(tm: TrainModel, t: float, y: Floats, out: TrainOutput) -> bool:
    """Deal with all guards of friction that have fallen, see `gearidae.engine.train.rest.switch_rest`."""
    n = len(tm.shafts)
    motion(tm, t, y, tm.rates[0])
    alone = tm.train[0].elements == 0
    stands = not alone and _margin(tm) < 0.5
    note_rests(tm)
    changed, stopped = _begin_to_rub(tm, y)
    stands |= stopped
    for k in range(len(tm.meshes)):
        m = model_at(tm.meshes[k].address)
        for i in range(m.work.pair_forces.count if tm.meshes[k].flanks != 0 else 0):
            noted = m.work.pair_forces.pair[i]
            slide = slide_of(m, noted)
            if slide != 0 and slide != STUCK and slide * _own_speed(tm, k, m, i, y) + STILL <= 0.0:
                m.state.history[noted.history].slide, stands = STUCK, True
    for i in range(n):
        shaft = tm.shafts[i]
        if shaft.rubs == 0:
            continue
        if shaft.slip != 0.0 and shaft.slip * y[n + i] <= 0.0:
            shaft.slip, stands = 0.0, True
        elif shaft.slip == 0.0 and alone and shaft.limit < abs(shaft.torque):
            stands = True
    if stands:
        decide(tm, t, y, SMALL)
        record_rests(tm, t, out)
    return changed or stands


@compiled
def note_rests(tm: TrainModel) -> None:
    """Note all directions of slip, and what is at rest, before the decisions of one time."""
    for k in range(len(tm.meshes)):
        if tm.meshes[k].flanks != 0:
            note_directions(model_at(tm.meshes[k].address))
    for i in range(len(tm.shafts)):
        shaft = tm.shafts[i]
        shaft.before, shaft.rested = shaft.slip, int(is_at_rest(shaft))


@compiled
def record_rests(tm: TrainModel, t: float, out: TrainOutput) -> None:
    """Record the directions that have changed, and begin and end rests of shafts."""
    for k in range(len(tm.meshes)):
        if tm.meshes[k].flanks != 0:
            m = model_at(tm.meshes[k].address)
            take_from_mesh(tm, k, record_changes(m, t / tm.meshes[k].time_unit, tm.few, 0), out)
    for i in range(len(tm.shafts)):
        shaft, rests = tm.shafts[i], is_at_rest(tm.shafts[i])
        if rests and shaft.rested == 0:
            shaft.rest_begin = t
            record_at_shaft(tm, t, _STICK, i, out)
        elif shaft.rested != 0 and not rests:
            shaft.rest_time += t - shaft.rest_begin
            record_at_shaft(tm, t, _SLIP, i, out)
        elif shaft.slip != shaft.before:
            record_at_shaft(tm, t, _REVERSAL, i, out)


@compiled
def decide(tm: TrainModel, t: float, y: Floats, allowed: float) -> None:
    """Decide on all that is at rest: what is held, which way the others slip, and which shafts pairs keep at rest.

    What is held may lack so much friction, over the force that counts as none.
    """
    for i in range(len(tm.shafts)):  # a shaft that is kept at rest would show no acceleration
        tm.shafts[i].kept = 0
    _decide_on_elements(tm, t, y, allowed)
    find_kept(tm, t, y)


@compiled
def find_kept(tm: TrainModel, t: float, y: Floats) -> None:
    """Find the shafts without friction of their own whose speeds follow from what is at rest, and are zero.

    Two pairs of a mesh keep both of its shafts, one pair the shaft beside one that stands; in a loop pairs of all
    meshes do. A shaft is kept if a torque on it alone accelerates nothing: if its row is one of those of the elements.
    """
    motion(tm, t, y, tm.rates[15])
    train, n = tm.train[0], len(tm.shafts)
    for i in range(n if train.elements > 0 else 0):
        shaft = tm.shafts[i]
        if shaft.rubs != 0:
            continue
        for j in range(train.elements):
            tm.box[BOUND, j], tm.box[LEFT, j] = 0.0, share_of(tm, i, j) / shaft.inertia
        solve_free(train.elements, tm.gram, tm.work, tm.box)
        left = 1.0
        for j in range(train.elements):
            left -= share_of(tm, i, j) * tm.box[STEP, j]
        # a light shaft beside a very heavy one nearly follows from a pair that rolls on both: it moves with that
        shaft.kept = int(abs(left) <= DETERMINED and abs(y[n + i]) <= shaft.still)
    for i in range(n):
        if tm.shafts[i].kept != 0:
            y[n + i] = 0.0


@compiled
def share_of(tm: TrainModel, i: int, j: int) -> float:
    """Speed of an element at rest per speed of a shaft."""
    element = tm.elements[j]
    return float((element.first if element.a == i else 0.0) + (element.second if element.b == i else 0.0))


@compiled
def _decide_on_elements(tm: TrainModel, t: float, y: Floats, allowed: float) -> None:
    """Take out the speeds of what is at rest, and let go what its friction can not hold."""
    _stop(tm, t, y)
    while _add_still(tm, y):
        _stop(tm, t, y)
    train = tm.train[0]
    if train.elements == 0:  # shafts alone, of which each is held by itself
        for i in range(len(tm.shafts)):
            shaft = tm.shafts[i]
            if shaft.rubs != 0 and shaft.slip == 0.0 and abs(shaft.torque) > shaft.limit:
                shaft.slip = math.copysign(1.0, shaft.torque)
        return
    if not balance_frictions(tm, True):
        train.error = NO_CONVERGENCE
        return
    for j in range(train.elements):
        missing = missing_friction(j, tm.gram, tm.box)
        if abs(missing) <= allowed:
            continue
        element, way = tm.elements[j], math.copysign(1.0, missing)
        if element.mesh < 0:
            tm.shafts[element.a].slip = way
        else:
            model_at(tm.meshes[element.mesh].address).state.history[element.history].slide = int(way)


@compiled
def _stop(tm: TrainModel, t: float, y: Floats) -> None:
    """Take out the speeds of all that is at rest, with the impulses that friction would need, and list it."""
    n = len(tm.shafts)
    for i in range(n):
        if tm.shafts[i].rubs != 0 and tm.shafts[i].slip == 0.0:
            y[n + i] = 0.0
    motion(tm, t, y, tm.rates[0])
    train = tm.train[0]
    if train.elements == 0:
        return
    for j in range(train.elements):
        element = tm.elements[j]
        tm.box[LEFT, j] = element.first * y[n + element.a] + element.second * y[n + element.b]
        tm.box[BOUND, j] = 0.0
    solve_free(train.elements, tm.gram, tm.work, tm.box)
    for j in range(train.elements):
        element, impulse = tm.elements[j], tm.box[STEP, j]
        y[n + element.a] -= element.first * impulse / tm.shafts[element.a].inertia
        y[n + element.b] -= element.second * impulse / tm.shafts[element.b].inertia
    for i in range(n):
        if tm.shafts[i].rubs != 0 and tm.shafts[i].slip == 0.0:
            y[n + i] = 0.0
    motion(tm, t, y, tm.rates[0])


@compiled
def _add_still(tm: TrainModel, y: Floats) -> bool:
    """Count what has a direction, but neither a speed nor an acceleration that way, among what is at rest.

    Such are shafts and pairs that others keep at rest. What has just been let go has its acceleration, and stays out:
    its speed, taken out again and again, would never grow. The rates of the state are those of the last evaluation.

    Returns
    -------
    bool
        Whether there is any.
    """
    n, added, rates = len(tm.shafts), False, tm.rates[0]
    if tm.train[0].elements == 0:
        return False
    for i in range(n):
        shaft = tm.shafts[i]
        slow = shaft.rubs != 0 and shaft.slip != 0.0 and abs(y[n + i]) <= shaft.still
        if slow and shaft.slip * rates[n + i] <= SMALL * shaft.no_torque / shaft.inertia:
            shaft.slip, added = 0.0, True
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        m, a, b = model_at(mesh.address), tm.shafts[mesh.a], tm.shafts[mesh.b]
        for i in range(m.work.pair_forces.count if mesh.flanks != 0 else 0):
            noted = m.work.pair_forces.pair[i]
            slide = slide_of(m, noted)
            if slide == 0 or slide == STUCK or abs(_own_speed(tm, k, m, i, y)) > STILL:
                continue
            r1, r2, _ = pair_speeds(tm, k, m, noted, y)
            small = SMALL * NO_FORCE * mesh.force_unit * (r1 * r1 / a.inertia + r2 * r2 / b.inertia)
            if slide * (r1 * rates[n + mesh.a] - r2 * rates[n + mesh.b]) <= small:
                m.state.history[noted.history].slide, added = STUCK, True
    return added
