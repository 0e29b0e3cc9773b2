"""The asperities of every flank of the pinion (the gear's flanks are smooth), or of a roller.

Every flank is drawn from a generator of its own, and always in the same order: number, positions, heights, coverage
numbers of the pinion's side, of the gear's, radii. So coverage and torques may be varied on one surface.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from gearidae.arrays import Floats
from gearidae.scene import Scene
from gearidae.scene.asperity_list import FLANKS, ListedAsperity
from gearidae.scene.strip import flank_strip


class FlankAsperities(NamedTuple):
    """The asperities of one flank, in the order of their positions.

    Attributes
    ----------
    tooth, flank : int
        Tooth of the pinion, and 0 for its drive flank, 1 for its coast flank; both 0 for a roller.
    arc : ndarray, shape (n,)
        Position: arc from the base circle, or distance from the middle of a roller [m].
    height : ndarray, shape (n,)
        Above the mean plane [m].
    radius : ndarray, shape (n,)
        Of the tips [m].
    q, q2 : ndarray, shape (n,)
        Coverage numbers of the pinion's and the gear's side: covered where the fraction is larger. Of patches the
        second are the first.
    """

    tooth: int
    flank: int
    arc: Floats
    height: Floats
    radius: Floats
    q: Floats
    q2: Floats

    def sorted(self) -> FlankAsperities:
        """Return the same asperities in the order of positions."""
        order = np.argsort(self.arc, kind="stable")
        return self._replace(**{name: getattr(self, name)[order] for name in self._fields[2:]})


def flanks_of(scene: Scene) -> tuple[FlankAsperities, ...]:
    """Return the asperities of all flanks: tooth by tooth, the drive flank first.

    Returns
    -------
    tuple of FlankAsperities
        Two for each tooth of the pinion, or one for a roller; arrays that must not be changed.
    """
    teeth = 1 if scene.gears is None else scene.gears.pinion_teeth
    surface, contact = scene.surface, scene.contact
    if contact.asperities:
        return _listed(
            contact.asperities, surface.asperity_radius, contact.seed, teeth, scene.gears is not None
        )
    sides = 2 if scene.gears is not None else 1
    return _drawn(teeth, sides, contact.seed, *_drawing(scene))


def first_flanks(scene: Scene, seeds: Iterable[int]) -> Iterator[FlankAsperities]:
    """Draw the drive flank of the pinion's first tooth, or the roller, for each of some seeds.

    Each is the first of `flanks_of` of the scene with that seed.
    """
    contact, drawing = scene.contact, _drawing(scene)
    for seed in seeds:
        if contact.asperities:
            radius = scene.surface.asperity_radius
            yield _listed(contact.asperities, radius, seed, 1, scene.gears is not None)[0]
        else:
            yield _draw_flank((seed, 0, 0), *drawing)


class _Drawing(NamedTuple):
    """What a flank is drawn from: the seed apart, `mean` asperities, radii of a mean and a relative deviation."""

    two_sided: bool
    mean: float
    strip: tuple[float, float]
    roughness: float
    radii: tuple[float, float]


def _drawing(scene: Scene) -> _Drawing:
    width = scene.roller.width if scene.roller is not None else 0.0
    if scene.gears is not None:
        width = scene.gears.face_width
    strip, surface = flank_strip(scene), scene.surface
    return _Drawing(
        scene.coating.pairing == "independent",
        surface.asperity_density * width * (strip[1] - strip[0]),
        strip,
        surface.roughness,
        (surface.asperity_radius, scene.contact.radius_spread),
    )


@lru_cache(maxsize=2)
def _drawn(
    teeth: int,
    sides: int,
    seed: int,
    two_sided: bool,
    mean: float,
    strip: tuple[float, float],
    roughness: float,
    radii: tuple[float, float],
) -> tuple[FlankAsperities, ...]:
    """Draw the flanks of all teeth."""
    return tuple(
        _draw_flank((seed, tooth, flank), two_sided, mean, strip, roughness, radii)
        for tooth in range(teeth)
        for flank in range(sides)
    )


def _draw_flank(
    which: tuple[int, int, int],
    two_sided: bool,
    mean: float,
    strip: tuple[float, float],
    roughness: float,
    radii: tuple[float, float],
) -> FlankAsperities:
    """Draw one flank, given by seed, tooth and side."""
    low, length = strip[0], strip[1] - strip[0]
    radius, spread = radii
    _, tooth, flank = which
    rng = np.random.default_rng(which)
    n = int(rng.poisson(mean))
    arc = low + length * rng.random(n)
    height = roughness * rng.standard_normal(n)
    q = rng.random(n)
    q2 = rng.random(n) if two_sided else q
    of_radii = np.full(n, radius)
    if spread > 0.0:
        variance = math.log1p(spread**2)
        of_radii = rng.lognormal(math.log(radius) - 0.5 * variance, math.sqrt(variance), n)
    return FlankAsperities(tooth, flank, arc, height, of_radii, q, q2).sorted()


@lru_cache(maxsize=2)
def _listed(
    rows: Sequence[ListedAsperity], radius: float, seed: int, teeth: int, gears: bool
) -> tuple[FlankAsperities, ...]:
    """Put the rows of a list on the flanks that they name; coverage numbers that they leave out are drawn."""
    numbers = np.array(
        [[math.nan if cell is None else float(cell) for cell in row[:-1]] for row in rows], np.float64
    )
    named = np.array([-1 if row.flank is None else FLANKS.index(row.flank) for row in rows])
    flanks = []
    for tooth in range(teeth):
        for flank in range(2 if gears else 1):
            here = (np.isnan(numbers[:, 5]) | (numbers[:, 5] == tooth)) & ((named < 0) | (named == flank))
            arc, height, radii, q, q2, _ = numbers[here].T
            rng = np.random.default_rng([seed, tooth, flank])
            q, q2 = (np.where(np.isnan(values), rng.random(values.size), values) for values in (q, q2))
            radii = np.where(np.isnan(radii), radius, radii)
            flanks.append(FlankAsperities(tooth, flank, arc, height, radii, q, q2).sorted())
    return tuple(flanks)


def flanks_digest(flanks: tuple[FlankAsperities, ...]) -> str:
    """Return the SHA-256 of all asperities: numpy does not promise to draw the same from a seed for ever.

    Parameters
    ----------
    flanks : tuple of FlankAsperities

    Returns
    -------
    str
        Hexadecimal, of the number of asperities and the bits of their columns, flank by flank.
    """
    digest = hashlib.sha256()
    for asperities in flanks:
        digest.update(np.array([asperities.arc.size], "<i8").tobytes())
        for column in asperities[2:]:
            digest.update(np.ascontiguousarray(column, "<f8").tobytes())
    return digest.hexdigest()
