"""What friction holds of two gears that stand still: Gauss' principle of least constraint.

At rest every element may hold or begin to slip either way. With the accelerations a of both base circles, the inverse
masses and the forces Q without friction, those that follow make

    ``sum (a_i - q_i)^2 / (2 m_i^-1) + sum over elements of limit |J . a|``,  ``q_i = m_i^-1 Q_i``

least. This is strictly convex in two numbers: it is least at rest, on a line on which one element holds, or between
two such lines, where all directions of slip are known. Each of these few candidates is tried.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gearidae.compiled import compiled
from gearidae.engine.friction.forces import Mesh, bearing_load, dry_force, has_gear_element
from gearidae.engine.friction.pairs import levers
from gearidae.engine.model.record_types import HELD_GEAR, HELD_PAIR, HELD_PINION
from gearidae.engine.model.state import COAST, Floats, Model, Record
from gearidae.engine.pairs.tooth_pairs import flank_of_history


@compiled
def list_elements(m: Model, t: float, y: Floats) -> None:
    """List the elements of gears at rest: the pairs that rub, the gear's resistance and hub, and the pinion's hub.

    Friction of the flanks is not unique at rest: the load of the bearings is that without it, or if that is larger
    the one with which the gears have come to rest.
    """
    own, found, count = m.scene.friction, m.work.rubbing, 0
    drive = coast = 0.0
    for i in range(m.work.notes.count):
        noted = m.work.notes.pair[i]
        if flank_of_history(m, noted.history) == COAST:
            coast += noted.force
        else:
            drive += noted.force
        h = m.state.history[noted.history]
        if own.flanks != 0 and h.slide != 0 and h.pair == noted.pair:
            first, second = levers(m, noted.position)
            _set(found.element[count], first, -second, noted.limit, HELD_PAIR)
            found.element[count].history = noted.history
            count += 1
    load = max(bearing_load(m, Mesh(drive, coast, 0.0, 0.0)), m.state.bearing_load)
    if has_gear_element(m):
        _set(found.element[count], 0.0, 1.0, dry_force(m, t, y) + own.gear_hub * load, HELD_GEAR)
        count += 1
    if own.pinion_hub > 0.0:
        _set(found.element[count], 1.0, 0.0, own.pinion_hub * load, HELD_PINION)
        count += 1
    found.count = count


@compiled(inline=True)
def _set(element: Record, pinion: float, gear: float, limit: float, hold: int) -> None:
    element.pinion, element.gear, element.limit, element.hold = pinion, gear, max(limit, 0.0), hold


@compiled
def rest_margin(m: Model, pinion: float, gear: float) -> float:
    """Least distance of the forces at two base circles from those that the listed elements do not hold together.

    The forces that they hold are a zonotope: one inequality for each element, perpendicular to it.
    """
    found = m.work.rubbing
    if found.count == 0:
        return -math.hypot(pinion, gear)
    least = math.inf
    for i in range(found.count):
        one = found.element[i]
        x, y = -one.gear, one.pinion
        held = 0.0
        for j in range(found.count):
            other = found.element[j]
            held += other.limit * abs(x * other.pinion + y * other.gear)
        least = min(least, (held - abs(x * pinion + y * gear)) / math.hypot(x, y))
    return least


class Way(NamedTuple):
    """How two gears at rest begin to move: accelerations, their constraint, and the element that holds, -1 if none."""

    pinion: float
    gear: float
    constraint: float
    element: int


@compiled
def way_from_rest(m: Model, pinion: float, gear: float) -> Way:
    """Accelerations of gears at rest under forces that are not held, with the elements of `list_elements`."""
    found = m.work.rubbing
    a1, a2 = m.scene.pinion_inverse_mass, m.scene.gear_inverse_mass
    best = Way(a1 * pinion, a2 * gear, math.inf, -1)
    if found.count == 0:
        return best
    for i in range(found.count):
        one = found.element[i]
        for side in range(2):
            sign = 1.0 - 2.0 * side
            x, y = -sign * one.gear, sign * one.pinion
            best = _better(best, _along(m, pinion, gear, x, y, i))
            for beyond in range(2):
                best = _better(best, _between(m, pinion, gear, x, y, i, 1.0 - 2.0 * beyond))
    return best


@compiled(inline=True)
def _better(one: Way, other: Way) -> Way:
    return other if other.constraint < one.constraint else one


@compiled(inline=True)
def _constraint(m: Model, pinion: float, gear: float, a: float, b: float) -> float:
    """What is least for the accelerations that follow."""
    found = m.work.rubbing
    a1, a2 = m.scene.pinion_inverse_mass, m.scene.gear_inverse_mass
    # less that of rest, which would swallow how small accelerations differ
    total = 0.5 * (a * a / a1 + b * b / a2) - a * pinion - b * gear
    for j in range(found.count):
        other = found.element[j]
        total += other.limit * abs(other.pinion * a + other.gear * b)
    return total


@compiled(inline=True)
def _along(m: Model, pinion: float, gear: float, x: float, y: float, i: int) -> Way:
    """Best accelerations in a direction in which the i-th element holds."""
    found = m.work.rubbing
    slope = x * pinion + y * gear
    for j in range(found.count):
        other = found.element[j]
        if j != i:
            slope -= other.limit * abs(other.pinion * x + other.gear * y)
    bend = x * x / m.scene.pinion_inverse_mass + y * y / m.scene.gear_inverse_mass
    far = max(slope / bend, 0.0)
    return Way(far * x, far * y, _constraint(m, pinion, gear, far * x, far * y), i)


@compiled(inline=True)
def _between(m: Model, pinion: float, gear: float, x: float, y: float, i: int, side: float) -> Way:
    """Accelerations with the directions of slip just beside that direction."""
    found = m.work.rubbing
    one, left, right = found.element[i], pinion, gear
    for j in range(found.count):
        other = found.element[j]
        speed = other.pinion * x + other.gear * y
        if j == i or speed == 0.0:
            speed = side * (other.pinion * one.pinion + other.gear * one.gear)
        slip = other.limit if speed > 0.0 else -other.limit
        left -= slip * other.pinion
        right -= slip * other.gear
    a, b = m.scene.pinion_inverse_mass * left, m.scene.gear_inverse_mass * right
    return Way(a, b, _constraint(m, pinion, gear, a, b), -1)
