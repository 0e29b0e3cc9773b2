"""Which contact model a scene takes, and the nodes of an elastic one.

Both decisions rest on the static contact: how far the bodies would deflect under the asperities' own pressure, and
how deep an impact of a given energy can go.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple, Self

import numpy as np

from gearidae.arrays import Floats
from gearidae.asperities import law_of
from gearidae.asperities.tip import asperity_of, contact_modulus
from gearidae.compiled import compiled
from gearidae.contact.bulk import LineGrid, between_nodes, line_grid, place_nodes
from gearidae.contact.kernels.law import GAP_HIGH, GAP_LOW, law_value, loading_table
from gearidae.engine.elastic.node_rows import FINER, point_count
from gearidae.scene import Material, Scene

NODES = 12
"""Nodes on one side of a contact, the middle included.

As shares of the largest force, on the rollers of Figs. 2 and 3 against 48 nodes: 12 hold the force to 4e-8 while teeth
close and to 4e-6 during detachment, 16 to 2e-8 and 2e-6.
"""
NODES_BY_DEPTH = ((-4.0, 12), (-13.0, 16), (-math.inf, 24))
"""Nodes of a contact that is pressed to a gap, in roughnesses: the deeper, the sharper its edge."""
DEPTH_HIGH = -GAP_LOW - 1.0
"""Depth of the deepest layout, in roughnesses."""
TAIL = 5.5
"""Roughnesses of gap at the outermost node, beyond the reach of stretched asperities, in a contact pressed to zero."""
ORDERS = 6
"""Powers of the contact length in the fit of the influence coefficients."""
RIGID_DEFLECTION = 0.02
"""Deflection in the middle, in roughnesses, below which the asperity model is taken to be enough: the asperities'
force at the same gap is then at most about 5 % too large."""
_FIRST_GAP = 10.0  # roughnesses from which a static curve is followed, and how
_GAP_STEP = 0.25
_TRIES = 25
_SETTLED = 1e-9


@dataclass(frozen=True, slots=True)
class ContactBounds:
    """Where a scene's contacts take place.

    Attributes
    ----------
    width : float
        Face width L [m].
    radius : float
        Radius R of unit length [m]: ``length = sqrt(R / radius)``.
    shortest, longest : float
        Range of that length along the path of contact.
    energy : float
        What drives the teeth into each other, as far as it is known beforehand [J].
    impact : float
        That part of it which is certain to be taken up by the contact [J].
    load : float
        Force that is to be carried in any case [N].
    start : float
        Gap at which the closest teeth begin, in roughnesses.
    """

    width: float
    radius: float
    shortest: float
    longest: float
    energy: float
    impact: float
    load: float
    start: float


@dataclass(frozen=True, slots=True)
class NodeGrid:
    """The numbers that `gearidae.engine.elastic.nodes` reads.

    Attributes
    ----------
    nodes, orders : int
        Nodes of a pair, and powers of length.
    middle, half : float
        Of the range of lengths.
    body : ndarray
        Of the nodes: profile ``s^2``, weights, influence coefficients column by column for each power. Of the points
        between them: profile, weights, and each point's shares of the nodes around it.
    """

    nodes: int
    orders: int
    middle: float
    half: float
    body: Floats


@lru_cache(maxsize=256)
def _line_grid(reach: float, width: float, modulus: float, nodes: int) -> LineGrid:
    """Grids are shared: the runs of a sweep mostly differ in something else."""
    return line_grid(reach, width, modulus, nodes)


def node_grid(
    scene: Scene, bounds: ContactBounds, force_unit: float, deepest: float, nodes: int | None = None
) -> NodeGrid:
    """Lay out the nodes of every pair.

    Parameters
    ----------
    force_unit : float
        Reference load [N].
    deepest : float
        Lowest gap that will occur, in roughnesses.
    nodes : int, optional
        Nodes on one side, the middle included; by depth if not given.
    """
    nodes = nodes or next(count for gap, count in NODES_BY_DEPTH if deepest >= gap)
    unit, reach = _extent(scene, bounds, deepest)
    orders = ORDERS if bounds.longest > bounds.shortest else 1
    middle = 0.5 * (bounds.longest + bounds.shortest)
    half = 0.5 * (bounds.longest - bounds.shortest) or 1.0
    nodes_of_length = np.polynomial.chebyshev.chebpts1(orders)
    x, weights = place_nodes(reach / unit, nodes)
    influence = [_influence(scene, bounds, middle + half * p, deepest, nodes).T for p in nodes_of_length]
    values = np.stack(influence) * force_unit
    powers = np.tensordot(np.linalg.inv(np.vander(nodes_of_length, increasing=True)), values, axes=1)
    finer, finer_weights = place_nodes(reach / unit, point_count(nodes))
    between = between_nodes(nodes, FINER)
    body = [x**2, weights, powers.ravel(), finer**2, finer_weights, between.ravel()]
    return NodeGrid(nodes, orders, middle, half, np.concatenate(body))


def _extent(scene: Scene, bounds: ContactBounds, deepest: float) -> tuple[float, float]:
    """``sqrt(2 R sigma)`` of a contact of unit length, and how far its outermost node lies from the middle [m]."""
    unit = math.sqrt(2.0 * bounds.radius * scene.surface.roughness)
    return unit, unit * math.sqrt(TAIL + _stretch(scene) + max(-deepest, 0.0))


def _influence(scene: Scene, bounds: ContactBounds, length: float, deepest: float, nodes: int) -> Floats:
    """Influence coefficients with ``w_i k_ij = w_j k_ji``, so that the force has a potential.

    Those of `line_grid` differ from it by the error of so few nodes. The mean of both sides has an error of that size.
    Deflections are in roughnesses, pressures in newtons per face width and unit length.
    """
    unit, reach = _extent(scene, bounds, deepest)
    modulus = contact_modulus(scene.surface.youngs_modulus, scene.surface.poisson_ratio)
    return _coefficients(unit, reach, length, bounds.width, modulus, scene.surface.roughness, nodes)


@lru_cache(maxsize=256)
def _coefficients(
    unit: float, reach: float, length: float, width: float, modulus: float, roughness: float, nodes: int
) -> Floats:
    """`_influence` of numbers; read-only, shared between runs as `_line_grid` is."""
    weights = place_nodes(reach / unit, nodes)[1]
    work = weights[:, None] * _line_grid(reach * length, width, modulus, nodes).compliance
    symmetric = 0.5 * (work + work.T) / weights[:, None]
    influence = np.asarray(symmetric / (width * unit * roughness))
    influence.setflags(write=False)
    return influence


def _stretch(scene: Scene) -> float:
    """How far asperities stretch at most, in roughnesses."""
    return max(
        law_of(scene.contact.asperity, material.surface).detach
        for material in scene.materials()
        if material.share > 0.0
    )


def deepest_gap(scene: Scene, bounds: ContactBounds) -> float:
    """Lowest gap to which energy and load press an elastic contact, in roughnesses, with a little to spare.

    The static curve of a closing contact is followed until its work has taken up the energy, or to its fold, or to the
    deepest tabulated gap; and no less deep than a scene begins.
    """
    depth = 4.0
    while True:
        lowest = _followed(scene, bounds, depth)
        if not math.isnan(lowest) or depth >= DEPTH_HIGH:
            lowest = -DEPTH_HIGH if math.isnan(lowest) else lowest
            return max(min(lowest, bounds.start) - 0.5, -DEPTH_HIGH)
        depth = min(2.0 * depth, DEPTH_HIGH)


def _followed(scene: Scene, bounds: ContactBounds, depth: float) -> float:
    """Gap at which a closing contact has taken up its energy or folds; NaN if it does neither down to a depth."""
    profile, weights, influence = _Widest.of(scene, bounds, -depth)
    surfaces, n = _laws(scene, bounds, scene.materials()), NODES
    deflection = np.zeros(n)
    work = last = 0.0
    for gap in np.arange(_FIRST_GAP, -depth - 0.5 * _GAP_STEP, -_GAP_STEP):
        change = math.inf
        for _ in range(_TRIES):
            pressure, slope = np.zeros(n), np.zeros(n)
            for table, scale, offset in surfaces:
                q = _loading(table, gap + offset + profile + deflection)
                pressure += scale * q[0]
                slope += scale * q[1]
            matrix = np.eye(n) - influence * slope
            try:
                step = np.linalg.solve(matrix, deflection - influence @ pressure)
            except (
                np.linalg.LinAlgError
            ):  # stiffness of bodies and adhesion just cancel: that is where it folds
                return float(gap) + _GAP_STEP
            deflection = deflection - step
            change = float(np.max(np.abs(step)))
            if change < _SETTLED:
                break
        if not change < _SETTLED or np.linalg.det(matrix) <= 0.0:
            return float(gap) + _GAP_STEP
        force = float(bounds.longest * weights @ pressure)
        work += 0.5 * (force + last) * _GAP_STEP * scene.surface.roughness
        last = force
        if work > bounds.energy and force > bounds.load:
            return float(gap)
    return math.nan


class _Widest(NamedTuple):
    """Nodes of the widest contact: profile, weights, and influence coefficients of pressures in newtons."""

    profile: Floats
    weights: Floats
    influence: Floats

    @classmethod
    def of(cls, scene: Scene, bounds: ContactBounds, deepest: float) -> Self:
        """Lay them out for contacts that are pressed to a gap, in roughnesses."""
        unit, reach = _extent(scene, bounds, deepest)
        x, weights = place_nodes(reach / unit, NODES)
        return cls(x**2, weights, _influence(scene, bounds, bounds.longest, deepest, NODES))


def _laws(
    scene: Scene, bounds: ContactBounds, materials: Sequence[Material]
) -> list[tuple[Floats, float, float]]:
    """Laws of an interface's materials, each with its scale and the material's gap offset in roughnesses."""
    sigma = scene.surface.roughness
    unit = bounds.width * math.sqrt(2.0 * bounds.radius * sigma)
    surfaces = []
    for surface, share, offset, _ in materials:
        if share > 0.0:
            tip = asperity_of(surface)
            # a copy: numba compiles everything a second time for arrays that are read-only
            table = loading_table(law_of(scene.contact.asperity, surface), "plane").copy()
            scale = share * surface.asperity_density * tip.hertz_factor * sigma**1.5 * unit
            surfaces.append((table, scale, offset / sigma))
    return surfaces


@compiled(makes_arrays=True)
def _loading(table: Floats, gaps: Floats) -> Floats:
    """Pressures on the way in and their slopes, one for each gap."""
    out = np.empty((2, gaps.size))
    for i in range(gaps.size):
        out[0, i], out[1, i] = law_value(table, gaps[i], gaps[i])
    return out


def rigid_limit(scene: Scene, bounds: ContactBounds) -> tuple[float, bool]:
    """Gap down to which the deflection of the bodies is negligible, and whether that suffices.

    Where shares change with tooth and position, each material may be alone somewhere: the one with the widest gap
    counts.

    Returns
    -------
    lowest : float
        Last gap, an eighth of a roughness apart, at which the asperities' pressure deflects the middle of the
        widest contact by no more than `RIGID_DEFLECTION`; in roughnesses.
    enough : bool
        Whether neither an impact nor the load is certain to press the teeth closer than that, nor do they begin there.
    """
    widest = _Widest.of(scene, bounds, -4.0)
    materials = scene.materials()
    mixtures: list[tuple[Material, ...]] = [materials]
    if scene.coating.by_place:
        mixtures = [(material._replace(share=1.0),) for material in materials if material.share > 0.0]
    limits = [_limit_of(scene, bounds, widest, material) for material in mixtures]
    return max(lowest for lowest, _ in limits), all(enough for _, enough in limits)


def _limit_of(
    scene: Scene, bounds: ContactBounds, widest: _Widest, materials: Sequence[Material]
) -> tuple[float, bool]:
    """`rigid_limit` of an interface of some materials."""
    profile, weights, influence = widest
    step = 0.125
    gaps = np.arange(GAP_HIGH, -4.0, -step)
    pressure = np.zeros((gaps.size, NODES))
    for table, scale, offset in _laws(scene, bounds, materials):
        pressure += scale * _loading(table, np.add.outer(gaps + offset, profile).ravel())[0].reshape(
            pressure.shape
        )
    force = bounds.longest * (pressure @ weights)
    work = np.cumsum(0.5 * (force + np.concatenate([[0.0], force[:-1]])) * step * scene.surface.roughness)
    deflected = np.flatnonzero(np.abs(pressure @ influence[0]) > RIGID_DEFLECTION)
    if not deflected.size:
        return -4.0, bounds.start > -4.0
    first = deflected[0]
    deep_enough = work[first] > bounds.impact and force[first] > bounds.load
    lowest = float(gaps[first]) + step
    return lowest, bool(deep_enough and bounds.start > lowest)
