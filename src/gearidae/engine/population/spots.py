r"""Where a pair touches: arc on the pinion's flank, radius and their changes along the path of contact.

With places :math:`\xi` along the path, arcs s and radii R in base pitches (of a roller in its radius), heights and gaps
in roughnesses, an asperity at the arc s and of the height z overlaps by

.. math:: \delta = z - g - k\,\frac{x^2}{2R}, \qquad x = s - s_1, \qquad s_1 = \frac{\pi}{z_1} r_1^2

with k a base pitch over the roughness. Along the path it changes at fixed gap by
:math:`D = k (x s_1'/R + x^2 R'/(2 R^2))`; where a pair is beyond the path its contact stays at the end of the flank.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gearidae.compiled import compiled
from gearidae.engine.model.state import PHASE, ROLLER, Floats, Model, U, V, W
from gearidae.engine.pairs.tooth_pairs import pair_gap, pairs_on_path


class Spot(NamedTuple):
    """Where a pair touches.

    Attributes
    ----------
    arc, arc_rate, arc_bend : float
        s1 and its derivatives along the path.
    radius, radius_rate, radius_bend : float
        R, likewise.
    """

    arc: float
    arc_rate: float
    arc_bend: float
    radius: float
    radius_rate: float
    radius_bend: float


class Pair(NamedTuple):
    """A pair at a state.

    Attributes
    ----------
    gap, rate : float
        Its gap and gap rate, tip relief included.
    slope : float
        Of the tip relief along the path.
    place, place_rate : float
        Along the path of contact, and its rate; clipped to the path, and 0, beyond it.
    moves : bool
        Whether it is on the path.
    """

    gap: float
    rate: float
    slope: float
    place: float
    place_rate: float
    moves: bool


@compiled(inline=True)
def pair_now(m: Model, coast: int, pair: int, y: Floats) -> Pair:
    """Gap and place of a pair, or of the roller.

    The last two mesh marks tell whether it is on the path, so that a step that ends at a mark sees the side it comes
    from.
    """
    if m.scene.kind == ROLLER:
        return Pair(y[U], y[V], 0.0, 0.0, 0.0, False)
    gap, rate, slope, inside = pair_gap(m, coast, pair, y[U], y[V], y[PHASE], y[W])
    first, last = pairs_on_path(m, coast)
    if not first <= pair <= last:
        return Pair(gap, rate, slope, inside, 0.0, False)
    along = m.scene.coast_phase + pair - y[PHASE] if coast else y[PHASE] - pair
    return Pair(gap, rate, slope, along, (1.0 - 2.0 * coast) * m.scene.phase_rate * y[W], True)


@compiled(inline=True)
def spot_at(m: Model, place: float, moves: bool) -> Spot:
    """Where a pair touches at a place along the path; `moves` says whether it would change along it."""
    if m.scene.kind == ROLLER:
        return Spot(0.0, 0.0, 0.0, 1.0, 0.0, 0.0)
    scale, curvature = m.scene.population.arc_scale, m.scene.sum_curvature
    pinion = m.scene.start_radius + place
    arc, radius = scale * pinion * pinion, pinion - pinion * pinion * curvature
    if not moves:
        return Spot(arc, 0.0, 0.0, radius, 0.0, 0.0)
    return Spot(
        arc, 2.0 * scale * pinion, 2.0 * scale, radius, 1.0 - 2.0 * pinion * curvature, -2.0 * curvature
    )


@compiled
def place_of_arc(m: Model, arc: float) -> float:
    """Place along the path of contact, clipped to it, at which a pair touches at an arc; 0 of a roller."""
    if m.scene.kind == ROLLER:
        return 0.0
    along = math.sqrt(max(arc, 0.0) / m.scene.population.arc_scale) - m.scene.start_radius
    return min(max(along, 0.0), m.scene.contact_ratio)


@compiled(inline=True)
def overlap_slopes(m: Model, at: Spot, x: float) -> tuple[float, float]:
    """D of an asperity at a distance x from where its pair touches, and its derivative along the path."""
    share, stretch = x / at.radius, at.radius_rate / at.radius
    first = share * at.arc_rate + 0.5 * share * share * at.radius_rate
    second = (
        share * (at.arc_bend - 2.0 * at.arc_rate * stretch)
        - at.arc_rate * at.arc_rate / at.radius
        + share * share * (0.5 * at.radius_bend - at.radius_rate * stretch)
    )
    return m.scene.population.steepness * first, m.scene.population.steepness * second
