"""The guard, the pairs' histories, and what is done when something happens.

`guard` is the root function that the solver watches. `accept` follows the histories from one accepted time to
the next, and `handle` deals with what the root found there stands for: it records events, takes the joined heights
at turning points and tells the driver whether the equations have jumped, which is the only reason to start the
integration afresh.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.contact.history import joined_height
from gearidae.engine.elastic.calls import follow_nodes, join_nodes, meet_nodes
from gearidae.engine.elastic.nodes import middle_gap
from gearidae.engine.energy.balance import book_joining, kinetic_energy, see_radius
from gearidae.engine.model import layout as at
from gearidae.engine.model.residual import mesh_forces
from gearidae.engine.model.tooth_pairs import (
    first_pair,
    history_slot,
    in_flight,
    last_pair,
    material_stretch,
    nearest_gap,
    pair_gap,
    set_joined,
)
from gearidae.engine.model.torque import torque_force
from gearidae.records import EventKind, Flank

__all__ = [
    "CONTINUE",
    "CROWDED",
    "EVENTS_AT_ONCE",
    "RESTART",
    "accept",
    "begin",
    "guard",
    "handle",
    "ledger_can_wait",
    "pass_knot",
]

Floats = NDArray[np.float64]

CONTINUE, RESTART, CROWDED = 0, 1, 2
EVENTS_AT_ONCE = 128
"""More than `handle` can record in one call."""

_TINY = 1e-300
_NO_FORCE = 1e-12  # of the reference load: less than this neither holds a gear nor moves it from rest
_ONSET, _SEPARATION = float(EventKind.ONSET), float(EventKind.SEPARATION)
_TURNING_POINT, _FULL_STRETCH = float(EventKind.TURNING_POINT), float(EventKind.FULL_STRETCH)
_MESH_ENTRY, _MESH_EXIT = float(EventKind.MESH_ENTRY), float(EventKind.MESH_EXIT)
_STICK, _SLIP, _FLANK_CHANGE = float(EventKind.STICK), float(EventKind.SLIP), float(EventKind.FLANK_CHANGE)
_SCHEDULE_KNOT, _NO_FLANK = float(EventKind.SCHEDULE_KNOT), float(Flank.NONE)


# -- kinematics of gears and rollers alike ---------------------------------------------------------------------


@compiled
def _pairs(d: Floats, coast: int, y: Floats) -> tuple[int, int]:
    """First and last number of the pairs within reach of a flank; a roller is pair 0 of the drive flank."""
    if d[at.KIND] == at.ROLLER:
        return 0, -coast
    return first_pair(d, coast, y[at.PHASE]), last_pair(d, coast, y[at.PHASE])


@compiled
def _kinematics(d: Floats, coast: int, pair: int, y: Floats) -> tuple[float, float]:
    """Gap and gap rate of a pair, or of the roller."""
    if d[at.KIND] == at.ROLLER:
        return y[at.U], y[at.V]
    gap, rate, _, _ = pair_gap(d, coast, pair, y[at.U], y[at.V], y[at.PHASE], y[at.W])
    return gap, rate


# -- the guard -------------------------------------------------------------------------------------------------


@compiled(inline=True)
def guard(d: Floats, t: float, y: Floats) -> float:
    """Root function: falls through zero when the first of all that may happen next does.

    Every single guard (a pair's onset or separation, its turning point, full stretch of a material, a mark of the
    mesh, the dry resistance, a flank coming near) is positive while it waits, so that the least of them waits for
    them all. What has happened is disarmed by `handle`, and the next in the same step is found in its turn.
    """
    least = math.inf
    if d[at.KIND] == at.GEARS:
        least = min(y[at.PHASE] - d[at.MARK_LOW], d[at.MARK_HIGH] - y[at.PHASE])
        if d[at.DRY] != 0.0:
            least = min(least, _dry_guard(d, t, y))
    for coast in range(2):
        if d[at.NEAR + coast] == 0.0:
            if coast == 0 or d[at.KIND] == at.GEARS:
                least = min(least, nearest_gap(d, coast, y) - d[at.CUTOFF])
            continue
        first, last = _pairs(d, coast, y)
        for pair in range(first, last + 1):
            slot = history_slot(d, coast, pair)
            if d[slot + at.PAIR] == pair:
                gap, rate = _kinematics(d, coast, pair, y)
                least = min(least, _pair_guard(d, slot, gap, rate, middle_gap(d, slot, y, gap)))
    # a guard that stays at exactly zero just after its root would be an error to the root finder; zero counts as
    # not yet fallen
    return least if least != 0.0 else _TINY


@compiled
def _pair_guard(d: Floats, slot: int, gap: float, rate: float, middle: float) -> float:
    """Least of one pair's guards; asperities stretch with the gap in the middle, which deflection has its part in."""
    touch = gap - d[at.ENGAGE]
    least = -touch if d[slot + at.TOUCHING] != 0.0 else touch
    if gap >= d[at.CUTOFF]:
        return least
    way = d[slot + at.WAY]
    if way != 0.0:
        least = min(least, rate * way)
    if way > 0.0:
        for material in range(2):
            limit = material_stretch(d, material)
            if limit > 0.0 and d[slot + at.TORN + material] == 0.0:
                least = min(least, d[slot + at.JOINED + material] + limit - middle)
    return least


