"""From a scene's asperities to the tables and rows of a population."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.asperities import AsperityLaw, tip_law
from gearidae.asperities.area import ContactArea
from gearidae.asperities.tip import asperity_of
from gearidae.contact.kernels.layout import GAP_LOW
from gearidae.contact.kernels.single import asperity_table
from gearidae.engine.model.state import Floats, Record
from gearidae.engine.population.candidates import LEVELS
from gearidae.engine.population.layout import (
    FIELDS,
    K_AREA,
    K_DETACH,
    K_ENERGY,
    K_FRICTION,
    K_JOIN,
    K_LOAD,
    K_MATERIAL,
    K_OFFSET,
    K_SCALE,
    K_TABLE,
    KINDS,
)
from gearidae.engine.setup.build_contact import add_fractions
from gearidae.engine.setup.tables import Tables
from gearidae.errors import SceneError
from gearidae.populations.flanks import FlankAsperities, flanks_digest, flanks_of
from gearidae.populations.materials import materials_met
from gearidae.scene import MATERIAL_NAMES, Scene, Surface
from gearidae.scene.friction import friction_values

Integers = NDArray[np.int64]

RELEASED: Final = 1e-10
"""Distance of detachment before the fold, over the width of the hysteresis: the slope of its load is
infinite there, and less of its loss is out than this."""
BEYOND: Final = 0.25
"""Roughnesses by which a flank comes near before its highest asperity may join, whose guard is to be seen waiting."""
LEAST_CUTOFF: Final = GAP_LOW + 1.0
MOST_LAWS: Final = 512
"""Tables of laws that scale with neither radius nor adhesion, as that of Maugis; each takes a tenth of a second."""


def add_population(s: Record, tables: Tables, scene: Scene, steepness: float, arc_scale: float) -> None:
    """Lay out all asperities, their kinds and laws, and set the gap beyond which nothing touches.

    Parameters
    ----------
    s : record
        ``SCENE``; changed.
    steepness, arc_scale : float
        See ``POPULATION``.

    Raises
    ------
    SceneError
        If there are no asperities, or more laws than can be tabulated.
    """
    population, sigma, flanks = s.population, scene.surface.roughness, flanks_of(scene)
    counts = np.array([flank.arc.size for flank in flanks])
    if counts.sum() == 0:
        listed, density = scene.contact.asperities, scene.surface.asperity_density
        key, value = ("contact.asperities", "(none)") if listed else ("surface.asperity_density", density)
        raise SceneError(key, value, "gives no asperity on any flank: a population needs some")
    length = float(s.base_pitch) if scene.gears is not None else steepness * sigma
    arcs = np.concatenate([flank.arc for flank in flanks]) / length
    heights = np.concatenate([flank.height for flank in flanks]) / sigma
    population.flanks, population.steepness, population.arc_scale = len(flanks), steepness, arc_scale
    population.highest, population.capacity = float(heights.max()), max(int(counts.max()), 1)
    population.arcs_at, population.heights_at = tables.add(arcs), tables.add(heights)
    _add_levels(population, tables, heights, counts)
    numbers, kinds = _kinds(s, tables, scene, flanks)
    first = tables.add(numbers.ravel())
    population.kinds_at, *bare = (tables.add((first + KINDS * row).astype(np.float64)) for row in kinds)
    if bare:
        population.by_gear_tooth, (population.bare_kinds_at,) = 1, bare
        population.gear_numbers_at = tables.add(np.concatenate([flank.q2 for flank in flanks]))
        add_fractions(s.coverage[1], tables, scene.coating.gear_table, float(s.contact_ratio))
    population.join = float(numbers[:, K_JOIN].max())
    digest = flanks_digest(flanks)
    population.digest = [float(int(digest[8 * k : 8 * k + 8], 16)) for k in range(4)]
    population.quiet = int(not scene.run.asperity_events)
    s.cutoff = s.contact_gap = max(
        population.highest + float(numbers[:, K_DETACH].max()) + BEYOND, LEAST_CUTOFF
    )


def population_rows(s: Record) -> Floats:
    """Rows of the candidates of all histories, blank."""
    return np.zeros(int(s.histories * FIELDS * s.population.capacity))


def _add_levels(population: Record, tables: Tables, heights: Floats, counts: Integers) -> None:
    """List the asperities above each level, flank by flank."""
    flank = np.repeat(np.arange(counts.size), counts)
    starts, listed = [np.concatenate([[0], np.cumsum(counts)])], [np.empty(0, np.int64)]
    gone = 0
    for level in LEVELS:
        high = np.flatnonzero(heights > level)
        ends = np.searchsorted(flank[high], np.arange(counts.size + 1))
        starts.append(gone + ends)
        listed.append(high)
        gone += high.size
    population.starts_at, population.listed_at = (
        tables.add(np.concatenate(starts)),
        tables.add(np.concatenate(listed)),
    )


def _kinds(
    s: Record, tables: Tables, scene: Scene, flanks: tuple[FlankAsperities, ...]
) -> tuple[Floats, Integers]:
    """Numbers of each kind, and the kind of each asperity in the rows of `materials_met`.

    A kind is a material with a radius.
    """
    radii, of_radius = np.unique(np.concatenate([flank.radius for flank in flanks]), return_inverse=True)
    material = np.concatenate([materials_met(scene, flank) for flank in flanks], axis=1)
    both = len(MATERIAL_NAMES) * of_radius.ravel() + material
    pairs, kinds = np.unique(both.ravel(), return_inverse=True)
    return _numbers(
        s, tables, scene, radii[pairs // len(MATERIAL_NAMES)], pairs % len(MATERIAL_NAMES)
    ), kinds.reshape(both.shape)


def _numbers(s: Record, tables: Tables, scene: Scene, radii: Floats, materials: Integers) -> Floats:
    """Numbers of kinds that have these radii and materials; the tables of their laws are added."""
    sigma, force = scene.surface.roughness, float(s.force_unit)
    numbers, highest = np.empty((radii.size, KINDS)), float(s.population.highest) - GAP_LOW
    parts: list[tuple[Integers, list[AsperityLaw], Integers]] = []
    reach: dict[AsperityLaw, float] = {}
    friction, shear = friction_values(scene), scene.contact.friction_law == "shear"
    for material in scene.materials():
        index = MATERIAL_NAMES.index(material.name)
        rows = np.flatnonzero(materials == index)
        if rows.size == 0:
            continue
        tip, ratio = asperity_of(material.surface), radii[rows] / material.surface.asperity_radius
        units = tip.stretch_limit * np.cbrt(ratio) if tip.stretch_limit > 0.0 else np.full(rows.size, sigma)
        laws, which = _laws(scene.contact.asperity, material.surface, radii[rows])
        for number, law in enumerate(laws):
            far = highest * sigma / float(units[which == number].min())
            reach[law] = max(reach.get(law, 0.0), far)
        load = tip.hertz_factor * np.sqrt(ratio) * units**1.5 / force
        join, detach = (
            np.array([getattr(law, name) for law in laws])[which] * units / sigma
            for name in ("join", "detach")
        )
        numbers[rows, K_SCALE], numbers[rows, K_LOAD], numbers[rows, K_ENERGY] = (
            sigma / units,
            load,
            load * units / sigma,
        )
        numbers[rows, K_JOIN], numbers[rows, K_DETACH] = join, detach - RELEASED * (detach - join)
        numbers[rows, K_OFFSET], numbers[rows, K_MATERIAL] = material.gap_offset / sigma, index
        # contact areas are in units of pi times radius times unit of length
        numbers[rows, K_FRICTION] = friction[material.name] * (
            math.pi * radii[rows] * units / force if shear else 1.0
        )
        parts.append((rows, laws, which))
    offsets = {law: tables.add(asperity_table(law, far)) for law, far in reach.items()}
    areas = {
        law: tables.add(asperity_table(ContactArea(law), far)) if shear else 0 for law, far in reach.items()
    }
    for rows, laws, which in parts:
        numbers[rows, K_TABLE] = np.array([offsets[law] for law in laws])[which]
        numbers[rows, K_AREA] = np.array([areas[law] for law in laws])[which]
    return numbers


def _laws(name: str, surface: Surface, radii: Floats) -> tuple[list[AsperityLaw], Integers]:
    """Laws of tips of different radii, and which each has; one if those of the smallest and the largest are the same.

    Raises
    ------
    SceneError
        If there are more than can be tabulated.
    """
    least, most = (tip_law(name, surface, float(radius)).law for radius in (radii.min(), radii.max()))
    if least == most:
        return [least], np.zeros(radii.size, np.int64)
    if radii.size > MOST_LAWS:
        raise SceneError(
            "contact.asperity",
            name,
            f"has another law for each radius, of {radii.size}: there may be {MOST_LAWS} at most, or the law jkr",
        )
    return [tip_law(name, surface, radius).law for radius in radii.tolist()], np.arange(radii.size)
