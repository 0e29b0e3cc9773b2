r"""One contact of drawn asperities at rest: pressed to a load, and parted along the normal.

At the gap g an asperity at the distance x from where the pair touches overlaps by :math:`\delta = t - g`, with
:math:`t = z - x^2/(2R)`, z its height. It joins where :math:`\delta` rises to minus the distance of joining, and lets
go where it falls to minus that of detachment (docs/physics.md). Gaps are prescribed, as by a stiff machine.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from gearidae.arrays import Floats
from gearidae.asperities import tip_law
from gearidae.asperities.registry import TipLaw
from gearidae.errors import SceneError
from gearidae.mesh.pair_contact import PairContact
from gearidae.populations.flanks import FlankAsperities
from gearidae.populations.materials import materials_at
from gearidae.scene import MATERIAL_NAMES, Scene

_FIRST = 32
"""Asperities, the nearest of all, that are looked at before more of them are."""
_BETWEEN = 33
"""Gaps at which the tension is looked at between two detachments, before its maximum is refined."""
_CLOSE = 1e-9
"""Error of a gap that is refined, in roughnesses."""


Bools: TypeAlias = NDArray[np.bool_]
Integers: TypeAlias = NDArray[np.intp]
Groups: TypeAlias = list[tuple[TipLaw, Integers]]
"""Laws, and which asperities have each."""
Force: TypeAlias = Callable[[Floats, Bools], Floats]
"""Force [N] at gaps, shape (g,), with the asperities that are joined at each, shape (g, n) or (n,)."""


class PullOff(NamedTuple):
    """What it takes to part a contact.

    Attributes
    ----------
    force : float
        Largest tension [N]; 0 if it never pulls.
    joined, holding : int
        Asperities that are joined under the load, and at the largest tension.
    gap : float
        Gap under the load [m].
    """

    force: float
    joined: int
    holding: int
    gap: float


DEEPEST: Final = 8.0
"""Largest overlap of the mean planes, in roughnesses: beyond, the flanks are solid."""


class DrawnContact:
    """The asperities of one contact, the nearest first.

    Parameters
    ----------
    scene : Scene
        Whose materials and law they have.
    flank : FlankAsperities
        The flank.
    contact : PairContact
        Radius, and attraction across the gap.
    arc : float
        Where on the flank the pair touches [m].
    """

    def __init__(self, scene: Scene, flank: FlankAsperities, contact: PairContact, arc: float) -> None:
        parts = {part.name: part for part in scene.materials()}
        material = materials_at(scene, flank, flank.tooth + flank.flank)
        offsets = np.array([parts[name].gap_offset if name in parts else 0.0 for name in MATERIAL_NAMES])
        top = flank.height - offsets[material] - (flank.arc - arc) ** 2 / (2.0 * contact.radius)
        order = np.argsort(-top, kind="stable")
        self._top, self._material, self._radius = top[order], material[order], flank.radius[order]
        self._surfaces = [parts[name].surface if name in parts else scene.surface for name in MATERIAL_NAMES]
        self._name, self._contact, self._sigma = scene.contact.asperity, contact, scene.surface.roughness
        self._laws: dict[tuple[int, float], TipLaw] = {}

    def _law(self, material: int, radius: float) -> TipLaw:
        if (material, radius) not in self._laws:
            self._laws[material, radius] = tip_law(self._name, self._surfaces[material], radius)
        return self._laws[material, radius]

    def _nearest(self, count: int) -> tuple[Floats, Floats, Floats, Groups]:
        """Tops, distances of joining and of detachment of the nearest asperities [m], and who has which law."""
        material, radius = self._material[:count], self._radius[:count]
        join, detach, groups = np.empty(material.size), np.empty(material.size), []
        for number, tip in sorted(set(zip(material.tolist(), radius.tolist(), strict=True))):
            law, which = self._law(number, tip), np.flatnonzero((material == number) & (radius == tip))
            join[which], detach[which] = law.law.join * law.length, law.law.detach * law.length
            groups.append((law, which))
        return self._top[:count], join, detach, groups

    def pull_off(self, load: float) -> PullOff:
        """Press the contact together until it first carries a load [N], and part it.

        Raises
        ------
        SceneError
            If it takes more than `DEEPEST` roughnesses of overlap to carry the load.
        """
        top, _, _, groups = self._nearest(self._top.size)
        deepest, every = np.array([-DEEPEST * self._sigma]), np.ones((1, top.size), np.bool_)
        if load > (most := float(self._force(top, groups, deepest, every)[0])):
            reason = f"must be at most {most:.3g} N, which overlaps the flanks by {DEEPEST:g} roughnesses"
            raise SceneError("load", load, reason)
        count = min(_FIRST, self._top.size)
        while True:
            top, join, detach, groups = self._nearest(count)
            force = partial(self._force, top, groups)
            order = np.argsort(-(top + join), kind="stable")
            gaps = (top + join)[order]  # at which they join, one after the other
            pressed = _pressed(gaps, order, force, load)
            if pressed is not None or count == self._top.size:
                break
            count = min(4 * count, self._top.size)
        if pressed is None:  # below all of them
            if not count:
                return PullOff(0.0, 0, 0, math.nan)
            pressed = _deepest(gaps, order, force, load, self._sigma)
        gap, joined = pressed
        tension, holding = _largest_tension(gap, joined, top + detach, force, self._sigma)
        return PullOff(tension, int(joined.sum()), holding, gap)

    def _force(self, top: Floats, groups: Groups, gap: Floats, joined: Bools) -> Floats:
        total = _loads(gap, joined, top, groups)
        return total + self._contact.attraction(gap) if self._contact.attracts else total


def _loads(gap: Floats, joined: Bools, top: Floats, groups: Groups) -> Floats:
    """Sum the loads of joined asperities [N] at gaps, shape (g,)."""
    total, overlap = np.zeros(gap.size), top - gap[:, None]
    held = np.broadcast_to(joined, overlap.shape)
    for law, which in groups:
        load = law.load * law.law.load(overlap[:, which] / law.length)
        total += np.where(held[:, which], load, 0.0).sum(axis=1)
    return total


def _pressed(gaps: Floats, order: Integers, force: Force, load: float) -> tuple[float, Bools] | None:
    """Gap at which the load is first carried and what is joined there; None if it takes more asperities."""
    n = gaps.size
    if n < 2:
        return None
    ends = gaps[1:]  # just before each further asperity joins
    joined = np.zeros((n - 1, n), np.bool_)
    for k in range(n - 1):
        joined[k, order[: k + 1]] = True
    carried = np.flatnonzero(force(ends, joined) >= load)
    if not carried.size:
        return None
    k = int(carried[0])
    return _where(gaps[k], ends[k], force, joined[k], load), joined[k]


def _where(outer: float, inner: float, force: Force, joined: Bools, load: float) -> float:
    """Gap at which the asperities that are joined carry a load, which they do at the inner end."""

    def over(gap: float) -> float:
        return float(force(np.array([gap]), joined)[0]) - load

    if outer <= inner or over(outer) >= 0.0:
        return float(outer)
    return float(brentq(over, inner, outer, xtol=1e-18, rtol=1e-14))


def _deepest(gaps: Floats, order: Integers, force: Force, load: float, sigma: float) -> tuple[float, Bools]:
    """Gap at which all asperities of a flank carry a load."""
    joined = np.zeros(gaps.size, np.bool_)
    joined[order] = True
    inner = float(gaps[-1])
    step = sigma
    while float(force(np.array([inner]), joined)[0]) < load and step < 1e9 * sigma:
        inner -= step
        step *= 2.0
    return _where(float(gaps[-1]), inner, force, joined, load), joined


def _largest_tension(
    gap: float, joined: Bools, last: Floats, force: Force, sigma: float
) -> tuple[float, int]:
    """Largest tension [N] on the way from a gap outwards, and how many asperities hold there.

    Parameters
    ----------
    last : ndarray
        Gaps at which the asperities let go [m].
    """
    ends = np.unique(np.maximum(last[joined], gap))
    starts = np.concatenate([[gap], ends[:-1]])
    best, holding = 0.0, 0
    for start, end in zip(starts, ends, strict=True):
        held = joined & (last >= end)
        at = start + (end - start) * np.linspace(0.0, 1.0, _BETWEEN) * (1.0 - 1e-12)
        tension = -force(at, held)
        k = int(np.argmax(tension))
        largest = float(tension[k])
        if 0 < k < at.size - 1 and largest > 0.5 * best:
            bounds = float(at[k - 1]), float(at[k + 1])
            finer = minimize_scalar(
                lambda g, held=held: float(force(np.array([g]), held)[0]),
                bounds=bounds,
                options={"xatol": _CLOSE * sigma},
            )
            largest = max(largest, -float(finer.fun))
        if largest > best:
            best, holding = largest, int(held.sum())
    alone = -float(force(ends[-1:], np.zeros_like(joined))[0]) if ends.size else 0.0
    return (alone, 0) if alone > best else (best, holding)