@compiled(inline=True)
def _dry_guard(d: Floats, t: float, y: Floats) -> float:
    """Slip speed, or what is left of the dry resistance of a gear held at rest."""
    if d[at.SLIP] == 0.0:
        return _hold_guard(d, t, y)
    # a slip too slow to be told from rest may turn back a little before it is called one
    return y[at.W] * d[at.SLIP] + (0.0 if d[at.MOVING] != 0.0 else 2.0 * d[at.REST_SPEED])


@compiled
def _hold_guard(d: Floats, t: float, y: Floats) -> float:
    """What is left of the dry resistance of a gear held at rest."""
    return max(torque_force(d, int(d[at.LOAD_AT]), t), 0.0) + 2.0 * _NO_FORCE - abs(_push(d, t, y))


@compiled
def _push(d: Floats, t: float, y: Floats) -> float:
    """Force on a gear at rest, from the mesh."""
    force, relief, _, _, _, _ = mesh_forces(d, t, y)
    return force + d[at.DAMPING] * y[at.V] + relief


# -- histories between events ----------------------------------------------------------------------------------


@compiled(inline=True)
def accept(d: Floats, t: float, y: Floats) -> None:
    """Follow the histories to an accepted time; beyond the cut-off nothing is joined and nothing is remembered."""
    d[at.LAST_TIME] = t
    if d[at.DRY] != 0.0 and y[at.W] * d[at.SLIP] > d[at.REST_SPEED]:
        d[at.MOVING] = 1.0
    for coast in range(1 if d[at.KIND] == at.ROLLER else 2):
        if nearest_gap(d, coast, y) >= d[at.CUTOFF]:
            if d[at.NEAR + coast] != 0.0:
                _forget(d, coast)
            continue
        d[at.NEAR + coast] = 1.0
        first, last = _pairs(d, coast, y)
        for pair in range(first, last + 1):
            slot = history_slot(d, coast, pair)
            gap, rate = _kinematics(d, coast, pair, y)
            if d[slot + at.PAIR] != pair or gap >= d[at.CUTOFF]:
                _meet(d, slot, pair, gap, middle_gap(d, slot, y, gap))
                if d[at.NODES] > 0.0:
                    meet_nodes(d, slot, y, gap)
            elif d[at.NODES] > 0.0:
                follow_nodes(d, slot, y, gap)
            d[slot + at.LAST_GAP], d[slot + at.LAST_RATE] = gap, rate
            if gap < d[at.LOWEST_GAP]:
                d[at.PASSED] = 1.0
            if d[slot + at.WAY] == 0.0:
                d[slot + at.WAY] = float(np.sign(rate))


