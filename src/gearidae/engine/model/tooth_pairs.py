"""Tooth pairs in mesh: gap, rate and force of each, from the scaled state (Teodorescu et al. 2009, Eqs. 4-6).

A pair is known by its number i. On the drive flank it stands ``phase - i`` pitches along the path of contact, on the
coast flank, mirrored about the pitch point and half a pitch later, ``COAST_PHASE + i - phase``. All functions take
the flat array of `layout` and the state's numbers, and are compiled.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.contact.history import extreme_gap, joined_height
from gearidae.contact.kernels.law import (
    B_PIECES,
    branch_length,
    branch_value,
    loading_value,
    set_branch,
    stretched_value,
)
from gearidae.engine.model import layout as at

__all__ = [
    "energy_branch",
    "first_pair",
    "footprint",
    "history_slot",
    "last_pair",
    "material_stretch",
    "nearest_gap",
    "pair_force",
    "pair_gap",
    "set_joined",
    "static_error",
]

Floats = NDArray[np.float64]


@compiled
def first_pair(d: Floats, coast: int, phase: float) -> int:
    """Lowest number of the pairs within reach of a flank."""
    if coast:
        return math.ceil(phase - d[at.COAST_PHASE] - d[at.REACH])
    return math.ceil(phase - d[at.PATH] - d[at.REACH])


@compiled
def last_pair(d: Floats, coast: int, phase: float) -> int:
    """Highest number of the pairs within reach of a flank."""
    if coast:
        return math.floor(phase - d[at.COAST_PHASE] + d[at.PATH] + d[at.REACH])
    return math.floor(phase + d[at.REACH])


@compiled
def history_slot(d: Floats, coast: int, pair: int) -> int:
    """Offset of a pair's history; slots go round, with at least as many of them as pairs can be within reach."""
    slots = int(d[at.SLOTS])
    return int(d[at.HISTORIES]) + int(d[at.HISTORY]) * (coast * slots + (pair & (slots - 1)))


@compiled
def pair_gap(
    d: Floats, coast: int, pair: int, u: float, v: float, phase: float, w: float
) -> tuple[float, float, float, float]:
    """Gap, its rate, slope of the separation ds/dxi, and the place along the path clipped to it (in pitches)."""
    along = d[at.COAST_PHASE] + pair - phase if coast else phase - pair
    path = d[at.PATH]
    inside = min(max(along, 0.0), path)
    outside = along - inside
    toward = -v if not coast else v
    gap = d[at.HALF_BACKLASH] + (u if coast else -u)
    if outside == 0.0:
        return gap, toward, 0.0, inside
    slope = d[at.RELIEF_SLOPE] * outside
    gap += 0.5 * d[at.RELIEF] * outside * outside
    turn = -w if coast else w
    return gap, toward + slope * turn, slope, inside


@compiled(inline=True)
def pair_force(
    d: Floats, slot: int, known: bool, t: float, gap: float, rate: float, inside: float
) -> tuple[float, float]:
    """Force of one pair and its slope in the gap, scaled, with the pair's own history.

    Within a step that has turned the pair round, the history first goes through the turning point.
    """
    force, slope = loading_value(d, int(d[at.LOADING_AT]), gap)
    if known:
        turned = d[slot + at.WAY] * rate < 0.0
        turning_gap = gap
        if turned:
            turning_gap = extreme_gap(
                t - d[at.LAST_TIME], d[slot + at.LAST_GAP], d[slot + at.LAST_RATE], gap, rate
            )
        for material in range(2):
            record = at.MATERIALS + at.MATERIAL * material
            limit = d[record + at.M_STRETCH]
            if limit == 0.0:
                continue
            joined = d[slot + at.JOINED + material]
            if turned:
                joined = joined_height(joined, turning_gap, limit)
            stretch = gap - joined
            if stretch <= 0.0:
                continue
            first = force_branch(d, slot, material)
            kept = d[at.BRANCH] > 0.0 and d[first + B_PIECES] > 0.0
            if stretch < limit and not turned and kept:
                q, dq = branch_value(d[first:], stretch)
            else:
                q, dq = stretched_value(d[int(d[record + at.M_TABLE]) :], gap, joined)
            force += d[record + at.M_FORCE] * q
            slope += d[record + at.M_FORCE] * dq
    if d[at.KIND] == at.ROLLER:
        return force, slope
    length = footprint(d, inside)
    return force * length, slope * length


