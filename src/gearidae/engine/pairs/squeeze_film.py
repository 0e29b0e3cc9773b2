r"""Film of gas that two flanks squeeze out: a force against the rate of their gap.

A pair of the gap g has the force :math:`-c(g)\,\dot g` with :math:`c = c_0 (g_0/(g + g_0))^3`, the law of Reynolds'
equation for a film of the height :math:`g + g_0`; below a gap of zero the damping is :math:`c_0`. While a free flank of
the mass m approaches, the rate v of its gap obeys
:math:`m (v - v_a) = (c_0 g_0^3/2) ((g + g_0)^{-2} - (g_a + g_0)^{-2})`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.model.state import PHASE, Floats, Model, U, V, W
from gearidae.engine.pairs.pair_force import PairForce
from gearidae.engine.pairs.tooth_pairs import PairState, pair_at, pair_gap, pairs_felt
from gearidae.formulas.quadrature import Ends, integral_of_square


@compiled(inline=True)
def film_force(m: Model, pair: PairState) -> PairForce:
    """Force of the film of a pair, scaled."""
    height = m.scene.film_gap + max(pair.gap, 0.0)
    damping = m.scene.film_damping * (m.scene.film_gap / height) ** 3
    by_gap = 3.0 * damping * pair.rate / height if pair.gap > 0.0 else 0.0
    return PairForce(-damping * pair.rate, by_gap, -damping, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


# -- its loss --------------------------------------------------------------------------------------------------------


class _Travel(NamedTuple):
    """A variable x whose squared rate is the power that a film takes; both rates are 0 out of the film."""

    x: float
    rate: float
    rate_rate: float


@compiled_once(SOLVER)
def film_loss(m: Model, h: float, y: Floats, yp: Floats) -> tuple[float, float]:
    r"""Energy that all films have taken in a step that began where ``m.work.resistance`` says, and its error.

    With :math:`\dot x = \sqrt{c}\,\dot g` the loss is the integral of the square of a speed whose travel has a closed
    form in the gap.
    """
    r, total, doubt = m.work.resistance, 0.0, 0.0
    reach = pairs_felt(m, y)
    for i in range(reach.total):
        coast, number = pair_at(reach, i)
        start = (r.mesh_travel, r.mesh_speed, m.scene.phase_rate * r.gear_travel, r.gear_speed)
        before = _travel(m, coast, number, start, r.mesh_acceleration, r.gear_acceleration)
        now = _travel(m, coast, number, (y[U], y[V], y[PHASE], y[W]), yp[V], yp[W])
        if before.rate != 0.0 or now.rate != 0.0:
            ends = Ends(before.rate, before.rate_rate, now.rate, now.rate_rate)
            loss, error = integral_of_square(h, now.x - before.x, ends)
            total += loss
            doubt += error
    return total, doubt


@compiled
def _travel(
    m: Model,
    coast: int,
    number: int,
    motion: tuple[float, float, float, float],
    v_rate: float,
    w_rate: float,
) -> _Travel:
    """x of a pair at a state (u, v, phase and w) with accelerations."""
    u, v, phase, w = motion
    gap, rate, slope, _ = pair_gap(m, coast, number, u, v, phase, w)
    least, height = m.scene.film_gap, m.scene.film_gap + min(max(gap, 0.0), m.scene.cutoff)
    root = math.sqrt(m.scene.film_damping)
    x = root * (min(gap, 0.0) + 2.0 * least * (1.0 - math.sqrt(least / height)))
    if gap >= m.scene.cutoff:
        return _Travel(x, 0.0, 0.0)
    gap_acceleration = (1.0 - 2.0 * coast) * (slope * w_rate - v_rate)
    if slope != 0.0:
        gap_acceleration += m.scene.relief_slope * m.scene.phase_rate * w * w
    root *= (least / height) ** 1.5
    bend = -1.5 * rate * rate / height if gap > 0.0 else 0.0
    return _Travel(x, root * rate, root * (bend + gap_acceleration))