@compiled
def _forget(d: Floats, coast: int) -> None:
    """Empty a flank's slots: none of its pairs is near."""
    d[at.NEAR + coast] = 0.0
    slots = int(d[at.SLOTS])
    for k in range(slots):
        d[int(d[at.HISTORIES]) + int(d[at.HISTORY]) * (coast * slots + k) + at.PAIR] = math.nan


@compiled
def _meet(d: Floats, slot: int, pair: int, gap: float, middle: float) -> None:
    """Start the history of a pair on which nothing is joined yet."""
    if d[slot + at.PAIR] != pair:
        d[slot + at.PAIR] = pair
        d[slot + at.TOUCHING] = 1.0 if gap < d[at.ENGAGE] else 0.0
        for material in range(2):
            if material_stretch(d, material) > 0.0:
                set_joined(d, slot, material, middle)
    for material in range(2):
        d[slot + at.JOINED + material] = middle  # beyond the cut-off its branch does not matter
        if gap >= d[at.CUTOFF]:
            d[slot + at.BOOKED + material] = 0.0
        d[slot + at.TORN + material] = 0.0
    d[slot + at.WAY] = 0.0


@compiled(makes_arrays=True)
def begin(d: Floats, t: float, y: Floats) -> None:
    """Set the histories and mesh marks for a start at `y`."""
    for coast in range(1 if d[at.KIND] == at.ROLLER else 2):
        _forget(d, coast)
    accept(d, t, y)
    if d[at.KIND] == at.GEARS:
        _set_marks(d, y[at.PHASE])
        if d[at.SLIP] == 0.0 and _dry_guard(d, t, y) <= 0.0:  # nothing holds it from the start
            _stick_or_slip(d, t, y, np.empty((EVENTS_AT_ONCE, 5)), 0)


# -- what happens at a root ------------------------------------------------------------------------------------


@compiled
def handle(d: Floats, t: float, y: Floats, events: Floats, count: int) -> tuple[int, int]:
    """Deal with all guards that have fallen at t.

    Parameters
    ----------
    d : ndarray
        The scene; histories, marks and modes change in place.
    t : float
        Time over tau; `accept` has been there.
    y : ndarray, shape (n,)
        State there; set to rest where dry resistance takes hold.
    events : ndarray, shape (m, 5)
        Time [s], kind, pair, flank, gap rate [m/s]; must have room for `EVENTS_AT_ONCE` more.
    count : int
        Events already there.

    Returns
    -------
    count, action : int
        New number of events, and `CONTINUE`, `RESTART` (the equations have jumped) or `CROWDED`.
    """
    action = CONTINUE
    lost, crossed = d[at.ADHESION_LOSS], False
    if d[at.KIND] == at.GEARS:
        forward = y[at.PHASE] >= d[at.MARK_HIGH]
        if forward or y[at.PHASE] < d[at.MARK_LOW]:
            crossed = True
            count = _cross_mark(d, t, y, forward, events, count)
        if d[at.DRY] != 0.0 and _dry_guard(d, t, y) <= 0.0:
            action = RESTART
            count = _stick_or_slip(d, t, y, events, count)
    for coast in range(2):
        if d[at.NEAR + coast] == 0.0:
            continue
        first, last = _pairs(d, coast, y)
        for pair in range(first, last + 1):
            slot = history_slot(d, coast, pair)
            if d[slot + at.PAIR] == pair:
                count = _handle_pair(d, t, y, coast, pair, slot, events, count)
    if crossed or (d[at.NODES] > 0.0 and d[at.KIND] == at.GEARS and d[at.ADHESION_LOSS] != lost):
        see_radius(d, t, y)
    if t - d[at.LAST_ROOT] > d[at.ROOT_SPACING] * (1.0 + t):
        d[at.ROOTS] = 0.0
    d[at.LAST_ROOT] = t
    d[at.ROOTS] += 1.0
    if d[at.ROOTS] > d[at.ROOT_LIMIT]:
        action = CROWDED
    return count, action


