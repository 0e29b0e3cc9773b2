"""What friction holds of two gears that stand still, and how they begin to move.

A train at rest stays there if and only if frictions within their limits balance the forces. The limits of the hubs grow
with their load, that is with the frictions of the pairs. Where nothing balances, the gears begin to move with
directions of slip, and with one element at most that holds, that agree with the accelerations which follow: with limits
that do not depend on each other these are the accelerations of Gauss' principle of least constraint. There always are
some: all frictions that obey the limits of the loads of other frictions make a map of a convex set into itself that
Kakutani's theorem applies to. Each of the few candidates is tried.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gearidae.compiled import compiled
from gearidae.engine.friction.ageing import joint_friction
from gearidae.engine.friction.equilibrium import equilibrium_margin
from gearidae.engine.friction.forces import has_element, shaft_limit
from gearidae.engine.friction.hubs import (
    Loads,
    Mesh,
    across,
    has_hubs,
    loads_with_friction,
    pin_force,
    vector_sum,
)
from gearidae.engine.friction.pairs import levers
from gearidae.engine.model.record_types import HELD_GEAR, HELD_PAIR, HELD_PINION
from gearidae.engine.model.state import COAST, DRIVE, LOAD, Floats, Model, Record, W
from gearidae.engine.pairs.tooth_pairs import flank_of_history


@compiled
def list_elements(m: Model, t: float, y: Floats) -> None:
    """List the elements of gears at rest: the pairs that rub, and what resists the gear and the pinion, with joints."""
    friction, work, count = m.scene.friction, m.work.friction, 0
    drive = coast = 0.0
    for i in range(m.work.pair_forces.count):
        noted = m.work.pair_forces.pair[i]
        on_coast = flank_of_history(m, noted.history) == COAST
        if on_coast:
            coast += noted.force
        else:
            drive += noted.force
        h = m.state.history[noted.history]
        if friction.flanks != 0 and h.slide != 0 and h.pair == noted.pair:
            first, second = levers(m, noted.position)
            _set(work.element[count], first, -second, noted.limit, HELD_PAIR)
            work.element[count].history, work.element[count].flank = noted.history, int(on_coast)
            count += 1
    work.pairs = count
    work.load[0], work.load[1] = vector_sum(m, Mesh(drive, coast, 0.0, 0.0))
    pin, joints = pin_force(m, t, y, 0.0), joint_friction(m, t, y)
    work.pin[0], work.pin[1] = pin
    of_gear, of_pinion = (LOAD, y[W], 0.0, 1.0, HELD_GEAR), (DRIVE, 0.0, 1.0, 0.0, HELD_PINION)
    for shaft, speed, pinion, gear, hold in (of_gear, of_pinion):
        if has_element(m, shaft):
            limit = shaft_limit(m, shaft, t, y, speed, joints, pin)
            _set(work.element[count], pinion, gear, limit, hold)
            work.element[count].by_load = joints[shaft].by_load
            count += 1
    work.count = count


@compiled(inline=True)
def _set(element: Record, pinion: float, gear: float, limit: float, hold: int) -> None:
    element.pinion, element.gear, element.limit, element.hold = pinion, gear, max(limit, 0.0), hold
    element.by_load, element.flank = 0.0, 0


@compiled
def rest_margin(m: Model, pinion: float, gear: float) -> float:
    """How far the forces at both base circles are from those that the listed elements do not hold together.

    Below zero where no frictions balance them. Without hubs it is the least distance: the forces that are held are a
    zonotope, with one inequality for each element, perpendicular to it, and one along it, as all may be parallel.
    """
    work = m.work.friction
    if work.count == 0:
        return -math.hypot(pinion, gear)
    if has_hubs(m):
        return equilibrium_margin(m, pinion, gear)
    least = math.inf
    for i in range(work.count):
        element = work.element[i]
        least = min(least, _held_along(m, -element.gear, element.pinion, pinion, gear))
        least = min(least, _held_along(m, element.pinion, element.gear, pinion, gear))
    return least


@compiled(inline=True)
def _held_along(m: Model, x: float, y: float, pinion: float, gear: float) -> float:
    """How much more force all elements hold along a direction than is there."""
    work, held = m.work.friction, 0.0
    for j in range(work.count):
        other = work.element[j]
        held += other.limit * abs(x * other.pinion + y * other.gear)
    return (held - abs(x * pinion + y * gear)) / math.hypot(x, y)


class Way(NamedTuple):
    """How two gears at rest begin to move.

    Attributes
    ----------
    pinion, gear : float
        Accelerations.
    reserve : float
        By how much force its directions of slip and what is held agree with them; below zero if they do not.
    element : int
        That holds, -1 if none.
    """

    pinion: float
    gear: float
    reserve: float
    element: int


@compiled
def way_from_rest(m: Model, pinion: float, gear: float) -> Way:
    """Accelerations of gears at rest under forces that are not held, with the elements of `list_elements`."""
    work = m.work.friction
    a1, a2 = m.scene.pinion_inverse_mass, m.scene.gear_inverse_mass
    best = Way(a1 * pinion, a2 * gear, -math.inf, -1)
    for i in range(work.count):
        element = work.element[i]
        for side in range(2):
            sign = 1.0 - 2.0 * side
            x, y = -sign * element.gear, sign * element.pinion
            best = _better(best, _along(m, pinion, gear, x, y, i))
            for beyond in range(2):
                best = _better(best, _between(m, pinion, gear, x, y, i, 1.0 - 2.0 * beyond))
    return best


@compiled(inline=True)
def _better(way: Way, other: Way) -> Way:
    return other if other.reserve > way.reserve else way


class _Slipping(NamedTuple):
    """Forces that the elements that slip leave, what the hubs take of them by their loads, and the mesh forces' sum."""

    pinion: float
    gear: float
    by_pinion: float
    by_gear: float
    along: float
    over: float


