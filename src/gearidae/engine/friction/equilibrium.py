r"""Whether frictions exist that balance a train at rest whose hubs carry the frictions of the pairs, too.

Frictions :math:`f_i` of the pairs within their limits, and what the hubs and the laws of the shafts hold, have to
balance the forces Q of both base circles:

.. math::

    |Q_1 - \sum p_i f_i| \le D_1 + h_1 N_1, \qquad |Q_2 - \sum q_i f_i| \le D_2 + h_2 N_2,

    N_1 = |\sum \mathbf F - \mathbf P|, \qquad N_2 = |\sum \mathbf F|

with the force P of a pin. The modulus of a vector sum is convex in the frictions, so that each inequality keeps at its
bound the whole half-space behind its tangent plane. The farthest point in any direction of all that balances
therefore lies where as many bounds meet as frictions are free: if any f balances, such a vertex does. On a flank,
levers and loads are linear in :math:`\sum f_i` and :math:`\sum r_i f_i`, which make a zonotope in the plane. Its
vertices and edges, of both flanks together, with no, one or both of the inequalities at their bounds, are all vertices
there are; each is a solution for the loads, see `gearidae.engine.friction.hubs.consistent_loads`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gearidae.compiled import compiled
from gearidae.engine.friction.hubs import Loads, across, consistent_loads, loads_with_friction
from gearidae.engine.model.record_types import HELD_GEAR
from gearidae.engine.model.state import DRIVE, LOAD, Model
from gearidae.laws.joint_law import JointFriction

_PARALLEL = 1e-12


class _Left(NamedTuple):
    """What some frictions leave: forces at both base circles, and components of the vector sum of the mesh forces."""

    pinion: float
    gear: float
    along: float
    over: float


class _Limits(NamedTuple):
    """What may hold the shafts, with the loads of their hubs and without, and the force of the pin."""

    of_shaft: tuple[JointFriction, JointFriction]
    pin: tuple[float, float]


@compiled
def equilibrium_margin(m: Model, pinion: float, gear: float) -> float:
    """Largest reserve of force of all vertices; below zero if and only if nothing balances."""
    work = m.work.friction
    on_pinion = on_gear = JointFriction(0.0, 0.0)
    for i in range(work.pairs, work.count):
        element = work.element[i]
        if element.hold == HELD_GEAR:
            on_gear = JointFriction(element.by_load, element.limit)
        else:
            on_pinion = JointFriction(element.by_load, element.limit)
    limits = _Limits((on_pinion, on_gear), (work.pin[0], work.pin[1]))
    free = _Left(pinion, gear, work.load[0], work.load[1])
    if work.pairs == 0:
        return _at_vertex(free, limits)
    best = -math.inf
    for a in range(2 * work.pairs):
        i, side = a // 2, 1.0 - 2.0 * (a % 2)
        alone, flank = True, work.element[i].flank
        for b in range(2 * work.pairs):
            k, beyond = b // 2, 1.0 - 2.0 * (b % 2)
            if work.element[k].flank == flank:
                continue
            alone = False
            best = max(best, _around(m, _less(m, free, k, beyond, beyond), i, side, limits))
            if i < k:
                left = _less(m, _less(m, free, i, side, 0.0), k, beyond, 0.0)
                best = max(best, _with_two(m, left, i, k, limits))
        if alone:
            best = max(best, _around(m, free, i, side, limits))
    return best


@compiled
def _around(m: Model, left: _Left, i: int, side: float, limits: _Limits) -> float:
    """Reserve at a vertex of a flank's zonotope and on the edge beside it; with its first one, inside of it."""
    best = _at_vertex(_less(m, left, i, side, side), limits)
    best = max(best, _with_one(m, _less(m, left, i, side, 0.0), i, limits))
    first = j = -1
    for k in range(m.work.friction.pairs):
        if m.work.friction.element[k].flank == m.work.friction.element[i].flank:
            if first < 0:
                first = k
            elif j < 0:
                j = k
    if side > 0.0 and i == first and j >= 0:
        best = max(best, _with_two(m, left, i, j, limits))
    return best


@compiled
def _less(m: Model, left: _Left, i: int, side: float, end: float) -> _Left:
    """Take off the frictions of a flank at the edge of its zonotope along the i-th pair, which is at that `end` of it.

    Pairs with larger levers at the pinion have one direction there, those with smaller ones the other.
    """
    work = m.work.friction
    element = work.element[i]
    pinion, gear, along, over = left
    first, second = across(m, element.flank != 0)
    for j in range(work.pairs):
        pair = work.element[j]
        if pair.flank != element.flank:
            continue
        share = end if j == i else math.copysign(1.0, side * (pair.pinion - element.pinion))
        friction = share * pair.limit
        pinion -= friction * pair.pinion
        gear -= friction * pair.gear
        along += friction * first
        over += friction * second
    return _Left(pinion, gear, along, over)


