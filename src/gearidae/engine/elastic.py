"""Which contact model a scene takes, and the nodes of an elastic one.

Both decisions rest on the static contact: how far the bodies would give way under the asperities' own pressure, and
how deep an impact of a given energy can go.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.contact.bulk import LineGrid, line_grid
from gearidae.contact.elastic import ElasticFoldError, elastic_line_curve
from gearidae.contact.jkr import asperity_of, contact_modulus
from gearidae.contact.law import GAP_HIGH, GAP_LOW, law_table, law_value
from gearidae.scene import Scene

__all__ = ["NODES", "RIGID_DEFLECTION", "Footing", "NodeGrid", "deepest_gap", "node_grid", "rigid_limit"]

Floats = NDArray[np.float64]

NODES = 16
"""Nodes on one side of a contact, the middle included.

Measured on the rollers of Figs. 2 and 3 against 40 nodes, as shares of the largest force: 12 nodes hold the force to
3e-8 while teeth close, 16 to 2e-8. On the way back, while the place where asperities let go travels across the nodes,
12 are off by 8e-5 at most, 16 by 4e-5, 24 by 2e-5, 32 by 1e-5; the energy lost is right to 4e-7 with 12.
"""
TAIL = 5.5
"""Roughnesses of gap at the outermost node, beyond the reach of stretched asperities, in a contact pressed to zero."""
ORDERS = 6
"""Powers of the footprint's length that stand for the influence coefficients."""
RIGID_DEFLECTION = 0.02
"""Deflection in the middle, in roughnesses, below which the asperity model is taken to be enough: the asperities'
force at the same gap is then at most about 5 % too large."""


@dataclass(frozen=True, slots=True)
class Footing:
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
    """

    width: float
    radius: float
    shortest: float
    longest: float
    energy: float
    impact: float
    load: float


@dataclass(frozen=True, slots=True)
class NodeGrid:
    """The numbers that `gearidae.engine.nodes` reads.

    Attributes
    ----------
    nodes, orders : int
        Nodes of a pair, and powers of length.
    middle, half : float
        Of the range of lengths.
    body : ndarray
        Profile ``s^2``, weights, and influence coefficients column by column for each power.
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
    scene: Scene, footing: Footing, force_unit: float, deepest: float, nodes: int = NODES
) -> NodeGrid:
    """Lay out the nodes of every pair.

    Parameters
    ----------
    scene : Scene
    footing : Footing
    force_unit : float
        Reference load [N].
    deepest : float
        Lowest gap that will occur, in roughnesses.
    nodes : int, optional
        Nodes on one side, the middle included.
    """
    sigma = scene.surface.roughness
    modulus = contact_modulus(scene.surface.youngs_modulus, scene.surface.poisson_ratio)
    unit = math.sqrt(2.0 * footing.radius * sigma)
    reach = unit * math.sqrt(TAIL + _stretch(scene) + max(-deepest, 0.0))
    orders = ORDERS if footing.longest > footing.shortest else 1
    middle = 0.5 * (footing.longest + footing.shortest)
    half = 0.5 * (footing.longest - footing.shortest) or 1.0
    places = np.polynomial.chebyshev.chebpts1(orders)
    grids = [_line_grid(reach * (middle + half * p), footing.width, modulus, nodes) for p in places]
    # pressures are in reference loads per face width and unit length
    pressure = force_unit / (footing.width * unit)
    values = np.stack([grid.compliance.T for grid in grids]) * (pressure / sigma)
    powers = np.tensordot(np.linalg.inv(np.vander(places, increasing=True)), values, axes=1)
    start = _line_grid(reach, footing.width, modulus, nodes)
    body = np.concatenate([(start.x / unit) ** 2, start.weights / unit, powers.ravel()])
    return NodeGrid(nodes, orders, middle, half, body)


def _stretch(scene: Scene) -> float:
    """How far asperities stretch at most, in roughnesses."""
    if scene.contact.asperity != "jkr":
        return 0.0
    fraction = scene.coating.sam_fraction
    shares = ((scene.surface, 1.0 - fraction), (scene.coated_surface, fraction))
    return max(asperity_of(s).stretch_limit / s.roughness for s, share in shares if share > 0.0)


def deepest_gap(scene: Scene, footing: Footing) -> float:
    """Lowest gap to which energy and load press an elastic contact, in roughnesses, with a little to spare.

    The static curve is followed until its work has taken up the energy, or to its fold, or to the deepest
    tabulated gap.
    """
    sigma = scene.surface.roughness
    radius = footing.radius * footing.longest**2
    depth = 4.0
    while True:
        gap = np.linspace(10.0, -depth, 4 * round(10.0 + depth) + 1)
        try:
            force = elastic_line_curve(
                gap * sigma,
                radius,
                footing.width,
                scene.surface,
                asperity=scene.contact.asperity,
                coated_surface=scene.coated_surface,
                sam_fraction=scene.coating.sam_fraction,
                nodes=12,
            ).force
        except ElasticFoldError as fold:
            return fold.gap / sigma - 0.5
        step = (gap[0] - gap[1]) * sigma
        work = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * step)])
        enough = np.flatnonzero((work > footing.energy) & (force > footing.load))
        if enough.size:
            return float(gap[enough[0]]) - 0.5
        if depth >= -GAP_LOW - 1.0:
            return GAP_LOW + 1.0
        depth = min(2.0 * depth, -GAP_LOW - 1.0)


@compiled
def _loading(table: Floats, gaps: Floats) -> Floats:
    """Pressures on the way in, one for each gap."""
    out = np.empty(gaps.size)
    for i in range(gaps.size):
        out[i] = law_value(table, gaps[i], gaps[i])[0]
    return out


def rigid_limit(scene: Scene, footing: Footing) -> tuple[float, bool]:
    """Gap down to which the bodies hardly give way, and whether that will do.

    Returns
    -------
    lowest : float
        Last gap, an eighth of a roughness apart, at which the asperities' pressure deflects the middle of the
        widest contact by no more than `RIGID_DEFLECTION`; in roughnesses.
    enough : bool
        Whether neither an impact nor the load is certain to press the teeth closer than that.
    """
    sigma, fraction = scene.surface.roughness, scene.coating.sam_fraction
    grid = node_grid(scene, footing, 1.0, -4.0)
    n = grid.nodes
    profile, weights = grid.body[:n], grid.body[n : 2 * n]
    powers = grid.body[2 * n :].reshape(grid.orders, n, n)
    x = (footing.longest - grid.middle) / grid.half
    middle = (powers[:, :, 0] * x ** np.arange(grid.orders)[:, None]).sum(axis=0)
    unit = footing.width * math.sqrt(2.0 * footing.radius * sigma)
    work, last = 0.0, 0.0
    step = 0.125
    for gap in np.arange(GAP_HIGH, -4.0, -step):
        pressure = np.zeros(n)
        for surface, share in ((scene.surface, 1.0 - fraction), (scene.coated_surface, fraction)):
            if share > 0.0:
                tip = asperity_of(surface)
                table = law_table(tip.stretch_limit / sigma, scene.contact.asperity, "plane")
                scale = share * surface.asperity_density * tip.hertz_factor * sigma**1.5 * unit
                pressure += scale * _loading(table, gap + profile)
        force = float(footing.longest * weights @ pressure)
        work += 0.5 * (force + last) * step * sigma
        last = force
        if abs(middle @ pressure) > RIGID_DEFLECTION:
            return float(gap) + step, bool(work > footing.impact and force > footing.load)
    return -4.0, True
