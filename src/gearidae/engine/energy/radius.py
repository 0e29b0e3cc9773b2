r"""The changing radius of curvature along the path of contact, and the power or the force that goes with it.

The length of a contact, and with it the number of asperities in touch, changes along the path. In the paper's model no
force pays for that; see `gearidae.engine.followers.balance`, which books the power. With ``mesh.radius_force`` a force
does: a pair of length :math:`\ell` with the energy U per length pushes the gear along its motion :math:`x_2` with

.. math:: -U \frac{d\ell}{dx_2} \quad \left( = -\ell U \frac{R'}{2R} \right)

at fixed gap. As the phase of the mesh is the gear's, the pinion has no part in it. U is zero at detachment.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.elastic.energy import nodes_joining_loss, nodes_length_force
from gearidae.engine.energy.contacts import free_energy, joined_energy
from gearidae.engine.energy.coverage import coverage_force, coverage_power
from gearidae.engine.model.state import PHASE, Floats, Model, U, V, W
from gearidae.engine.pairs.coverage import WHOLE, potentials_of
from gearidae.engine.pairs.lengths import length_and_rates
from gearidae.engine.pairs.tooth_pairs import history_of, pairs_on_path

__all__ = ["radius_force", "radius_power"]


@compiled
def radius_power(m: Model, t: float, y: Floats, w_rate: float) -> tuple[float, float]:
    """Power of the changing radius, what length adds to a pair's energy times the length's rate, and its own rate."""
    power = rate = 0.0
    if m.scene.radius_force != 0:  # it is the work of a force then, which motion and contacts exchange
        return power, rate
    elastic = m.scene.nodes > 0
    for coast in range(2):
        if m.state.near[coast] == 0:
            continue
        sign = 1.0 - 2.0 * coast
        gap = m.scene.half_backlash - sign * y[U]
        if gap >= m.scene.cutoff:
            continue
        if m.scene.by_place != 0:
            more, change = _power_by_place(m, coast, gap, t, y, w_rate)
            power += more
            rate += change
            continue
        potential, push = loading_value(m.tables, m.scene.potential_at, gap)
        first, last = pairs_on_path(m, coast)
        for pair in range(first, last + 1):
            k = history_of(m, coast, pair)
            if m.state.history[k].pair != pair:
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
def _power_by_place(
    m: Model, coast: int, gap: float, t: float, y: Floats, w_rate: float
) -> tuple[float, float]:
    """Do the same for a flank whose shares of the materials change along the path."""
    power = rate = 0.0
    potentials = potentials_of(m, gap)
    first, last = pairs_on_path(m, coast)
    for pair in range(first, last + 1):
        if m.state.history[history_of(m, coast, pair)].pair == pair:
            more, change = coverage_power(m, potentials, coast, pair, t, y, w_rate)
            power += more
            rate += change
    return power, rate


@compiled
def radius_force(
    m: Model, t: float, y: Floats, coast: int, pair: int, k: int, gap: float, rate: float
) -> tuple[float, float, float]:
    """Force on the gear that pays for the changing length of a pair's contact, with its slopes.

    Parameters
    ----------
    m : Model
    t : float
        Time over tau.
    y : ndarray
        State.
    coast, pair : int
        Flank and number of the pair.
    k : int
        Index of its history, if that is about this pair.
    gap, rate : float
        The pair's gap and gap rate.

    Returns
    -------
    force, force_u, force_phase : float
        Along the gear's motion, and its partial derivatives in u and phase; of an elastic contact the first is left
        out, which only steers Newton's iteration.
    """
    first, last = pairs_on_path(m, coast)
    if not first <= pair <= last:
        return 0.0, 0.0, 0.0
    sign = 1.0 - 2.0 * coast
    if m.scene.by_place != 0:
        return coverage_force(m, t, y, coast, pair, k, gap, rate)
    length, stretch, bend = length_and_rates(m, coast, pair, y[PHASE], 1.0, 0.0)
    slope, known = 0.0, m.state.history[k].pair == pair
    if m.scene.nodes == 0:
        energy, slope = free_energy(m, k, known, t, gap, rate)
    elif known:
        energy = nodes_length_force(m, k, t, y, gap, rate, length)[0] - nodes_joining_loss(m, k, y, gap)
    else:
        energy = 0.0  # it has just come within reach
    return -energy * stretch, sign * slope * stretch, -energy * bend / m.scene.phase_rate
