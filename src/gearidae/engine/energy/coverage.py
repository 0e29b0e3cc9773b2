"""Power and losses of pairs whose materials' shares change along the path of contact.

As the contact length does, shares change the energy of a pair without a force that pays for it: the work of this
change is counted with that of the changing radius (`gearidae.engine.energy.balance`), and what joining loses is the
integral of each material's length times share, as there.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.energy.contacts import joined_energy
from gearidae.engine.energy.lengths import material_lengths
from gearidae.engine.model.coverage import Shares
from gearidae.engine.model.state import MATERIALS, PHASE, Floats, Model, V, W

__all__ = ["coverage_power", "losses_by_material", "only"]


@compiled
def only(material: int) -> Shares:
    """Shares of a surface of one material."""
    return 1.0 if material == 0 else 0.0, 1.0 if material == 1 else 0.0, 1.0 if material == 2 else 0.0


@compiled
def coverage_power(
    m: Model, k: int, coast: int, pair: int, gap: float, y: Floats, w_rate: float
) -> tuple[float, float]:
    """Power of the changing lengths of a pair's materials, and its own rate.

    Parameters
    ----------
    m : Model
    k : int
        Index of the pair's history.
    coast, pair : int
        Flank and number of the pair, which is on the path of contact.
    gap : float
        Its gap.
    y : ndarray
        State.
    w_rate : float
        Acceleration of the gear's surface.
    """
    power = change = 0.0
    closing = (1.0 - 2.0 * coast) * y[V]
    _, rates, bends = material_lengths(m, coast, pair, y[PHASE], y[W], w_rate)
    for material in range(MATERIALS):
        if rates[material] == 0.0 and bends[material] == 0.0:
            continue
        potential, push = loading_value(m.tables, m.scene.material[material].potential_at, gap)
        energy, slope = joined_energy(m, k, gap, only(material))
        pull = potential + energy
        power += pull * rates[material]
        change += pull * bends[material] - (slope + push) * closing * rates[material]
    return power, change


@compiled
def losses_by_material(m: Model, k: int, gap: float) -> tuple[Shares, Shares]:
    """What each material of a pair has lost per length by joining since the last turning point, and its slopes."""
    h = m.state.history[k]
    bare = coated = mixed = 0.0
    bare_slope = coated_slope = mixed_slope = 0.0
    for material in range(MATERIALS):
        own = m.scene.material[material]
        if own.stretch_limit == 0.0 or gap >= h.joined[material]:
            continue
        number, slope = loading_value(m.tables, own.number_at, gap + own.gap_offset)
        loss = own.force_scale * (own.joining_energy * number + h.adhered_energy[material])
        change = own.force_scale * own.joining_energy * slope
        if material == 0:
            bare, bare_slope = loss, change
        elif material == 1:
            coated, coated_slope = loss, change
        else:
            mixed, mixed_slope = loss, change
    return (bare, coated, mixed), (bare_slope, coated_slope, mixed_slope)