@compiled
def footprint(d: Floats, inside: float) -> float:
    """Length of a contact of given gap, ``sqrt(R / pb)``: R is the reduced radius of the two involutes."""
    pinion = d[at.START_RADIUS] + inside
    return math.sqrt(pinion - pinion * pinion * d[at.SUM_CURVATURE])


@compiled
def nearest_gap(d: Floats, coast: int, y: Floats) -> float:
    """Gap of a pair on the path of contact, which no pair of this flank undercuts; a roller's height."""
    if d[at.KIND] == at.ROLLER:
        return y[at.U]
    return d[at.HALF_BACKLASH] + (y[at.U] if coast else -y[at.U])


@compiled
def in_flight(d: Floats) -> bool:
    """Whether both flanks are too far away for any pair to touch."""
    return bool(d[at.NEAR] == 0.0 and d[at.NEAR + 1] == 0.0)


@compiled
def material_stretch(d: Floats, material: int) -> float:
    """Stretch limit of a material, bare or coated, over sigma; 0 where it has no hysteresis to follow."""
    return d[at.MATERIALS + at.MATERIAL * material + at.M_STRETCH]


@compiled
def set_joined(d: Floats, slot: int, material: int, joined: float) -> None:
    """Store the joined height of a turning point, and work out the branch that starts from it."""
    joining = d[at.ENERGIES + at.ENERGY * material + at.E_JOINING]
    d[slot + at.JOINED + material] = joined
    d[slot + at.BOOKED + material] = -joining * loading_value(d, int(d[at.NUMBER_AT]), joined)[0]
    table = d[int(d[at.MATERIALS + at.MATERIAL * material + at.M_TABLE]) :]
    # a law that is integrated when asked for keeps no branches, nor does an elastic contact
    if d[at.BRANCH] > 0.0 and branch_length(table) > 0:
        set_branch(table, joined, d[force_branch(d, slot, material) :])
        d[energy_branch(d, slot, material) + B_PIECES] = 0.0  # to be worked out if the ledger comes there


@compiled
def force_branch(d: Floats, slot: int, material: int) -> int:
    """Offset of a material's branch of the force law at its joined height."""
    return slot + at.BRANCHES + material * int(d[at.BRANCH])


@compiled
def energy_branch(d: Floats, slot: int, material: int) -> int:
    """Offset of a material's branch of the stored energy there."""
    return slot + at.BRANCHES + (2 + material) * int(d[at.BRANCH])


@compiled
def static_error(d: Floats, u: float, phase: float) -> tuple[float, float, float, float]:
    """Pinion's angle, static transmission error e, and its first two derivatives over R1 and R1^2, scaled.

    ``R1 phi1 - e(phi1) = u + R2 phi2`` is solved by Newton's method: e is small against R1.

    Returns
    -------
    angle, e, e1, e2 : float
        phi1 [rad], ``e / sigma``, ``e' / R1`` and ``e'' sigma / R1^2``.
    """
    radius = d[at.PINION_RADIUS] / d[at.SIGMA]
    turns = (d[at.TURNS] % d[at.PINION_TEETH] + phase) / d[at.PINION_TEETH]
    rigid = 2.0 * math.pi * turns + u / radius
    angle = rigid
    e = e1 = e2 = 0.0
    count = int(d[at.ERROR_ORDERS])
    first = int(d[at.ERROR_AT])
    for _ in range(4 if count else 0):
        e = e1 = e2 = 0.0
        for k in range(count):
            order, amplitude, shift = d[first + 3 * k], d[first + 3 * k + 1], d[first + 3 * k + 2]
            c = amplitude * math.cos(order * angle + shift)
            s = amplitude * math.sin(order * angle + shift)
            e += c
            e1 -= order * s / radius
            e2 -= order * order * c / (radius * radius)
        step = (angle - rigid - e / radius) / (1.0 - e1)
        angle -= step
    return angle, e, e1, e2
