"""Adhesion loss of asperities at contact onset, added at the turning point of a closing contact."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.elastic.calls import nodes_joining_loss
from gearidae.engine.energy.contacts import joining_loss
from gearidae.engine.energy.radius import length_and_rates, pairs_on_path
from gearidae.engine.model.state import GEARS, PHASE, Floats, Model, U, V, W
from gearidae.engine.model.tooth_pairs import contact_length, pair_gap

__all__ = ["book_joining"]


@compiled
def book_joining(m: Model, y: Floats, coast: int, pair: int, k: int, gap: float) -> None:
    """Add the adhesion loss of a pair's asperities, before the turning point of a closing contact is noted."""
    length = 1.0
    if m.scene.kind == GEARS:
        length = contact_length(m, pair_gap(m, coast, pair, y[U], y[V], y[PHASE], y[W])[3])
    if m.scene.nodes > 0:
        m.state.energy.adhesion_loss += length * nodes_joining_loss(m, k, y, gap)
        return
    loss = joining_loss(m, k, gap)
    m.state.energy.adhesion_loss += length * loss
    if m.scene.kind == GEARS:
        _book_before(m, coast, pair, loss, length)


@compiled
def _book_before(m: Model, coast: int, pair: int, loss: float, length: float) -> None:
    """Keep the power of the changing radius continuous where an adhesion loss per length has been added.

    From then on it lacks the loss times the rate of the length. It is taken out where the quadrature began, too, and
    what that leaves out until now is the loss times what the length has changed by.
    """
    first, last = pairs_on_path(m, coast)
    if m.state.near[coast] == 0 or not first <= pair <= last:
        return
    q = m.work.quadrature
    before = q.gear_travel * m.scene.phase_rate
    was, rate, bend = length_and_rates(m, coast, pair, before, q.gear_speed, q.gear_acceleration)
    q.radius_power -= loss * rate
    q.radius_power_rate -= loss * bend
    q.booked += loss * (length - was)
