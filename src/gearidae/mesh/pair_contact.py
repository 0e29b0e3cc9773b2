"""The contact that a scene's estimates are made for: its force at a gap, where it rests, how stiff it is there.

For gears this is one pair of teeth that touch at the pitch point under the mean torque of the drive. For a roller it
is the impact's closest approach, with rigid bodies.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from gearidae.arrays import Floats
from gearidae.asperities import law_of
from gearidae.asperities.tip import asperity_of, contact_modulus
from gearidae.contact.asperity_statistics import zero_load_radius
from gearidae.contact.attraction import attraction_force
from gearidae.contact.line import line_area, line_force
from gearidae.errors import SceneError
from gearidae.mesh.involute import curvature_radii

if TYPE_CHECKING:
    from gearidae.scene import Scene
    from gearidae.scene.coating import Material
    from gearidae.scene.surface import Surface

_OUTERMOST, _INNERMOST = 30.0, -900.0
"""Gaps to look at, in roughnesses: beyond 30 the tail of the heights is below 1e-195."""
_BEGIN = 9.0
"""Where a search begins, in roughnesses: nearly every load settles nearer."""
_SEARCH_STEP, _ENERGY_STEP = 0.25, 0.05
"""Steps of a search for a load and of the integral of a force, in roughnesses; far inside they grow with the depth."""
_CHUNK = 8
"""Steps that are taken at a time."""
_SPLIT = 16
"""Parts into which a step is divided at a time."""
_DIFFERENCE = 1e-4
"""Change of the gap over which a stiffness is taken, in roughnesses: forces are exact to twelve digits."""


@dataclass(frozen=True)
class PairContact:
    """Two flanks of a scene that touch.

    Attributes
    ----------
    parts : tuple of Material
        Materials of the interface that have a share; shares add up to 1.
    law : str
        Law of one asperity.
    radius : float
        Reduced radius R [m].
    width : float
        Face width L [m].
    """

    parts: tuple[Material, ...]
    law: str
    radius: float
    width: float

    @property
    def surface(self) -> Surface:
        """Surface of the first part; heights and elastic constants are those of every part."""
        return self.parts[0].surface

    def force(self, gap: ArrayLike, stretch: ArrayLike = 0.0) -> Floats:
        """Force without bulk deflection [N] at gaps and stretches beyond joining [m], positive pushes apart."""
        total: Floats = np.zeros(np.broadcast_shapes(np.shape(gap), np.shape(stretch)))
        for part in self.parts:
            total = total + self._part_force(part, gap, stretch)
        return total + self.attraction(gap) if self.attracts else total

    @property
    def attracts(self) -> bool:
        """Whether the flanks attract each other across the gap."""
        return any(part.surface.hamaker > 0.0 for part in self.parts)

    def attraction(self, gap: ArrayLike, hamaker: float | None = None) -> Floats:
        """Attraction across gaps [m], negative [N], with the materials' Hamaker constants or one for all [J]."""
        total: Floats = np.zeros(np.shape(gap))
        for surface, share, offset, _ in self.parts:
            constant = surface.hamaker if hamaker is None else hamaker
            own_gap = np.asarray(gap) + offset
            total = total + share * attraction_force(own_gap, self.radius, self.width, constant)
        return total

    def part_forces(self, gap: float) -> list[float]:
        """Forces of the parts [N] at a gap [m] of approaching flanks."""
        return [float(self._part_force(part, gap, 0.0)) for part in self.parts]

    def part_areas(self, gap: float) -> list[float]:
        """Contact areas of the parts [m^2] at a gap [m] of approaching flanks, of a law that has one."""
        return [
            part.share
            * float(line_area(gap + part.gap_offset, 0.0, self.radius, self.width, part.surface, self.law))
            for part in self.parts
        ]

    def _part_force(self, part: Material, gap: ArrayLike, stretch: ArrayLike) -> Floats:
        surface, law = part.surface, self.law
        stretched = np.asarray(stretch) + law_of(law, surface).join * surface.roughness
        own_gap = np.asarray(gap) + part.gap_offset
        return part.share * line_force(own_gap, stretched, self.radius, self.width, surface, law)

    def resting_gap(self, load: float, error: float = 1e-12) -> float:
        """Outermost gap at which approaching flanks carry a load.

        Parameters
        ----------
        load : float
            Force [N].
        error : float, optional
            Error of the gap that is good enough, in roughnesses.

        Returns
        -------
        float
            Gap [m]; NaN if the load does not press the flanks together, or deeper than 900 roughnesses.
        """
        sigma = self.surface.roughness
        if not load > 0.0:
            return math.nan
        for gaps in _inwards(sigma, _SEARCH_STEP, beyond=float(self.force(_BEGIN * sigma)) >= load):
            carried = int(np.argmax(self.force(gaps) >= load))
            if carried > 0:
                return self._carries(load, gaps[carried - 1], gaps[carried], error * sigma)
        return math.nan

    def _carries(self, load: float, outer: float, inner: float, error: float) -> float:
        """Gap between two at which the load is carried; many at a time, as a call for one gap costs as much."""
        while outer - inner > error:
            gaps = np.linspace(outer, inner, _SPLIT + 1)
            carried = 1 + int(np.argmax(self.force(gaps[1:]) >= load))
            outer, inner = float(gaps[carried - 1]), float(gaps[carried])
        return 0.5 * (outer + inner)

    def closest_gap(self, height: float, energy: float) -> float:
        """Gap at which a body that comes in has spent its energy.

        Parameters
        ----------
        height : float
            Gap at the start [m].
        energy : float
            Kinetic energy there [J].

        Returns
        -------
        float
            Gap [m], to a few thousandths of the roughness; NaN if 900 roughnesses do not stop it.
        """
        sigma, left = self.surface.roughness, energy
        for gaps in _inwards(sigma, _ENERGY_STEP, beyond=height > _BEGIN * sigma):
            at = np.concatenate([[height], gaps[gaps < height]]) if height > gaps[-1] else gaps[:0]
            if at.size < 2:
                continue
            forces = self.force(at)
            work = np.cumsum(0.5 * (forces[1:] + forces[:-1]) * -np.diff(at))
            stopped = np.flatnonzero(work >= left)
            if stopped.size:
                k = int(stopped[0])
                before = work[k - 1] if k else 0.0
                share = (left - before) / (work[k] - before) if work[k] > before else 0.0
                return float(at[k] + share * (at[k + 1] - at[k]))
            height, left = float(at[-1]), left - float(work[-1])
        return math.nan

    def stiffness(self, gap: float) -> float:
        """Stiffness ``-dW/dg`` [N/m] of approaching flanks at a gap [m]."""
        step = _DIFFERENCE * self.surface.roughness
        closer, wider = self.force(np.array([gap - step, gap + step]))
        return float(closer - wider) / (2.0 * step)

    def joined_stiffness(self, gap: float) -> float:
        """Stiffness [N/m] of flanks that part from a gap [m]: asperities that touch there stay joined and stretch."""
        step = _DIFFERENCE * self.surface.roughness
        here, opened = self.force(np.array([gap, gap + step]), np.array([0.0, step]))
        return float(here - opened) / step

    def largest_tension(self, gap: float) -> float:
        """Largest tension [N] that flanks carry when they part from a gap [m]; 0 if they never pull."""
        sigma = self.surface.roughness
        stretch = max(asperity_of(part.surface).stretch_limit for part in self.parts)
        opened = np.linspace(0.0, 3.0 * sigma + stretch, 41)
        for _ in range(3):  # each time between the neighbours of the lowest
            forces = self.force(gap + opened, opened)
            k = int(np.argmin(forces))
            opened = np.linspace(opened[max(k - 1, 0)], opened[min(k + 1, opened.size - 1)], opened.size)
        return max(-float(forces[k]), 0.0)


