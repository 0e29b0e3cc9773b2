"""The first event within a step whose polynomial is known: where the least of all guards falls.

Without discrete asperities the guard at the end of a step tells whether anything has happened in it, since forces that
change bring the tolerance to bear. An asperity without force tells the step nothing: it may touch and part again within
one. A step of a train that has some is therefore searched part by part, with a look where the gap of a mesh turns
round; in between the guards of all candidates are cubics (`gearidae.engine.events.asperity_events`).
"""

from __future__ import annotations

from typing import Final

from gearidae.arrays import Floats
from gearidae.compiled import compiled
from gearidae.engine.events.asperity_events import first_grazing_minimum, note_step_start
from gearidae.engine.integrate.roots import DIPS
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import V
from gearidae.engine.population.restore import choose_anew
from gearidae.engine.train.events import train_guard
from gearidae.engine.train.formula import state_at
from gearidae.engine.train.layout import TrainModel
from gearidae.engine.train.motion import mesh_state
from gearidae.engine.train.observe import note_separation

CLOSE: Final = 1e-15
"""Of the time: a root is known to that."""
SEARCHES: Final = 100
PARTS: Final = 4
"""Parts of a step: over a quarter of some radian of the contacts' vibration cubics are within 1e-5 of its amplitude."""
NARROW: Final = 0.01
"""Share of a part at whose ends a gap that turns round needs no look of its own."""
TURNINGS: Final = 4
"""Steps of false position by which that is found: the gap there errs by the square of what is left."""


@compiled
def locate(tm: TrainModel, h: float, low: float, at_low: float, high: float, at_high: float) -> float:
    """Share of a step just behind the first root of the guard that is found between two shares of it.

    Parameters
    ----------
    low, high : float
        Shares, at which the guard is above and not above zero: `at_low` and `at_high`.
    """
    n, train, between = 2 * len(tm.shafts), tm.train[0], tm.between
    least = CLOSE * max(train.time, train.tau) / h
    side = 0
    for i in range(SEARCHES):
        if high - low <= least:
            break
        # guards of several kinds meet in the least of them: false position, and the middle now and then
        share = high - at_high * (high - low) / (at_high - at_low)
        if i % 3 == 2 or not low < share < high:
            share = 0.5 * (low + high)
        state_at(tm, share, n, between)
        value = train_guard(tm, train.time + share * h, between, False)
        if value > 0.0:
            at_high *= 0.5 if side > 0 else 1.0
            low, at_low, side = share, value, 1
        else:
            at_low *= 0.5 if side < 0 else 1.0
            high, at_high, side = share, value, -1
    return high


@compiled
def guard_at(tm: TrainModel, h: float, share: float) -> float:
    """Guard at a share of the step."""
    state_at(tm, share, 2 * len(tm.shafts), tm.between)
    return train_guard(tm, tm.train[0].time + share * h, tm.between, False)


@compiled
def choose_all(tm: TrainModel, y: Floats) -> None:
    """Choose the candidates of all meshes anew, where steps begin anew.

    A step in flight may have ended deep within teeth, where nearly all asperities are candidates.
    """
    for k in range(len(tm.meshes)):
        m = model_at(tm.meshes[k].address)
        if m.scene.population.flanks != 0:
            mesh_state(tm, k, m, y, tm.own)
            choose_anew(m, tm.own)


@compiled
def begin_part(tm: TrainModel, y: Floats) -> None:
    """Note the asperities of all meshes at a state from which the search goes on, where the guard has been asked."""
    for k in range(len(tm.meshes)):
        m = model_at(tm.meshes[k].address)
        if m.scene.population.flanks != 0:
            mesh_state(tm, k, m, y, tm.own)
            note_step_start(m, tm.own)
            tm.meshes[k].closing = tm.own[V]


@compiled
def first_dip(tm: TrainModel, span: float, y: Floats) -> float:
    """Share of a span of time [s] up to a state at which an asperity dips below its guard and comes back; 2 if none.

    The span begins where `begin_part` has been, and the guard has been asked at its end.
    """
    first = 2.0
    for k in range(len(tm.meshes)):
        m = model_at(tm.meshes[k].address)
        if m.scene.population.flanks != 0:
            mesh_state(tm, k, m, y, tm.own)
            share = first_grazing_minimum(m, tm.own, span / tm.meshes[k].time_unit)
            if share > 0.0:
                first = min(first, share)
    return first


@compiled
def _end_of_part(tm: TrainModel, low: float, high: float) -> float:
    """End of the part of a step that begins at a share: the next one, or where the gap of a mesh turns round before."""
    n, end, margin = 2 * len(tm.shafts), high, NARROW * (high - low)
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        m = model_at(mesh.address)
        if m.scene.population.flanks == 0:
            continue
        a, b, before = low, high, mesh.closing
        state_at(tm, b, n, tm.between)
        mesh_state(tm, k, m, tm.between, tm.own)
        after = tm.own[V]
        if not before * after < 0.0:
            continue
        share = b
        for _ in range(TURNINGS):
            share = b - after * (b - a) / (after - before)
            state_at(tm, share, n, tm.between)
            mesh_state(tm, k, m, tm.between, tm.own)
            if tm.own[V] * before > 0.0:
                a, before = share, tm.own[V]
            else:
                b, after = share, tm.own[V]
        if low + margin < share < high - margin:
            end = min(end, share)
    return end


@compiled
def first_root(tm: TrainModel, h: float) -> tuple[bool, float, float]:
    """Search a step of a train with discrete asperities, at whose beginning the guard is above zero.

    The smallest distances of flanks are taken on the way.

    Returns
    -------
    root : bool
        Whether a guard falls.
    share : float
        Just behind that; else 1.
    guard : float
        At the end of the step, where none falls.
    """
    low, part = 0.0, 1
    at_low = tm.train[0].guard
    begin_part(tm, tm.y)
    while part <= PARTS:
        high = part / PARTS
        end = _end_of_part(tm, low, high)
        at_end = guard_at(tm, h, end)
        root = at_end < 0.0
        share = locate(tm, h, low, at_low, end, at_end) if root else end
        for _ in range(DIPS):
            state_at(tm, share, 2 * len(tm.shafts), tm.between)
            dip = low + first_dip(tm, (share - low) * h, tm.between) * (share - low)
            if not dip < share:
                break
            at_dip = guard_at(tm, h, dip)
            if not at_dip < 0.0:
                break
            root, share = True, locate(tm, h, low, at_low, dip, at_dip)
        if root:
            return True, share, at_end
        state_at(tm, end, 2 * len(tm.shafts), tm.between)
        begin_part(tm, tm.between)
        low, at_low = end, at_end
        if end == high:
            part += 1
        else:
            note_separation(tm, tm.between)
    return False, 1.0, at_low