@compiled
def ledger_can_wait(d: Floats, t: float, y: Floats) -> bool:
    """Whether the ledger has no need to look at a root, before `handle` is there.

    That is so where gears' pairs touch, part or turn round and nothing else happens: up to their third derivative the
    powers know nothing of it.
    """
    if d[at.KIND] == at.ROLLER or d[at.NODES] > 0.0 or d[at.PASSED] != 0.0:
        return False
    if in_flight(d) or t - d[at.LEDGER_TIME] > d[at.LEDGER_SPAN]:
        return False
    if not d[at.MARK_LOW] <= y[at.PHASE] < d[at.MARK_HIGH]:
        return False
    if d[at.DRY] != 0.0 and _dry_guard(d, t, y) <= 0.0:
        return False
    for coast in range(2):
        if d[at.NEAR + coast] == 0.0:
            continue
        first, last = _pairs(d, coast, y)
        for pair in range(first, last + 1):
            slot = history_slot(d, coast, pair)
            if d[slot + at.PAIR] == pair:
                gap, _ = _kinematics(d, coast, pair, y)
                if _stretched(d, slot, 0, gap) or _stretched(d, slot, 1, gap):
                    return False
    return True


@compiled
def _stretched(d: Floats, slot: int, material: int, middle: float) -> bool:
    """Whether a material's asperities have been stretched in full since that was last recorded."""
    limit = material_stretch(d, material)
    waiting = limit > 0.0 and d[slot + at.WAY] > 0.0 and d[slot + at.TORN + material] == 0.0
    return bool(waiting and d[slot + at.JOINED + material] + limit <= middle)


@compiled
def _record(
    events: Floats, count: int, d: Floats, t: float, kind: float, pair: float, flank: float, rate: float
) -> int:
    """Write an event in SI units, and return the new count."""
    events[count, 0] = t * d[at.TAU]
    events[count, 1] = kind
    events[count, 2] = pair + (d[at.TURNS] if flank >= 0.0 else 0.0)
    events[count, 3] = flank
    events[count, 4] = rate * d[at.SIGMA] / d[at.TAU]
    return count + 1


@compiled
def _handle_pair(
    d: Floats, t: float, y: Floats, coast: int, pair: int, slot: int, events: Floats, count: int
) -> int:
    """Deal with one pair's guards that have fallen, and disarm them."""
    gap, rate = _kinematics(d, coast, pair, y)
    inside = gap <= d[at.ENGAGE] if d[slot + at.TOUCHING] == 0.0 else gap < d[at.ENGAGE]
    if inside != (d[slot + at.TOUCHING] != 0.0):
        d[slot + at.TOUCHING] = 1.0 if inside else 0.0
        count = _record(events, count, d, t, _ONSET if inside else _SEPARATION, pair, coast, rate)
        if inside and d[at.LAST_FLANK] == 1 - coast:
            count = _record(events, count, d, t, _FLANK_CHANGE, pair, coast, rate)
        if inside:
            d[at.LAST_FLANK] = coast
    if gap >= d[at.CUTOFF]:
        return count
    way = d[slot + at.WAY]
    middle = middle_gap(d, slot, y, gap)
    for material in range(2):
        if _stretched(d, slot, material, middle):
            d[slot + at.TORN + material] = 1.0
            count = _record(events, count, d, t, _FULL_STRETCH, pair, coast, rate)
    if way != 0.0 and way * rate <= 0.0:
        if way < 0.0:
            book_joining(d, y, coast, pair, slot, gap)
        for material in range(2):
            limit = material_stretch(d, material)
            if limit > 0.0:
                set_joined(d, slot, material, joined_height(d[slot + at.JOINED + material], middle, limit))
                d[slot + at.TORN + material] = 0.0
        if d[at.NODES] > 0.0:
            join_nodes(d, slot, y, gap)
        d[slot + at.WAY] = -way
        d[slot + at.LAST_GAP], d[slot + at.LAST_RATE] = gap, 0.0
        count = _record(events, count, d, t, _TURNING_POINT, pair, coast, rate)
    return count