def pair_contact(scene: Scene) -> PairContact:
    """Return the contact that a scene's estimates are made for.

    Raises
    ------
    SceneError
        If the gears of the scene cannot mesh.
    """
    parts = tuple(part for part in scene.materials() if part.share > 0.0)
    if scene.roller is not None:
        return PairContact(parts, scene.contact.asperity, scene.roller.radius, scene.roller.width)
    if scene.gears is None:
        raise SceneError(
            "gears",
            "(missing)",
            "of a train take one mesh, scene.pair(NAME): contacts are those of a pair or a roller",
        )
    geometry = scene.geometry
    radius = float(curvature_radii(geometry, geometry.approach)[2])
    return PairContact(parts, scene.contact.asperity, radius, scene.gears.face_width)


def _inwards(sigma: float, finest: float, *, beyond: bool) -> Iterator[Floats]:
    """Yield gaps [m] from the outside inwards, a chunk at a time, each beginning where the one before it ended."""
    at = _OUTERMOST if beyond else _BEGIN
    while at > _INNERMOST:
        step = finest * max(1.0, -0.2 * at)
        gaps: Floats = np.asarray((at - step * np.arange(_CHUNK + 1)) * sigma, dtype=np.float64)
        yield gaps
        at -= step * _CHUNK


def asperity_stiffness(scene: Scene) -> float:
    """Stiffness of one asperity [N/m]: of the stiffest of the scene's materials where adhesion holds it without load.

    For JKR ``1.2 E* a0``; of one pressed by a roughness where nothing adheres.
    """
    surface = scene.surface
    radius = max(zero_load_radius(material.surface) for material in scene.materials() if material.share > 0.0)
    modulus = contact_modulus(surface.youngs_modulus, surface.poisson_ratio)
    return 1.2 * modulus * radius or 2.0 * modulus * math.sqrt(surface.asperity_radius * surface.roughness)
