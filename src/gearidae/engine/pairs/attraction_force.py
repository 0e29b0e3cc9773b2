r"""Attraction across the gap as a law of a pair, between mean planes and along the path of contact.

A pair's energy is :math:`\ell \sum_m s_m U_m(g)`, with its contact length and the shares of the materials at its place.
That gives the force along the line of action and, at fixed gap, the one along the path that `mesh.radius_force` stands
for.
"""

from __future__ import annotations

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.model.state import PHASE, Floats, Model
from gearidae.engine.pairs.coverage import attraction_energies, attraction_of, shares_of, weighed
from gearidae.engine.pairs.lengths import slopes_along_path
from gearidae.engine.pairs.pair_force import PairForce
from gearidae.engine.pairs.tooth_pairs import PairState, contact_length, is_on_path


@compiled(inline=True)
def _inside(m: Model, pair: PairState) -> float:
    """Path position of a pair, clipped to the path."""
    return min(max(pair.place, 0.0), m.scene.contact_ratio)


@compiled_once(SOLVER)
def attraction_force(m: Model, y: Floats, pair: PairState) -> PairForce:
    """Attraction of a pair, scaled."""
    inside = _inside(m, pair)
    pull, slope = attraction_of(m, pair.gap, shares_of(m, pair.coast, pair.number, inside))
    length, path, by_gap, by_place = contact_length(m, inside), 0.0, 0.0, 0.0
    if m.scene.curvature_force != 0 and is_on_path(m, pair.coast, pair.number):
        energies, slopes = attraction_energies(m, pair.gap)
        path, by_gap, by_place = slopes_along_path(m, pair.coast, pair.number, y[PHASE], energies, slopes)
    return PairForce(
        length * pull, length * slope, 0.0, 0.0, 0.0, 0.0, -path, -by_gap, -by_place, 0.0, 0.0, 0.0
    )


@compiled_once(SOLVER)
def attraction_energy(m: Model, pair: PairState) -> float:
    """Energy of the attraction of a pair, scaled."""
    inside = _inside(m, pair)
    shares = shares_of(m, pair.coast, pair.number, inside)
    return contact_length(m, inside) * weighed(shares, attraction_energies(m, pair.gap)[0])