@compiled
def _stick_or_slip(d: Floats, t: float, y: Floats, events: Floats, count: int) -> int:
    """Set-valued dry resistance: it holds the gear as long as it can, and gives way as the load pushes."""
    before = kinetic_energy(d, y)
    y[at.W] = d[at.MOVING] = 0.0
    d[at.DRY_LOSS] += before - kinetic_energy(d, y)
    push = _push(d, t, y)
    slipping = d[at.SLIP] != 0.0
    if slipping and abs(push) <= max(torque_force(d, int(d[at.LOAD_AT]), t), 0.0) + _NO_FORCE:
        d[at.SLIP] = 0.0
        return _record(events, count, d, t, _STICK, 0, _NO_FLANK, 0.0)
    d[at.SLIP] = 1.0 if push > 0.0 else -1.0
    return count if slipping else _record(events, count, d, t, _SLIP, 0, _NO_FLANK, 0.0)


@compiled
def pass_knot(d: Floats, t: float, events: Floats, count: int) -> int:
    """Enter the next segment of every schedule that has a knot here."""
    for law in (int(d[at.DRIVE_AT]), int(d[at.LOAD_AT])):
        first = law + at.LAW_BODY + 3 * int(d[law + at.LAW_HARMONICS])
        points = int(d[law + at.LAW_POINTS])
        while d[law + at.LAW_SEGMENT] < points and d[first + 2 * int(d[law + at.LAW_SEGMENT])] <= t:
            d[law + at.LAW_SEGMENT] += 1.0
    d[at.NEXT_KNOT] += 1.0
    return _record(events, count, d, t, _SCHEDULE_KNOT, 0, _NO_FLANK, 0.0)


# -- marks of the mesh -----------------------------------------------------------------------------------------


@compiled
def _mark(d: Floats, k: int) -> float:
    """Phase of the first mark of each kind: drive entry and exit, coast exit and entry (it runs the other way)."""
    if k == 0:
        return 0.0
    if k == 1:
        return d[at.PATH]
    if k == 2:
        return d[at.COAST_PHASE]
    return d[at.COAST_PHASE] - d[at.PATH]


@compiled
def _set_marks(d: Floats, phase: float) -> None:
    """Bracket the phase by the nearest mesh entries and exits of either flank."""
    low, high = -math.inf, math.inf
    for k in range(4):
        mark = _mark(d, k)
        whole = math.floor(phase - mark)
        low, high = max(low, whole + mark), min(high, whole + 1 + mark)
    d[at.MARK_LOW], d[at.MARK_HIGH] = low, high


@compiled
def _cross_mark(d: Floats, t: float, y: Floats, forward: bool, events: Floats, count: int) -> int:
    """Mesh entry or exit at the mark just crossed; then bracket the phase anew from the far side."""
    crossed = d[at.MARK_HIGH] if forward else d[at.MARK_LOW]
    low, high = -math.inf, math.inf
    for k in range(4):
        mark = _mark(d, k)
        whole = math.floor(crossed - mark + 0.5)
        here = mark + whole
        if abs(crossed - here) < 1e-9:
            coast = 1 if k >= 2 else 0
            begins = (k == 0 or k == 3) == forward
            _, rate = _kinematics(d, coast, whole, y)
            count = _record(events, count, d, t, _MESH_ENTRY if begins else _MESH_EXIT, whole, coast, rate)
        else:
            here = mark + math.floor(crossed - mark)
            if not forward:
                here += 1.0
        # a mark comes out a rounding error before or behind what has been crossed: the phase is on its far side
        if forward:
            low, high = max(low, min(here, crossed)), min(high, here + 1.0)
        else:
            low, high = max(low, here - 1.0), min(high, max(here, crossed))
    d[at.MARK_LOW], d[at.MARK_HIGH] = low, high
    return count
