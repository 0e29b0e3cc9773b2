r"""The changing radius of curvature along the path of contact, and the power or the force that goes with it.

The length of a contact, and with it the number of asperities in touch, changes along the path, and shares of the
materials that change with tooth and place change it as well. In the paper's model no force pays for that; see
`gearidae.engine.followers.balance`, which books the power. With ``mesh.radius_force`` a force does: a pair with the
length :math:`\ell s_m` of each material, of the energy :math:`U_m` per length, pushes the gear along its motion
:math:`x_2` with

.. math:: -\sum_m U_m \frac{d(\ell s_m)}{dx_2} \quad \left( = -\ell U \frac{R'}{2R} \text{ where shares stay} \right)

at fixed gap. As the phase of the mesh is the gear's, the pinion has no part in it. U is zero at detachment. What
elastic bodies store besides, B per length, adds :math:`-B\,d\ell/dx_2`.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.elastic.energy import nodes_energies, nodes_length_force, nodes_losses
from gearidae.engine.energy.contacts import free_energies, stored_energies
from gearidae.engine.model.state import PHASE, Floats, Model, U, V, W
from gearidae.engine.pairs.coverage import NONE, Shares, note_shares, noted_shares, path_position, weighed
from gearidae.engine.pairs.lengths import length_and_rates, weighed_length
from gearidae.engine.pairs.tooth_pairs import history_of, pairs_on_path


@compiled
def radius_power(m: Model, t: float, y: Floats, w_rate: float) -> tuple[float, float]:
    """Power of the changing radius, what length adds to a pair's energy times the length's rate, and its own rate."""
    power = rate = 0.0
    if m.scene.radius_force != 0:  # it is the work of a force then, which motion and contacts exchange
        return power, rate
    for coast in range(2):
        gap = m.scene.half_backlash - (1.0 - 2.0 * coast) * y[U]
        if m.state.near[coast] == 0 or gap >= m.scene.cutoff:
            continue
        first, last = pairs_on_path(m, coast)
        for pair in range(first, last + 1):
            k = history_of(m, coast, pair)
            if m.state.history[k].pair == pair:
                more, change = _pair_power(m, coast, pair, k, gap, t, y, w_rate)
                power += more
                rate += change
    return power, rate


@compiled
def _pair_power(
    m: Model, coast: int, pair: int, k: int, gap: float, t: float, y: Floats, w_rate: float
) -> tuple[float, float]:
    """Power of the changing lengths of a pair's materials and bodies, and its own rate."""
    phase, w, opening = y[PHASE], y[W], -(1.0 - 2.0 * coast) * y[V]
    bodies = bodies_rate = 0.0
    length, stretch, bend = length_and_rates(m, coast, pair, phase, w, w_rate)
    if m.scene.nodes > 0:
        bodies, bodies_rate, energies, slopes = _elastic(m, coast, pair, k, gap, opening, t, y, length)
    else:
        energies, slopes = stored_energies(m, k, gap)
    own = weighed_length(m, (coast, pair, phase), w, w_rate, energies, slopes)
    rate = bodies_rate * stretch + bodies * bend + own.bend + opening * own.by_gap
    return bodies * stretch + own.rate, rate


@compiled
def _elastic(
    m: Model, coast: int, pair: int, k: int, gap: float, rate: float, t: float, y: Floats, length: float
) -> tuple[float, float, Shares, Shares]:
    """Energy of an elastic contact per length: of its bodies with its rate, and of its materials with slopes.

    Where shares do not change, all of it is said to be of the bodies, as nothing but the length matters.
    """
    note_shares(m, k, coast, pair, path_position(m, coast, pair, y[PHASE]))
    bodies, change = nodes_length_force(m, k, t, y, gap, rate, length)
    if m.scene.by_place == 0:
        return bodies, change, NONE, NONE
    energies, slopes = nodes_energies(m, k, y, gap)
    shares = noted_shares(m, k)
    return bodies - weighed(shares, energies), change - rate * weighed(shares, slopes), energies, slopes


@compiled
def radius_force(
    m: Model, t: float, y: Floats, coast: int, pair: int, k: int, gap: float, rate: float
) -> tuple[float, float, float]:
    """Force on the gear that pays for the changing length of a pair's contact, with its slopes.

    Parameters
    ----------
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
    known, phase = m.state.history[k].pair == pair, y[PHASE]
    if not first <= pair <= last or (m.scene.nodes > 0 and not known):  # it has just come within reach
        return 0.0, 0.0, 0.0
    bodies, slopes = 0.0, NONE
    length, stretch, bend = length_and_rates(m, coast, pair, phase, 1.0, 0.0)
    if m.scene.nodes > 0:
        bodies, _, (a, b, c), _ = _elastic(m, coast, pair, k, gap, rate, t, y, length)
        a1, b1, c1 = nodes_losses(m, k, y, gap)
        energies = (a - a1, b - b1, c - c1)
    else:
        energies, slopes = free_energies(m, k, known, t, gap, rate)
    own = weighed_length(m, (coast, pair, phase), 1.0, 0.0, energies, slopes)
    force, change = -(bodies * stretch + own.rate), -(bodies * bend + own.bend)
    return force, (1.0 - 2.0 * coast) * own.by_gap, change / m.scene.phase_rate
