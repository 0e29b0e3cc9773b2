"""From a scene's surfaces, contact model and Hamaker constants to force scales, tables, nodes and attraction."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from gearidae.asperities import law_of
from gearidae.asperities.base import AsperityLaw
from gearidae.asperities.ranges import check_reach
from gearidae.asperities.tip import asperity_of
from gearidae.contact.attraction import FLOOR
from gearidae.contact.kernels.energy import energy_table, joining_energy, loading_pieces, number_table
from gearidae.contact.kernels.law import (
    GAP_LOW,
    H_STRETCH,
    HEADER,
    N_LOADING,
    Kernel,
    branch_length,
    force_scale,
    largest_forces,
    law_table,
)
from gearidae.engine.elastic.layout import ContactBounds, NodeGrid, deepest_gap, node_grid, rigid_limit
from gearidae.engine.elastic.node_rows import point_count, row_numbers
from gearidae.engine.model.state import MATERIALS, Record
from gearidae.engine.setup.build_friction import Limits
from gearidae.engine.setup.tables import Tables
from gearidae.errors import SceneError
from gearidae.scene import GearScene, Material, Scene
from gearidae.scene.combinations import may_deflect
from gearidae.scene.limits import MOST_PAIRS, pairs_within_reach

FORCE_FLOOR = 1e-13  # of the reference load: contact forces below it are taken as zero
CONTACT_FORCE = 1e-3  # of the reference load: what counts as contact in onset and separation events


class Nodes(NamedTuple):
    """Layout of the nodes of an elastic contact: lowest gap in roughnesses, nodes, and number of the layout."""

    lowest_gap: float
    nodes: int
    depth: int


def choose_model(s: Record, scene: Scene, bounds: ContactBounds, nodes: Nodes | None) -> NodeGrid | None:
    """Decide on elastic bodies, note how deep the contacts reach, and lay out their nodes if they have any."""
    s.lowest_gap, elastic = GAP_LOW, may_deflect(scene)  # where the tables of the force law end
    if elastic and scene.contact.bodies == "auto":
        s.lowest_gap, enough = rigid_limit(scene, bounds)
        elastic = not enough
    if not elastic:
        return None
    if nodes is None:
        deepest, count = min(deepest_gap(scene, bounds), 0.0), None
    else:
        deepest, count = nodes.lowest_gap, nodes.nodes
    grid = node_grid(scene, bounds, float(s.force_unit), deepest, count)
    s.nodes, s.points, s.orders = grid.nodes, point_count(grid.nodes), grid.orders
    s.length_middle, s.length_half_range = grid.middle, grid.half
    s.lowest_gap = deepest
    return grid


def add_nodes(s: Record, tables: Tables, grid: NodeGrid | None) -> None:
    """Lay out the constants of the nodes, and note how many numbers of them change."""
    if grid is None:
        return
    s.noting = 1
    n, points = grid.nodes, int(s.points)
    start = tables.add(grid.body)
    sizes = (n, n, grid.orders * n * n, points, points)
    starts = start + np.cumsum([0, *sizes])
    s.profile_at, s.weights_at, s.influence_at, s.point_profile_at, s.point_weights_at, s.shares_at = starts
    s.node_row_length = row_numbers(n)


def add_contact(
    s: Record, tables: Tables, scene: Scene, width: float, unit_length: float, widest: float
) -> None:
    """Lay out force laws and stored energies, and set the gaps where contact begins to count and to exist at all.

    Parameters
    ----------
    s : record
        ``SCENE``; changed.
    width, unit_length : float
        Face width, and ``sqrt(2 R sigma)`` of a contact of unit length [m].
    widest : float
        Largest contact length.
    """
    add_coverage(s, tables, scene)
    reach = {FORCE_FLOOR: GAP_LOW, CONTACT_FORCE: GAP_LOW}
    kernel: Kernel = "plane" if s.nodes > 0 else "line"
    loading, potential = np.zeros((2, MATERIALS, 8 * N_LOADING))
    limits = Limits(scene, kernel)
    longest = 0
    for material, (surface, share, offset, _) in enumerate(parts_of(scene)):
        record, tip = s.material[material], asperity_of(surface)
        record.gap_offset = offset / surface.roughness
        law = law_of(scene.contact.asperity, surface)
        check_reach(law, surface.roughness)
        table = law_table(law, kernel) if share > 0.0 else np.zeros(HEADER)
        energy = energy_table(law, kernel) if share > 0.0 else table
        scale = force_scale(surface.roughness, tip.hertz_factor, surface.asperity_density, width)
        force = share * scale * unit_length / float(s.force_unit)
        record.force_scale, record.stretch_limit = force, table[H_STRETCH]
        record.joining_energy = joining_energy(law) if share > 0.0 else 0.0
        record.table_at, record.energy_at = tables.add(table), tables.add(energy)
        record.number_at = tables.add(number_table(kernel, law.join))
        longest = max(longest, branch_length(table))
        if share > 0.0:
            push, stored = loading_pieces(law, kernel, float(record.gap_offset))
            loading[material], potential[material] = force * push, force * stored
            limits.add(s, tables, material, surface, law)
            for floor, gap in reach.items() if force * widest > 0.0 else ():  # a share may be too small
                widest_gap = _outermost(law, kernel, floor / (force * widest))
                reach[floor] = max(gap, widest_gap - float(record.gap_offset))
    s.cutoff, s.contact_gap = reach[FORCE_FLOOR], reach[CONTACT_FORCE]
    if s.covered_by_position == 0:  # shares that never change are mixed once
        loading, potential = loading.sum(axis=0), potential.sum(axis=0)
    limits.finish(s, tables)
    s.loading_at, s.potential_at = tables.add(loading.ravel()), tables.add(potential.ravel())
    s.branch_length, s.point_branch_length = (0, longest) if s.nodes > 0 else (longest, 0)


def parts_of(scene: Scene) -> tuple[Material, ...]:
    """Materials with the shares that their force scales hold: one each where shares change with tooth and position."""
    if not scene.coating.by_place:
        return scene.materials()
    return tuple(material._replace(share=1.0) for material in scene.materials())


def add_coverage(s: Record, tables: Tables, scene: Scene) -> None:
    """Lay out the fractions by tooth and position, if there are any."""
    if not scene.coating.by_place:
        return
    s.covered_by_position, s.patches = 1, int(scene.coating.pairing == "patches")
    for coverage, table in zip(s.coverage, scene.coating.tables, strict=True):
        add_fractions(coverage, tables, table, float(s.contact_ratio))


def add_fractions(
    coverage: Record, tables: Tables, table: Sequence[Sequence[float]], contact_ratio: float
) -> None:
    """Lay out a side's fractions by tooth and position; `coverage`, its ``COVERAGE``, is changed."""
    coverage.teeth, coverage.positions = len(table), len(table[0])
    coverage.values_at = tables.add(np.array(table).ravel())
    coverage.position_scale = len(table[0]) / contact_ratio


