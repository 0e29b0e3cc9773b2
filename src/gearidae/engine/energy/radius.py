r"""The changing radius of curvature along the path of contact, and the power or the force that goes with it.

The length of a contact, and with it the number of asperities in touch, changes along the path, and shares of the
materials that change with tooth and place change it as well. In the paper's model no force pays for that; see
`gearidae.engine.observers.balance`, which books the power. With ``mesh.radius_force`` a force does: a pair with the
length :math:`\ell s_m` of each material, of the energy :math:`U_m` per length, pushes the gear along its motion
:math:`x_2` with

.. math:: -\sum_m U_m \frac{d(\ell s_m)}{dx_2} \quad \left( = -\ell U \frac{R'}{2R} \text{ where shares stay} \right)

at fixed gap. As the phase of the mesh is the gear's, the pinion has no part in it. U is zero at detachment. What
elastic bodies store besides, B per length, adds :math:`-B\,d\ell/dx_2`.
"""

from __future__ import annotations

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.elastic.energy import nodes_energies, nodes_length_force, nodes_losses
from gearidae.engine.energy.contacts import free_energies, stored_energies
from gearidae.engine.model.state import PHASE, Floats, Model, V, W
from gearidae.engine.pairs.coverage import (
    NONE,
    Shares,
    attraction_energies,
    note_shares,
    noted_shares,
    path_position,
    weighed,
)
from gearidae.engine.pairs.lengths import length_and_rates, slopes_along_path, weighed_length
from gearidae.engine.pairs.pair_force import NO_PAIR_FORCE, PairForce, of_path
from gearidae.engine.pairs.tooth_pairs import PairState, flank_of_history, is_on_path, list_known, path_gap


@compiled
def radius_power(m: Model, t: float, y: Floats, w_rate: float) -> tuple[float, float]:
    """Power of the changing radius, what length adds to a pair's energy times the length's rate, and its own rate."""
    power = rate = 0.0
    if m.scene.curvature_force != 0:  # it is the work of a force then, which motion and contacts exchange
        return power, rate
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        coast, pair = flank_of_history(m, k), m.state.history[k].pair
        gap = path_gap(m, coast, pair, y)
        if gap < m.scene.cutoff and is_on_path(m, coast, pair):
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
    energy = weighed_length(m, (coast, pair, phase), w, w_rate, energies, slopes)
    power = bodies * stretch + energy.rate
    rate = bodies_rate * stretch + bodies * bend + energy.bend + opening * energy.by_gap
    if m.scene.attracts != 0:
        energies, slopes = attraction_energies(m, gap)
        energy = weighed_length(m, (coast, pair, phase), w, w_rate, energies, slopes)
        power += energy.rate
        rate += energy.bend + opening * energy.by_gap
    return power, rate


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


@compiled_once(SOLVER)
def curvature_force(m: Model, t: float, y: Floats, pair: PairState) -> PairForce:
    """Force along the path of contact that pays for the changing length of a pair's contact.

    Of an elastic contact its slope in the gap is left out, which only steers Newton's iteration.

    Parameters
    ----------
    t : float
        Time over tau.
    y : ndarray
        State.
    pair : PairState
        The pair there.
    """
    if not is_on_path(m, pair.coast, pair.number) or (
        m.scene.nodes > 0 and not pair.known
    ):  # just within reach
        return NO_PAIR_FORCE
    coast, number, k = pair.coast, pair.number, pair.k
    bodies = stretch = bend = 0.0
    slopes = NONE
    if m.scene.nodes > 0:
        pitch = (1.0 - 2.0 * coast) / m.scene.phase_rate
        length, stretch, bend = length_and_rates(m, coast, number, y[PHASE], pitch, 0.0)
        bodies, _, (a, b, c), _ = _elastic(m, coast, number, k, pair.gap, pair.rate, t, y, length)
        a1, b1, c1 = nodes_losses(m, k, y, pair.gap)
        energies = (a - a1, b - b1, c - c1)
    else:
        energies, slopes = free_energies(m, k, pair.known, t, pair.gap, pair.rate)
    along, by_gap, by_place = slopes_along_path(m, coast, number, y[PHASE], energies, slopes)
    return of_path(-(bodies * stretch + along), -by_gap, -(bodies * bend + by_place))
