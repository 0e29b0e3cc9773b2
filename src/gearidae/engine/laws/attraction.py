r"""Attraction across the gap as a law of a pair, between mean planes and along the path of contact.

It is the closed form of `gearidae.contact.attraction`, scaled. Per unit length a material with the constant c pulls
with :math:`-c\,h^{-5/2}`, h its gap with its offset. It would do so at any distance: the pull at the cut-off is taken
off everywhere, so that force and energy end there continuously and nothing is lost where a pair leaves.

A pair's energy is :math:`\ell \sum_m s_m U_m(g)`, with its contact length and the shares of the materials at its
position. That gives the force along the line of action and, at fixed gap, the one along the path that
`mesh.radius_force` stands for.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.model.state import PHASE, Floats, Model
from gearidae.engine.pairs.coverage import Shares, shares_of, weighed
from gearidae.engine.pairs.lengths import length_power, slopes_along_path
from gearidae.engine.pairs.tooth_pairs import PairState, contact_length, is_on_path
from gearidae.laws.pair_law import PairForce, PairLaw, both_forces, in_reach


class Attraction(NamedTuple):
    """Attraction of one material per unit length: force, its slope in the gap, and energy."""

    force: float
    slope: float
    energy: float


@compiled
def attraction(m: Model, material: int, gap: float) -> Attraction:
    """Attraction that a material of a pair would have if it covered everything, or with its share in the constant."""
    surface = m.scene.material[material]
    c, far = surface.attraction, m.scene.cutoff + surface.gap_offset
    if c == 0.0 or not in_reach(m, gap):
        return Attraction(0.0, 0.0, 0.0)
    h = gap + surface.gap_offset
    near = max(h, m.scene.attraction_floor)
    pull, last = c / (near * near * math.sqrt(near)), c / (far * far * math.sqrt(far))
    slope = 2.5 * pull / near if h > m.scene.attraction_floor else 0.0
    energy = -2.0 / 3.0 * pull * near + pull * (h - near)
    return Attraction(last - pull, slope, energy + 2.0 / 3.0 * last * far - last * (h - far))


@compiled
def _energies(m: Model, gap: float) -> tuple[Shares, Shares]:
    """Energy of each material's attraction, scaled, per length and share, and its slopes in the gap."""
    a, b, c = attraction(m, 0, gap), attraction(m, 1, gap), attraction(m, 2, gap)
    return (a.energy, b.energy, c.energy), (-a.force, -b.force, -c.force)


@compiled(inline=True)
def _inside(m: Model, pair: PairState) -> float:
    """Path position of a pair, clipped to the path."""
    return min(max(pair.position, 0.0), m.scene.contact_ratio)


@compiled_once(SOLVER)
def _pull(m: Model, y: Floats, pair: PairState) -> PairForce:
    """Attraction of a pair, scaled."""
    inside = _inside(m, pair)
    shares = shares_of(m, pair.flank, pair.number, inside)
    a, b, c = attraction(m, 0, pair.gap), attraction(m, 1, pair.gap), attraction(m, 2, pair.gap)
    pull, slope = weighed(shares, (a.force, b.force, c.force)), weighed(shares, (a.slope, b.slope, c.slope))
    length, path, by_gap, by_position = contact_length(m, inside), 0.0, 0.0, 0.0
    if m.scene.curvature_force != 0 and is_on_path(m, pair.flank, pair.number):
        energies, slopes = _energies(m, pair.gap)
        path, by_gap, by_position = slopes_along_path(m, pair.flank, pair.number, y[PHASE], energies, slopes)
    return PairForce(
        length * pull, length * slope, 0.0, 0.0, 0.0, 0.0, -path, -by_gap, -by_position, 0.0, 0.0, 0.0
    )


@compiled(inline=True)
def _force(m: Model, t: float, y: Floats, pair: PairState, settling: bool, value: PairForce) -> PairForce:
    return both_forces(value, _pull(m, y, pair))


@compiled_once(SOLVER)
def _stored(m: Model, pair: PairState) -> float:
    """Energy of the attraction of a pair, scaled."""
    inside = _inside(m, pair)
    shares = shares_of(m, pair.flank, pair.number, inside)
    return contact_length(m, inside) * weighed(shares, _energies(m, pair.gap)[0])


@compiled
def _energy(m: Model, y: Floats, pair: PairState, value: tuple[float, float]) -> tuple[float, float]:
    return value[0] + _stored(m, pair), value[1]


@compiled
def _power(
    m: Model, t: float, y: Floats, k: int, gap: float, w_rate: float, value: tuple[float, float]
) -> tuple[float, float]:
    energies, slopes = _energies(m, gap)
    power, rate = length_power(m, k, y, w_rate, energies, slopes)
    return value[0] + power, value[1] + rate


def _acts(scene: Any) -> bool:
    return bool(scene.attracts != 0)


ATTRACTION = PairLaw(name="attraction", acts=_acts, force=_force, energy=_energy, power=_power)