def _outermost(law: AsperityLaw, kernel: Kernel, least: float) -> float:
    """Widest gap at which this surface's force still exceeds `least`, on a grid of an eighth."""
    gaps, forces = largest_forces(law, kernel)
    felt = np.flatnonzero(forces > least)
    return float(gaps[felt[0]]) if felt.size else GAP_LOW


NEGLIGIBLE: Final = 1e-6
"""Of the reference load: attraction ends where it is as small. It falls with a power of the gap, unlike the force of
asperities, and the farther it reaches the more pairs of gears have a part in it."""
NEGLIGIBLE_ALONE: Final = 1e-20
"""The same for a roller, which is one pair anyway."""


def add_attraction(
    s: Record, tables: Tables, scene: Scene, width: float, unit_length: float, widest: float
) -> None:
    """Set the attraction of each material, and move the cut-off to where it is negligible; nothing without it.

    Parameters
    ----------
    s : record
        ``SCENE`` with its contact; changed.
    width, unit_length : float
        Face width, and ``sqrt(2 R sigma)`` of a contact of unit length [m].
    widest : float
        Largest contact length.

    Raises
    ------
    SceneError
        If it reaches more pairs than can be kept.
    """
    if not scene.attracts:
        return
    if scene.contact.is_discrete:
        add_coverage(s, tables, scene)
    sigma, cutoff = scene.surface.roughness, float(s.cutoff)
    s.attracts, s.attraction_floor = 1, FLOOR / sigma
    least = NEGLIGIBLE if isinstance(scene, GearScene) else NEGLIGIBLE_ALONE
    for material, (surface, share, offset, _) in zip(s.material, parts_of(scene), strict=False):
        force = surface.hamaker * width * unit_length / (16.0 * sigma**3)
        material.gap_offset, material.attraction = offset / sigma, share * force / float(s.force_unit)
        cutoff = max(
            cutoff, (float(material.attraction) * widest / least) ** 0.4 - float(material.gap_offset)
        )
    s.cutoff = cutoff
    if isinstance(scene, GearScene) and pairs_within_reach(scene, cutoff) > MOST_PAIRS:
        key = "surface.hamaker" if scene.surface.hamaker > 0.0 else "coating.hamaker"
        raise SceneError(
            key,
            max(scene.surface.hamaker, scene.coating.hamaker),
            f"attraction is felt {cutoff * sigma:.3g} m away beside so small a load, by more than the {MOST_PAIRS} "
            "tooth pairs of a flank that can be kept: needs a smaller constant, a larger torque or a smaller "
            "mesh.tip_relief_radius",
        )
