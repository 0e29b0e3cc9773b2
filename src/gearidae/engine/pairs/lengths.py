"""Contact length of a pair and of each of its materials along the path of contact, with their rates.

A pair on a contact of length l stores l times the sum of its materials' energies by their shares s: what changes along
the path is l s of each material, all of it l where the shares do not change.
"""

from __future__ import annotations

import math

from gearidae.compiled import compiled
from gearidae.engine.model.state import Model
from gearidae.engine.pairs.coverage import Shares, path_position, share_changes

__all__ = ["length_and_rates", "material_lengths"]

SHORTEST_SQ = 1e-12
"""Least square of a contact length: a step that is tried may lead beyond the path, to where there is none."""


@compiled
def length_and_rates(
    m: Model, coast: int, pair: int, phase: float, w: float, w_rate: float
) -> tuple[float, float, float]:
    """Contact length of a pair on the path of contact, its rate and the rate of that."""
    sign = m.scene.phase_rate * (1.0 - 2.0 * coast)
    curvature = m.scene.sum_curvature
    # l^2 = r - c r^2 with r the pinion's radius of curvature
    radius = m.scene.start_radius + (m.scene.coast_phase + pair - phase if coast else phase - pair)
    length = math.sqrt(max(radius - radius * radius * curvature, SHORTEST_SQ))
    half = 0.5 - radius * curvature
    along = sign * w
    rate = half * along / length
    return length, rate, (half * sign * w_rate - curvature * along * along - rate * rate) / length


@compiled
def material_lengths(
    m: Model, k: int, coast: int, pair: int, phase: float, w: float, w_rate: float
) -> tuple[Shares, Shares, Shares]:
    """Contact length times share of each material of a pair on the path of contact, with two derivatives in time."""
    length, rate, bend = length_and_rates(m, coast, pair, phase, w, w_rate)
    along = m.scene.phase_rate * (1.0 - 2.0 * coast)
    speed, speed_rate = along * w, along * w_rate
    inside = path_position(m, coast, pair, phase)
    (a, b, c), (a1, b1, c1), (a2, b2, c2) = share_changes(m, k, coast, pair, inside)
    # a' = da/dx v and a'' = d2a/dx2 v^2 + da/dx v', with x the place and v its rate
    twice, square, both = 2.0 * rate * speed, length * speed * speed, length * speed_rate
    return (
        (length * a, length * b, length * c),
        (
            rate * a + length * speed * a1,
            rate * b + length * speed * b1,
            rate * c + length * speed * c1,
        ),
        (
            bend * a + (twice + both) * a1 + square * a2,
            bend * b + (twice + both) * b1 + square * b2,
            bend * c + (twice + both) * c1 + square * c2,
        ),
    )