@compiled
def _slipping(m: Model, pinion: float, gear: float, x: float, y: float, i: int, side: float) -> _Slipping:
    """All elements slip as both gears accelerate along (x, y), the i-th and those like it as `side` says."""
    work = m.work.friction
    element, by_pinion, by_gear = work.element[i], 0.0, 0.0
    along, over = work.load[0], work.load[1]
    for j in range(work.count):
        other = work.element[j]
        speed = other.pinion * x + other.gear * y
        if j == i or speed == 0.0:
            speed = side * (other.pinion * element.pinion + other.gear * element.gear)
        if speed == 0.0:
            continue
        slip = math.copysign(1.0, speed)
        friction = slip * other.limit
        pinion -= friction * other.pinion
        gear -= friction * other.gear
        by_pinion += slip * other.by_load * other.pinion
        by_gear += slip * other.by_load * other.gear
        if other.hold == HELD_PAIR:
            first, second = across(m, other.flank != 0)
            along += friction * first
            over += friction * second
    return _Slipping(pinion, gear, by_pinion, by_gear, along, over)


@compiled(inline=True)
def _loads(m: Model, s: _Slipping) -> Loads:
    """Loads of both hubs where all that rubs slips."""
    pin = m.work.friction.pin
    return Loads(math.hypot(s.along - pin[0], s.over - pin[1]), math.hypot(s.along, s.over))


@compiled
def _along(m: Model, pinion: float, gear: float, x: float, y: float, i: int) -> Way:
    """Accelerations in a direction in which the i-th element holds."""
    element, s = m.work.friction.element[i], _slipping(m, pinion, gear, x, y, i, 0.0)
    a1, a2 = m.scene.pinion_inverse_mass, m.scene.gear_inverse_mass
    easy = a1 * element.pinion**2 + a2 * element.gear**2
    held = (a1 * element.pinion * s.pinion + a2 * element.gear * s.gear) / easy
    falls, gear_falls = a1 * element.pinion * s.by_pinion / easy, a2 * element.gear * s.by_gear / easy
    near = far = _loads(m, s)
    room = math.inf
    if element.hold == HELD_PAIR:
        total, pin = (s.along, s.over), (m.work.friction.pin[0], m.work.friction.pin[1])
        near, far, room = loads_with_friction(m, element.flank != 0, total, held, (falls, gear_falls), pin)
    best = Way(0.0, 0.0, -math.inf, i)
    for which in range(2):
        loads = far if which else near
        on_pinion, on_gear = s.pinion - s.by_pinion * loads.pinion, s.gear - s.by_gear * loads.gear
        slope = x * on_pinion + y * on_gear
        limit = element.limit + element.by_load * (
            loads.pinion if element.hold == HELD_PINION else loads.gear
        )
        reserve = limit - abs(held - falls * loads.pinion - gear_falls * loads.gear)
        reserve = min(reserve, room, slope / math.hypot(x, y))
        if reserve > best.reserve:
            go = max(slope / (x * x / a1 + y * y / a2), 0.0)
            best = Way(go * x, go * y, reserve, i)
    return best


@compiled
def _between(m: Model, pinion: float, gear: float, x: float, y: float, i: int, side: float) -> Way:
    """Accelerations with the directions of slip just beside that direction."""
    work, s = m.work.friction, _slipping(m, pinion, gear, x, y, i, side)
    a1, a2 = m.scene.pinion_inverse_mass, m.scene.gear_inverse_mass
    element, loads, reserve = work.element[i], _loads(m, s), math.inf
    a, b = a1 * (s.pinion - s.by_pinion * loads.pinion), a2 * (s.gear - s.by_gear * loads.gear)
    for j in range(work.count):
        other = work.element[j]
        speed = other.pinion * x + other.gear * y
        if j == i or speed == 0.0:
            speed = side * (other.pinion * element.pinion + other.gear * element.gear)
        follows = (other.pinion * a + other.gear * b) / (a1 * other.pinion**2 + a2 * other.gear**2)
        reserve = min(reserve, math.copysign(1.0, speed) * follows)
    return Way(a, b, reserve, -1)