@compiled(inline=True)
def _at_vertex(left: _Left, limits: _Limits) -> float:
    """Reserve of both shafts where all frictions of the pairs are known."""
    x, z = limits.pin
    loads = Loads(math.hypot(left.along - x, left.over - z), math.hypot(left.along, left.over))
    return min(_reserve(limits, loads, DRIVE, left.pinion), _reserve(limits, loads, LOAD, left.gear))


@compiled(inline=True)
def _reserve(limits: _Limits, loads: Loads, shaft: int, force: float) -> float:
    held = limits.of_shaft[shaft]
    return held.constant + held.by_load * loads[shaft] - abs(force)


@compiled
def _with_one(m: Model, left: _Left, i: int, limits: _Limits) -> float:
    """Largest reserve where the friction of one pair is such that one shaft is held by all that it has."""
    element, best = m.work.friction.element[i], -math.inf
    lever, force = (element.pinion, element.gear), (left.pinion, left.gear)
    for which in range(4):
        shaft, sign = which // 2, 1.0 - 2.0 * (which % 2)
        held, other = limits.of_shaft[shaft], 1 - shaft
        constant = (force[shaft] - sign * held.constant) / lever[shaft]
        fall = sign * held.by_load / lever[shaft]
        falls, total = (fall, 0.0) if shaft == DRIVE else (0.0, fall), (left.along, left.over)
        near, far, room = loads_with_friction(m, element.flank != 0, total, constant, falls, limits.pin)
        for end in range(2):
            loads = far if end else near
            friction = constant - fall * loads[shaft]
            reserve = _reserve(limits, loads, other, force[other] - friction * lever[other])
            best = max(best, min(room, reserve, element.limit - abs(friction)))
    return best


@compiled
def _with_two(m: Model, left: _Left, i: int, k: int, limits: _Limits) -> float:
    """Largest reserve where two frictions are such that both shafts are held by all that they have.

    Two pairs of one flank stand for all frictions inside its zonotope.
    """
    work, best = m.work.friction, -math.inf
    first, second = work.element[i], work.element[k]
    pinion, gear = limits.of_shaft
    determinant = first.pinion * second.gear - second.pinion * first.gear
    if abs(determinant) < _PARALLEL:
        return best
    first_along, first_over = across(m, first.flank != 0)
    second_along, second_over = across(m, second.flank != 0)
    for which in range(4):
        on_pinion, on_gear = 1.0 - 2.0 * (which % 2), 1.0 - 2.0 * (which // 2)
        a, b = left.pinion - on_pinion * pinion.constant, left.gear - on_gear * gear.constant
        c, d = on_pinion * pinion.by_load / determinant, on_gear * gear.by_load / determinant
        f, g = (
            (a * second.gear - second.pinion * b) / determinant,
            (first.pinion * b - a * first.gear) / determinant,
        )
        u = (left.along + f * first_along + g * second_along, left.over + f * first_over + g * second_over)
        x, z = (
            second.gear * first_along - first.gear * second_along,
            second.gear * first_over - first.gear * second_over,
        )
        by_pinion = (-c * x, -c * z)
        x, z = (
            first.pinion * second_along - second.pinion * first_along,
            first.pinion * second_over - second.pinion * first_over,
        )
        by_gear = (-d * x, -d * z)
        near, far, room = consistent_loads(u, by_pinion, by_gear, limits.pin)
        for end in range(2):
            loads = far if end else near
            p = f - c * second.gear * loads.pinion + d * second.pinion * loads.gear
            q = g + c * first.gear * loads.pinion - d * first.pinion * loads.gear
            if first.flank != second.flank:
                inside = min(first.limit - abs(p), second.limit - abs(q))
            else:
                inside = _inside(
                    m, first.flank, p * first.pinion + q * second.pinion, p * first.gear + q * second.gear
                )
            best = max(best, min(room, inside))
    return best


@compiled
def _inside(m: Model, flank: int, pinion: float, gear: float) -> float:
    """How far the frictions of a flank are inside its zonotope, by the forces that they take from both shafts."""
    work, least = m.work.friction, math.inf
    for i in range(work.pairs):
        element = work.element[i]
        if element.flank != flank:
            continue
        held = 0.0
        for j in range(work.pairs):
            other = work.element[j]
            if other.flank == flank:
                held += other.limit * abs(element.pinion * other.gear - element.gear * other.pinion)
        taken = abs(element.pinion * gear - element.gear * pinion)
        least = min(least, (held - taken) / math.hypot(element.pinion, element.gear))
    return least
