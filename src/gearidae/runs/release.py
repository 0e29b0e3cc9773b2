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
from collections.abc import Callable, Sequence
from operator import itemgetter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gearidae.arrays import Floats
from gearidae.asperities import law_of_tip
from gearidae.asperities.tip import asperity_of
from gearidae.runs.equilibrium import leaving_radii, nearest_gap, pair_law, settled_gap

if TYPE_CHECKING:
    from gearidae.scene import GearScene

_STEPS = 60
"""Positions along the tip between which the largest pull is looked for."""
_PLACE_ERROR = 1e-5
"""Of the position of the largest pull, in distances of these: beside its cusp the pull falls by half over some."""
_REACH = 4.0
"""The tip is followed until it has opened the gap by this many roughnesses more than asperities stretch."""


class Exit(NamedTuple):
    """One mesh exit in slow motion.

    Attributes
    ----------
    resistance : float
        Largest ``max(-s' W_l)`` [N], acting at the gear's base radius against its turning; 0 if nothing pulls.
    joined : float
        Smallest gap to which the staying pairs have been pressed so far [m].
    """

    resistance: float
    joined: float


class LeavingPair:
    """A leaving pair of a scene and the pairs that stay, in slow motion.

    Attributes
    ----------
    positions : ndarray
        Distances from the end of the path on [m], between which the largest resistance is looked for.
    """

    def __init__(self, scene: GearScene) -> None:
        self._scene, self._law, self._rho = scene, pair_law(scene), scene.mesh.tip_relief_radius
        self._leaving, self._staying = leaving_radii(scene)
        law_of_one = law_of_tip(scene.contact.asperity, asperity_of(scene.surface), 1.0)  # in metres
        reach = _REACH * scene.surface.roughness + law_of_one.detach
        self.positions = np.linspace(0.0, math.sqrt(2.0 * self._rho * reach), _STEPS + 1)

    def settled(self, force: float) -> float:
        """Gap of all pairs at the end of the path [m], pressed by a force alone [N]."""
        radii = (self._leaving, *self._staying)
        return settled_gap(
            self._scene, lambda gap: sum(self._law(gap, gap, radius) for radius in radii) - force
        )

    def balanced(self, beyond: float, near: float, joined: float, force: float) -> tuple[float, float]:
        """Depth of the gap [m] at a position of the tip, next to a gap where forces nearly balance; resistance [N]."""
        opened = beyond**2 / (2.0 * self._rho)

        def balance(gap: float) -> float:
            stays = sum(self._law(gap, joined, radius) for radius in self._staying)
            return stays + self._law(gap + opened, joined, self._leaving) - force

        gap = nearest_gap(self._scene, balance, near)
        return -gap, -self._law(gap + opened, joined, self._leaving) * beyond / self._rho


def holding_forces(scene: GearScene, force: float, impacts: int) -> list[float]:
    """Largest resistance of the leaving pair at successive mesh exits [N], see `exits`."""
    return [leaving.resistance for leaving in exits(scene, force, impacts)]


def exits(scene: GearScene, force: float, impacts: int) -> list[Exit]:
    """Follow successive mesh exits in slow motion.

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
    list of Exit
    """
    pair = LeavingPair(scene)
    joined = gap = pair.settled(force)
    followed_exits = []
    for _ in range(impacts):

        def at(beyond: float, near: Sequence[float], joined: float = joined) -> tuple[float, float]:
            return pair.balanced(beyond, -near[0], joined, force)

        followed = [(-gap, 0.0)]
        for beyond in pair.positions[1:]:
            followed.append(at(float(beyond), followed[-1]))
        deepest, most = (largest(at, pair.positions, followed, which)[which] for which in (0, 1))
        joined, gap = min(joined, -deepest), -followed[-1][0]
        followed_exits.append(Exit(most, joined))
    return followed_exits


def largest(
    at: Callable[[float, Sequence[float]], Sequence[float]],
    positions: Floats,
    known: Sequence[Sequence[float]],
    which: int,
) -> Sequence[float]:
    """Find the numbers at the position where one of them is largest, by golden section between two neighbours.

    Resistance and depth have a cusp where the asperities that were pressed deepest let go, so that no parabola through
    it helps.

    Parameters
    ----------
    at : callable
        The numbers at a position, given those of a position beside it.
    places, known
        Positions in order, and what `at` gives there.
    which : int
        Index of the number that is to be largest.

    Returns
    -------
    sequence of float
        What `at` gives there.
    """
    k = max(range(len(known)), key=lambda n: known[n][which])
    before = max(k - 1, 0)
    low, high = float(positions[before]), float(positions[min(k + 1, len(positions) - 1)])
    near, part, error = known[before], 0.5 * (math.sqrt(5.0) - 1.0), _PLACE_ERROR * (high - low)
    inner, outer = high - part * (high - low), low + part * (high - low)
    at_inner, at_outer = at(inner, near), at(outer, near)
    most = max(known[k], at_inner, at_outer, key=itemgetter(which))
    while high - low > error:
        if at_inner[which] > at_outer[which]:
            high, outer, at_outer = outer, inner, at_inner
            inner = high - part * (high - low)
            at_inner = at(inner, near)
            most = max(most, at_inner, key=itemgetter(which))
        else:
            low, inner, at_inner = inner, outer, at_outer
            outer = low + part * (high - low)
            at_outer = at(outer, near)
            most = max(most, at_outer, key=itemgetter(which))
    return most
