r"""Power, force and losses of pairs whose materials' shares change along the path of contact.

As the contact length does, shares change the energy of a pair without a force that pays for it: the work of this
change is counted with that of the changing radius (`gearidae.engine.followers.balance`), and what joining loses is the
integral of each material's length times share, as there. A pair with the energy U per length of each material, its
length times share :math:`\ell s`, and with :math:`\ell B` of its bodies, changes it by
:math:`\sum U\,d(\ell s) + B\,d\ell`.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.contact.kernels.evaluate import three_values
from gearidae.engine.elastic.energy import nodes_length_force, nodes_material_energy, nodes_material_loss
from gearidae.engine.energy.contacts import free_material_energy, material_energy, turning_point
from gearidae.engine.model.state import MATERIALS, PHASE, Floats, Model, U, V, W
from gearidae.engine.pairs.coverage import Shares, note_shares, path_position, potentials_of, shares_of
from gearidae.engine.pairs.lengths import length_and_rates, material_lengths
from gearidae.engine.pairs.tooth_pairs import history_of

__all__ = ["coverage_force", "coverage_power", "losses_by_material"]


@compiled(inline=True)
def coverage_power(
    m: Model, potentials: tuple[Shares, Shares], coast: int, pair: int, t: float, y: Floats, w_rate: float
) -> tuple[float, float]:
    """Power of the changing lengths of a pair's materials, and its own rate.

    Parameters
    ----------
    m : Model
    potentials : tuple
        Of the materials at the pair's gap, from `gearidae.engine.pairs.coverage.potentials_of`.
    coast, pair : int
        Flank and number of the pair, which is on the path of contact.
    t : float
        Time over tau.
    y : ndarray
        State.
    w_rate : float
        Acceleration of the gear's surface.
    """
    sign, k = 1.0 - 2.0 * coast, history_of(m, coast, pair)
    gap, opening = m.scene.half_backlash - sign * y[U], -sign * y[V]
    _, rates, bends = material_lengths(m, k, coast, pair, y[PHASE], y[W], w_rate)
    power = change = 0.0
    if m.scene.nodes > 0:
        bodies, slope = _bodies(m, k, coast, pair, gap, opening, t, y)
        _, rate, bend = length_and_rates(m, coast, pair, y[PHASE], y[W], w_rate)
        power, change = bodies * rate, slope * rate + bodies * bend
    for material in range(MATERIALS):
        if rates[material] == 0.0 and bends[material] == 0.0:
            continue
        if m.scene.nodes > 0:
            energy, slope = nodes_material_energy(m, k, y, gap, opening, material)
        else:
            energy, slope = potentials[0][material], potentials[1][material]
            if m.scene.material[material].stretch_limit != 0.0:
                more, rise = material_energy(m, k, gap, material)
                energy += m.scene.material[material].force_scale * more
                slope += m.scene.material[material].force_scale * rise
            slope *= opening
        power += energy * rates[material]
        change += energy * bends[material] + slope * rates[material]
    return power, change


@compiled
def coverage_force(
    m: Model, t: float, y: Floats, coast: int, pair: int, k: int, gap: float, rate: float
) -> tuple[float, float, float]:
    """Force that pays for these changes, see `gearidae.engine.energy.radius.radius_force`."""
    force = force_u = force_phase = 0.0
    known = m.state.history[k].pair == pair
    _, stretches, bends = material_lengths(m, k, coast, pair, y[PHASE], 1.0, 0.0)
    if m.scene.nodes > 0:
        if not known:  # it has just come within reach
            return 0.0, 0.0, 0.0
        bodies = _bodies(m, k, coast, pair, gap, rate, t, y)[0]
        _, stretch, bend = length_and_rates(m, coast, pair, y[PHASE], 1.0, 0.0)
        force, force_phase = -bodies * stretch, -bodies * bend / m.scene.phase_rate
    potentials, pushes = potentials_of(m, gap)
    turning_gap = turning_point(m, k, known, t, gap, rate)
    for material in range(MATERIALS):
        if stretches[material] == 0.0 and bends[material] == 0.0:
            continue
        if m.scene.nodes > 0:
            energy, slope = nodes_material_energy(m, k, y, gap, rate, material)[0], 0.0
            energy -= nodes_material_loss(m, k, y, gap, material)
        else:
            energy, slope = free_material_energy(m, k, known, gap, turning_gap, material)
            energy += potentials[material]
            slope += pushes[material]
        force -= energy * stretches[material]
        force_u += (1.0 - 2.0 * coast) * slope * stretches[material]
        force_phase -= energy * bends[material] / m.scene.phase_rate
    return force, force_u, force_phase


@compiled
def _bodies(
    m: Model, k: int, coast: int, pair: int, gap: float, rate: float, t: float, y: Floats
) -> tuple[float, float]:
    """What a longer contact of elastic bodies stores besides that of its asperities per length, and its rate."""
    inside = path_position(m, coast, pair, y[PHASE])
    note_shares(m, k, coast, pair, inside)
    length = length_and_rates(m, coast, pair, y[PHASE], 0.0, 0.0)[0]
    stored, change = nodes_length_force(m, k, t, y, gap, rate, length)
    shares = shares_of(m, k, coast, pair, inside)
    for material in range(MATERIALS):
        energy, slope = nodes_material_energy(m, k, y, gap, rate, material)
        stored -= shares[material] * energy
        change -= shares[material] * slope
    return stored, change


@compiled
def losses_by_material(m: Model, k: int, y: Floats, gap: float) -> tuple[Shares, Shares]:
    """What each material of a pair has lost per length by joining since the last turning point, and its slopes.

    Of an elastic contact the slopes are those of a rigid one in proportion.
    """
    joined = m.state.history[k].joined
    if m.scene.nodes == 0 and gap >= max(joined[0], joined[1], joined[2]):
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    numbers, slopes = three_values(m.tables, m.scene.numbers_at, gap)
    bare, bare_slope = _loss(m, k, y, gap, 0, numbers[0], slopes[0])
    coated, coated_slope = _loss(m, k, y, gap, 1, numbers[1], slopes[1])
    mixed, mixed_slope = _loss(m, k, y, gap, 2, numbers[2], slopes[2])
    return (bare, coated, mixed), (bare_slope, coated_slope, mixed_slope)


@compiled(inline=True)
def _loss(
    m: Model, k: int, y: Floats, gap: float, material: int, number: float, slope: float
) -> tuple[float, float]:
    """Do the same for one material, of whose asperities a number is above the gap."""
    own, h = m.scene.material[material], m.state.history[k]
    if own.stretch_limit == 0.0 or (m.scene.nodes == 0 and gap >= h.joined[material]):
        return 0.0, 0.0
    if m.scene.nodes > 0:
        loss = nodes_material_loss(m, k, y, gap, material)
        return loss, (loss * slope / number if number > 0.0 else 0.0)
    scale = own.force_scale
    return (
        scale * (own.joining_energy * number + h.adhered_energy[material]),
        scale * own.joining_energy * slope,
    )
