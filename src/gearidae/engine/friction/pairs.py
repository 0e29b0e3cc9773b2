"""Sliding of a tooth pair, and the limit of its friction.

A pair touches at the distances r1 and r2 from the points where the line of action touches the base circles. Along the
flanks the pinion slides over the gear at ``v = r1 w1 - r2 w2``, on both flanks of a tooth with r1 and r2 of the own
pair. With surface velocities of the base circles, ``surface_speed = R1 w1`` and ``w = R2 w2``, that is
``(r1/R1) surface_speed - (r2/R2) w``: the two ratios are the pair's levers, by which friction acts on the shafts, too.
"""

from __future__ import annotations

from typing import Final

from gearidae.compiled import compiled
from gearidae.engine.laws.statistical import limit_of_materials
from gearidae.engine.model.record_types import STUCK
from gearidae.engine.model.state import COAST, Model, Record
from gearidae.engine.pairs.coverage import rubs_by_material
from gearidae.engine.pairs.orbit import acceleration_of_gap
from gearidae.engine.pairs.tooth_pairs import flank_of_history

RUBS: Final = 1e-8
"""Of the reference load: friction with a smaller limit is none, and has no direction to watch."""


@compiled(inline=True)
def levers(m: Model, inside: float) -> tuple[float, float]:
    """Levers r1/R1 and r2/R2 of a pair at a place along the path of contact."""
    friction, radius = m.scene.friction, m.scene.start_radius + inside
    return friction.pinion_lever * radius, friction.gear_lever * (friction.radii - radius)


@compiled(inline=True)
def lever_rate(m: Model, noted: Record, surface_speed: float, w: float) -> float:
    """Rate of the sliding speed of a pair whose shafts keep their speeds: the levers change along the path."""
    if not 0.0 < noted.position < m.scene.contact_ratio:
        return 0.0
    rate = w * (m.scene.friction.pinion_lever_slope * surface_speed + m.scene.friction.gear_lever_slope * w)
    return -rate if flank_of_history(m, noted.history) == COAST else rate


@compiled(inline=True)
def direction(m: Model, noted: Record) -> float:
    """Direction in which a pair slides, -1 or 1; 0 while it rolls or nothing rubs."""
    h = m.state.history[noted.history]
    return 0.0 if h.slide == STUCK or h.pair != noted.pair else float(h.slide)


@compiled(inline=True)
def set_limits(m: Model, t: float, w: float) -> None:
    """Set the limits of friction of all pairs whose forces have been noted, with their rates; see `levers`.

    Real asperities, and nodes of different coefficients, have noted their own.

    Parameters
    ----------
    t : float
        Time of the notes, over tau.
    w : float
        Surface velocity of the gear, which carries a pair along the path of contact.
    """
    friction = m.scene.friction
    for i in range(m.work.pair_forces.count):
        noted = m.work.pair_forces.pair[i]
        if m.scene.population.flanks != 0:
            noted.force_rate = noted.slope * noted.gap_rate + noted.drift
            continue
        longer = _length_rate(m, noted, w)
        # a film is as long as the tooth is wide, whatever the contact is
        by_length = noted.force - noted.damping * noted.gap_rate
        noted.force_rate = noted.slope * noted.gap_rate + longer * by_length
        if not rubs_by_material(m):
            noted.limit, noted.limit_slope = (
                friction.even * noted.contact,
                friction.even * noted.contact_slope,
            )
        elif m.scene.nodes == 0:
            noted.limit, noted.limit_slope = limit_of_materials(m, t, i)
        noted.limit_rate = noted.limit_slope * noted.gap_rate + longer * noted.limit


@compiled(inline=True)
def rate_of_force(m: Model, noted: Record, w: float, v_rate: float, w_rate: float) -> float:
    """Rate of a noted force along the motion, with what the acceleration of its gap changes, as in a film.

    Accelerations are those of u and of the gear's surface, `w` is the surface velocity of the gear.
    """
    flank = flank_of_history(m, noted.history)
    gap_acceleration = acceleration_of_gap(m, flank, noted.relief, w, v_rate, w_rate)
    return float(noted.force_rate + noted.damping * gap_acceleration)


@compiled(inline=True)
def _length_rate(m: Model, noted: Record, w: float) -> float:
    """Rate of the contact length of a pair, over that length."""
    if not 0.0 < noted.position < m.scene.contact_ratio:
        return 0.0
    radius = m.scene.start_radius + noted.position
    radius_share = radius * m.scene.sum_curvature
    rate = 0.5 * (1.0 - 2.0 * radius_share) / (radius * (1.0 - radius_share)) * m.scene.phase_rate * w
    return -rate if flank_of_history(m, noted.history) == COAST else rate
