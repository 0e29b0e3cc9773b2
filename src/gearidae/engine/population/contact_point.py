r"""Where a pair touches: arc on the pinion's flank, radius and their changes along the path of contact.

With positions :math:`\xi` along the path, arcs s and radii R in base pitches (of a roller in its radius), heights and
gaps in roughnesses, an asperity at the arc s and of the height z overlaps by

.. math:: \delta = z - g - k\,\frac{x^2}{2R}, \qquad x = s - s_1, \qquad s_1 = \frac{\pi}{z_1} r_1^2

with k a base pitch over the roughness. Along the path it changes at fixed gap by
:math:`D = k (x s_1'/R + x^2 R'/(2 R^2))`; where a pair is beyond the path its contact stays at the end of the flank.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gearidae.compiled import compiled
from gearidae.engine.model.state import PHASE, Floats, Model, W
from gearidae.engine.pairs.tooth_pairs import PairState, flank_of_history, is_on_path, on_path, pair_state


class Spot(NamedTuple):
    """Where a pair touches.

    Attributes
    ----------
    arc, arc_rate, arc_second_rate : float
        s1 and its derivatives along the path.
    radius, radius_rate, radius_second_rate : float
        R, likewise.
    """

    arc: float
    arc_rate: float
    arc_second_rate: float
    radius: float
    radius_rate: float
    radius_second_rate: float


@compiled(inline=True)
def pair_now(m: Model, flank: int, number: int, y: Floats) -> PairState:
    """Return a pair at a state.

    The last two mesh marks tell whether it is on the path, so that a step that ends at a mark sees the side it comes
    from, beyond which its position is not clipped.
    """
    pair = pair_state(m, flank, number, y)
    if not is_on_path(m, flank, number):
        return on_path(pair, pair.position, 0.0, False)
    along = m.scene.coast_phase + number - y[PHASE] if flank else y[PHASE] - number
    rate = (1.0 - 2.0 * flank) * m.scene.phase_rate * y[W]
    return on_path(pair, along, rate, True)


@compiled(inline=True)
def pair_of(m: Model, k: int, y: Floats) -> PairState:
    """Return the pair that the k-th history is about, at a state."""
    return pair_now(m, flank_of_history(m, k), m.state.history[k].pair, y)


@compiled(inline=True)
def state_of_pair(m: Model, flank: int, number: int, y: Floats) -> PairState:
    """Return a pair at a state, as the law of its contacts wants it."""
    if m.scene.population.flanks != 0:
        return pair_now(m, flank, number, y)
    return pair_state(m, flank, number, y)


@compiled(inline=True)
def spot_at(m: Model, position: float, moves: bool) -> Spot:
    """Where a pair touches at a position along the path; `moves` says whether it would change along it."""
    scale, curvature = m.scene.population.arc_scale, m.scene.sum_curvature
    pinion = m.scene.start_radius + position
    arc, radius = scale * pinion * pinion, pinion - pinion * pinion * curvature
    if not moves:
        return Spot(arc, 0.0, 0.0, radius, 0.0, 0.0)
    return Spot(
        arc, 2.0 * scale * pinion, 2.0 * scale, radius, 1.0 - 2.0 * pinion * curvature, -2.0 * curvature
    )


@compiled
def position_of_arc(m: Model, arc: float) -> float:
    """Position along the path of contact, clipped to it, at which a pair touches at an arc."""
    along = math.sqrt(max(arc, 0.0) / m.scene.population.arc_scale) - m.scene.start_radius
    return min(max(along, 0.0), m.scene.contact_ratio)


@compiled(inline=True)
def overlap_slopes(m: Model, at: Spot, x: float) -> tuple[float, float]:
    """D of an asperity at a distance x from where its pair touches, and its derivative along the path."""
    share, stretch = x / at.radius, at.radius_rate / at.radius
    first = share * at.arc_rate + 0.5 * share * share * at.radius_rate
    second = (
        share * (at.arc_second_rate - 2.0 * at.arc_rate * stretch)
        - at.arc_rate * at.arc_rate / at.radius
        + share * share * (0.5 * at.radius_second_rate - at.radius_rate * stretch)
    )
    return m.scene.population.steepness * first, m.scene.population.steepness * second
