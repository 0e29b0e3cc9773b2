"""The changing radius of curvature along the path of contact, and the power that goes with it.

The length of a contact, and with it the number of asperities in touch, changes along the path without a force that
pays for it; see `gearidae.engine.energy.balance`.
"""

from __future__ import annotations

import math

from gearidae.compiled import compiled
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.elastic.calls import nodes_length_force
from gearidae.engine.energy.contacts import joined_energy
from gearidae.engine.energy.coverage import coverage_power
from gearidae.engine.energy.lengths import length_and_rates
from gearidae.engine.model.coverage import WHOLE
from gearidae.engine.model.state import PHASE, Floats, Model, U, V, W
from gearidae.engine.model.tooth_pairs import history_of

__all__ = ["pairs_on_path", "radius_power", "sample_radius_power"]


@compiled
def sample_radius_power(m: Model, t: float, y: Floats) -> None:
    """Look again at the power of the changing radius, which jumps at a mesh mark.

    For an elastic contact it also jumps where an adhesion loss is added.
    """
    q = m.work.quadrature
    q.radius_power, q.radius_power_rate = radius_power(m, t, y, q.gear_acceleration)


@compiled
def radius_power(m: Model, t: float, y: Floats, w_rate: float) -> tuple[float, float]:
    """Power of the changing radius, what length adds to a pair's energy times the length's rate, and its own rate."""
    power = rate = 0.0
    elastic = m.scene.nodes > 0
    for coast in range(2):
        if m.state.near[coast] == 0:
            continue
        sign = 1.0 - 2.0 * coast
        gap = m.scene.half_backlash - sign * y[U]
        if gap >= m.scene.cutoff:
            continue
        potential, push = loading_value(m.tables, m.scene.potential_at, gap)
        first, last = pairs_on_path(m, coast)
        for pair in range(first, last + 1):
            k = history_of(m, coast, pair)
            if m.state.history[k].pair != pair:
                continue
            if m.scene.by_place != 0:
                own_power, own_rate = coverage_power(m, k, coast, pair, gap, y, w_rate)
                power += own_power
                rate += own_rate
                continue
            length, length_rate, bend = length_and_rates(m, coast, pair, y[PHASE], y[W], w_rate)
            if elastic:
                pull, change = nodes_length_force(m, k, t, y, gap, -sign * y[V], length)
            else:
                pull, slope = joined_energy(m, k, gap, WHOLE)
                pull += potential
                change = -(slope + push) * sign * y[V]
            power += pull * length_rate
            rate += change * length_rate + pull * bend
    return power, rate


@compiled
def pairs_on_path(m: Model, coast: int) -> tuple[int, int]:
    """First and last number of a flank's pairs on the path of contact.

    The last two mesh marks tell, so that a step that ends at a mark sees the side it comes from.
    """
    between = 0.5 * (m.state.mark_low + m.state.mark_high)
    lowest = between - m.scene.coast_phase if coast else between - m.scene.contact_ratio
    return math.ceil(lowest), math.floor(lowest + m.scene.contact_ratio)
