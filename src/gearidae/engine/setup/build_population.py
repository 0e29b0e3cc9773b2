"""From a scene's asperities to the tables and rows of a population."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.asperities import AsperityLaw, law_of_tip
from gearidae.asperities.area import ContactArea
from gearidae.asperities.tip import asperity_of
from gearidae.contact.kernels.layout import GAP_LOW
from gearidae.contact.kernels.single import asperity_table
from gearidae.engine.model.state import Floats, Record
from gearidae.engine.population.candidates import LEVELS
from gearidae.engine.population.layout import FIELDS, K_DETACH, K_JOIN, KINDS
from gearidae.engine.setup.build_contact import add_fractions
from gearidae.engine.setup.tables import Tables
from gearidae.errors import SceneError
from gearidae.populations.flanks import FlankAsperities, flanks_digest, flanks_of
from gearidae.populations.materials import materials_met
from gearidae.scene import MATERIAL_NAMES, Scene
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
    own, sigma, flanks = s.population, scene.surface.roughness, flanks_of(scene)
    counts = np.array([one.arc.size for one in flanks])
    if counts.sum() == 0:
        listed, density = scene.contact.asperities, scene.surface.asperity_density
        key, value = ("contact.asperities", "(none)") if listed else ("surface.asperity_density", density)
        raise SceneError(key, value, "gives no asperity on any flank: a population needs some")
    length = float(s.base_pitch) if scene.gears is not None else steepness * sigma
    arcs = np.concatenate([one.arc for one in flanks]) / length
    heights = np.concatenate([one.height for one in flanks]) / sigma
    own.flanks, own.steepness, own.arc_scale = len(flanks), steepness, arc_scale
    own.highest, own.capacity = float(heights.max()), max(int(counts.max()), 1)
    own.arcs_at, own.heights_at = tables.add(arcs), tables.add(heights)
    _add_levels(own, tables, heights, counts)
    numbers, kinds = _kinds(s, tables, scene, flanks)
    first = tables.add(numbers.ravel())
    own.kinds_at, *bare = (tables.add((first + KINDS * row).astype(np.float64)) for row in kinds)
    if bare:
        own.by_gear_tooth, (own.bare_kinds_at,) = 1, bare
        own.gear_numbers_at = tables.add(np.concatenate([one.q2 for one in flanks]))
        add_fractions(s.coverage[1], tables, scene.coating.gear_table, float(s.contact_ratio))
    own.join = float(numbers[:, K_JOIN].max())
    digest = flanks_digest(flanks)
    own.digest = [float(int(digest[8 * k : 8 * k + 8], 16)) for k in range(4)]
    own.quiet = int(not scene.run.asperity_events)
    s.cutoff = s.contact_gap = max(own.highest + float(numbers[:, K_DETACH].max()) + BEYOND, LEAST_CUTOFF)


def population_rows(s: Record) -> Floats:
    """Rows of the candidates of all histories, blank."""
    return np.zeros(int(s.histories * FIELDS * s.population.capacity))


def _add_levels(own: Record, tables: Tables, heights: Floats, counts: Integers) -> None:
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
    own.starts_at, own.listed_at = tables.add(np.concatenate(starts)), tables.add(np.concatenate(listed))


def _kinds(
    s: Record, tables: Tables, scene: Scene, flanks: tuple[FlankAsperities, ...]
) -> tuple[Floats, Integers]:
    """Numbers of each kind, and the kind of each asperity in the rows of `materials_met`.

    A kind is a material with a radius.
    """
    radii, of_radius = np.unique(np.concatenate([one.radius for one in flanks]), return_inverse=True)
    material = np.concatenate([materials_met(scene, one) for one in flanks], axis=1)
    both = len(MATERIAL_NAMES) * of_radius.ravel() + material
    pairs, kinds = np.unique(both.ravel(), return_inverse=True)
    sigma, by_name = scene.surface.roughness, {one.name: one for one in scene.materials()}
    highest = float(s.population.highest) - GAP_LOW
    tips, friction = [], friction_values(scene)
    reach: dict[AsperityLaw, float] = {}
    for pair in pairs.tolist():
        radius, one = radii[pair // len(MATERIAL_NAMES)], by_name[MATERIAL_NAMES[pair % len(MATERIAL_NAMES)]]
        tip = asperity_of(one.surface.model_copy(update={"asperity_radius": float(radius)}))
        unit = tip.stretch_limit if tip.stretch_limit > 0.0 else sigma
        law = law_of_tip(scene.contact.asperity, tip, unit)
        strength = (
            math.pi * float(radius) / float(s.force_unit)
        )  # times the unit of length and the shear strength
        tips.append((law, tip.hertz_factor, unit, one.gap_offset, friction[one.name], strength))
        reach[law] = max(reach.get(law, 0.0), highest * sigma / unit)
        if len(reach) > MOST_LAWS:
            raise SceneError(
                "contact.asperity",
                scene.contact.asperity,
                f"has another law for each radius, of {radii.size}: there may be {MOST_LAWS} at most, or the law jkr",
            )
    places = {law: tables.add(asperity_table(law, far)) for law, far in reach.items()}
    numbers = np.empty((pairs.size, KINDS))
    shear = scene.contact.friction_law == "shear"
    areas = {
        law: tables.add(asperity_table(ContactArea(law), far)) if shear else 0 for law, far in reach.items()
    }
    for row, (pair, (law, factor, unit, offset, value, strength)) in enumerate(zip(pairs, tips, strict=True)):
        load, join, detach = factor * unit**1.5, law.join * unit / sigma, law.detach * unit / sigma
        numbers[row] = (
            places[law],
            sigma / unit,
            load / float(s.force_unit),
            load * unit / (float(s.force_unit) * sigma),
            join,
            detach - RELEASED * (detach - join),
            offset / sigma,
            pair % len(MATERIAL_NAMES),
            strength * unit * value if shear else value,
            areas[law],
        )
    return numbers, kinds.reshape(both.shape)
