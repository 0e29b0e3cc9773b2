r"""How hard a leaving pair of teeth holds the gear back: the static side of sticking.

While a pair leaves the mesh, d beyond the end of its path of contact, its rounded tip has opened its gap by
:math:`s = d^2/2\rho`. Asperities joined before stretch, the pair pulls, and its pull acts on the gear through
:math:`s' = d/\rho`. The pairs that stay carry the drive and the pull,

.. math::

    \sum_j W_j(g, \zeta) + W_l(g + s, \zeta) = M_{10}/R_1,

which gives the gap g at every d; the gear turns on if

.. math::

    M_{10}/R_1 + s' W_l \ge M_{20}/R_2 .

The pull presses the staying pairs together, so that the next one to leave has been pressed deeper than this one: the
resistance grows from one mesh exit to the next. Teodorescu et al. 2009 (doi:10.1016/j.triboint.2008.05.019), Eqs. 1-15.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gearidae.arrays import Floats
from gearidae.asperities import law_of_tip
from gearidae.asperities.tip import asperity_of
from gearidae.studies.equilibrium import leaving_radii, nearest_gap, pair_law, settled_gap

if TYPE_CHECKING:
    from gearidae.scene import GearScene

_STEPS = 60
"""Places along the tip at which the pull is evaluated."""
_FINER, _PARTS = 8, 20
"""How often the places beside the largest are divided anew, and into how many parts: the resistance may rise to a cusp,
where the staying pairs take over, and has fallen by 7 % a thousandth of a pitch behind it."""
_REACH = 4.0
"""The tip is followed until it has opened the gap by this many roughnesses more than asperities stretch."""


class _Place(NamedTuple):
    """A place along the tip: how far beyond the end of the path [m], the gap there [m], and the resistance [N]."""

    beyond: float
    gap: float
    resistance: float


def holding_forces(scene: GearScene, force: float, impacts: int) -> list[float]:
    """Largest resistance of the leaving pair at successive mesh exits.

    Parameters
    ----------
    scene : Scene
        With gears.
    force : float
        Drive torque over the pinion's base radius [N], positive.
    impacts : int
        Mesh exits to follow, from a contact that has been pressed by `force` alone.

    Returns
    -------
    list of float
        ``max(-s' W_l)`` at each exit [N], acting at the gear's base radius against its turning; 0 if nothing pulls.
    """
    law, rho = pair_law(scene), scene.mesh.tip_relief_radius
    leaving, staying = leaving_radii(scene)
    law_of_one = law_of_tip(scene.contact.asperity, asperity_of(scene.surface), 1.0)  # in metres
    reach = _REACH * scene.surface.roughness + law_of_one.detach
    ends = np.linspace(0.0, math.sqrt(2.0 * rho * reach), _STEPS + 1)[1:]

    def loading(gap: float) -> float:
        return sum(law(gap, gap, radius) for radius in (leaving, *staying)) - force

    joined = gap = settled_gap(scene, loading)
    resistances = []
    for _ in range(impacts):
        deepest = joined

        def follow(places: Floats, gap: float, joined: float = joined) -> list[_Place]:
            """Follow the tip from a gap along some places."""
            followed = []
            for beyond in places:
                opened = beyond**2 / (2.0 * rho)

                def balance(at: float, opened: float = opened) -> float:
                    stays = sum(law(at, joined, radius) for radius in staying)
                    return stays + law(at + opened, joined, leaving) - force

                gap = nearest_gap(scene, balance, gap)
                resistance = -law(gap + opened, joined, leaving) * beyond / rho
                followed.append(_Place(float(beyond), gap, resistance))
            return followed

        tip = [_Place(0.0, gap, 0.0), *follow(ends, gap)]
        most, gap = 0.0, tip[-1].gap
        for _ in range(_FINER + 1):
            deepest = min(deepest, *(place.gap for place in tip))
            best = max(range(len(tip)), key=lambda k: tip[k].resistance)
            most = max(most, tip[best].resistance)
            first, last = tip[max(best - 2, 0)], tip[min(best + 2, len(tip) - 1)]
            inner = np.linspace(first.beyond, last.beyond, _PARTS + 1)[1:]
            tip = [first, *follow(inner, first.gap)]
        resistances.append(float(most))
        joined = deepest
    return resistances
