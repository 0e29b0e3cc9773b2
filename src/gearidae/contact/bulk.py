r"""The bodies under the asperities: two elastic half-spaces pressed along a strip of finite width.

The pressure is uniform across the face width L, and its deflection is averaged across it. Boussinesq's 1/r then
leaves a kernel in the distance xi along the contact alone,

.. math::

    d(x) = \frac{1}{\pi E^*} \int p(x')\, k(|x - x'|)\,\mathrm{d}x', \qquad
    k(\xi) = \frac1L \iint_0^L \frac{\mathrm{d}y\,\mathrm{d}y'}{\sqrt{\xi^2 + (y - y')^2}}
           = 2\left[\operatorname{asinh}\frac L\xi - \frac{L}{\sqrt{\xi^2 + L^2} + \xi}\right],

logarithmic close by, L/xi far away, so that no reference depth is needed. d is the approach of both bodies together.

References
----------
A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929) 377-420, doi:10.1098/rsta.1929.0009.
K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, sections 3.2-3.3, doi:10.1017/CBO9781139171731.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearidae.errors import SceneError

Array = NDArray[np.float64]

_FINE = 64
"""Straight pieces between two nodes that stand for the smooth pressure there."""
_GRADING = 1.2
STENCIL: Final = 8
"""Nodes that a value between them is made of."""


def _first_integral(distance: Array, width: float) -> Array:
    """Integrate the kernel from 0 to a signed distance: odd."""
    xi = np.abs(distance)
    with np.errstate(divide="ignore", invalid="ignore"):
        near = np.where(xi > 0.0, 2.0 * xi * np.arcsinh(width / xi), 0.0)
    far = width * np.arcsinh(xi / width) - xi * width / (np.hypot(xi, width) + xi)
    return np.asarray(np.copysign(near + far, distance))


def _first_moment(distance: Array, width: float) -> Array:
    """Integrate distance times kernel from 0 to a signed distance: even."""
    xi = np.abs(distance)
    r = np.hypot(xi, width)
    with np.errstate(divide="ignore", invalid="ignore"):
        near = np.where(xi > 0.0, xi**2 * np.arcsinh(width / xi), 0.0)
    # r^3 - L^3 - xi^3 over L, with the difference of the largest two taken out: r^2 - xi^2 = L^2.
    cubes = width * (r**2 + r * xi + xi**2) / (r + xi) - width**2
    return near + width * (r - width) - 2.0 / 3.0 * cubes


def bulk_influence(points: ArrayLike, knots: ArrayLike, width: float, modulus: float) -> Array:
    """Deflection coefficients of a symmetric pressure that is linear between knots.

    Parameters
    ----------
    points : array_like, shape (n,)
        Where the deflection is wanted [m].
    knots : array_like, shape (m,)
        Increasing distances from the middle, the first of them 0 [m]. The pressure is given there, linear between,
        the same on both sides, and zero beyond the last.
    width : float
        Face width L [m].
    modulus : float
        Contact modulus E* [Pa].

    Returns
    -------
    ndarray, shape (n, m)
        Approach of both bodies at each point per pressure at each knot [m/Pa].

    Raises
    ------
    SceneError
        If there are fewer than two knots, or they do not increase from 0.
    """
    x = np.asarray(points, dtype=np.float64)
    edges = np.asarray(knots, dtype=np.float64)
    if edges.ndim != 1 or edges.size < 2 or edges[0] != 0.0 or not np.all(np.diff(edges) > 0.0):
        raise SceneError("knots", np.array2string(edges, threshold=6), "must increase from 0")
    total = np.zeros((x.size, edges.size))
    step = np.diff(edges)
    for side in (1.0, -1.0):
        to_edge = edges - side * x[:, None]
        area = np.diff(_first_integral(to_edge, width))
        # Moment about the left end of each piece: how much of its area hangs on the right end.
        moment = np.diff(_first_moment(to_edge, width)) - to_edge[:, :-1] * area
        total[:, 1:] += moment / step
        total[:, :-1] += area - moment / step
    return total / (math.pi * modulus)


@dataclass(frozen=True, slots=True, eq=False)
class LineGrid:
    """Nodes on one side of a symmetric line contact.

    Attributes
    ----------
    x : ndarray, shape (n,)
        Distances from the middle [m], the first 0, closer together near it.
    weights : ndarray, shape (n,)
        ``weights @ p`` is the integral of p over both sides [m].
    compliance : ndarray, shape (n, n)
        ``compliance @ p`` is the deflection of both bodies at the nodes [m], p in Pa.
    """

    x: Array
    weights: Array
    compliance: Array


def line_grid(reach: float, width: float, modulus: float, nodes: int) -> LineGrid:
    """Nodes, weights and deflection coefficients for a smooth symmetric pressure.

    Nodes lie at ``x = reach sinh(c u)/sinh(c)``, c = 1.2 and u uniform over 0..1, and the pressure between them is the
    cosine polynomial in u through its values: for a pressure that has died away at the end this converges faster than
    any power of the number of nodes. Its deflection is that of `bulk_influence` on a much finer set of knots.

    Parameters
    ----------
    reach : float
        Distance beyond which there is no pressure to speak of [m].
    width : float
        Face width L [m].
    modulus : float
        Contact modulus E* [Pa].
    nodes : int
        Number of nodes n on one side, the middle included; at least 4.

    Raises
    ------
    SceneError
        If a length or the modulus is not positive, or there are fewer than 4 nodes.
    """
    for key, value in (("reach", reach), ("width", width), ("modulus", modulus)):
        if not 0.0 < value < math.inf:
            raise SceneError(key, value, "must be a positive number")
    if nodes < 4:
        raise SceneError("nodes", nodes, "must be 4 or more")
    order = np.arange(nodes)
    ends = np.where((order == 0) | (order == nodes - 1), 0.5, 1.0)
    fine = np.linspace(0.0, 1.0, _FINE * (nodes - 1) + 1)
    knots = reach * np.sinh(_GRADING * fine) / math.sinh(_GRADING)
    x = knots[::_FINE].copy()
    # Cardinal functions of the cosine polynomial, through the discrete cosine transform of type I.
    cosines = np.cos(math.pi * np.outer(order, order) / (nodes - 1))
    cardinals = (
        np.cos(math.pi * np.outer(fine, order)) @ (ends[:, None] * cosines * ends) * (2.0 / (nodes - 1))
    )
    slope = _GRADING * reach * np.cosh(_GRADING * fine) / math.sinh(_GRADING)
    simpson = np.full(fine.size, 2.0)
    simpson[1::2] = 4.0
    simpson[[0, -1]] = 1.0
    weights = 2.0 / (3.0 * (fine.size - 1)) * (simpson * slope) @ cardinals
    return LineGrid(x, weights, bulk_influence(x, knots, width, modulus) @ cardinals)


@lru_cache(maxsize=64)
def place_nodes(reach: float, nodes: int) -> tuple[Array, Array]:
    """Where `line_grid` has its nodes, and weights by the trapezoidal rule in u.

    For a pressure that has died away at the end they are as good as those of the grid, and those of nodes and of points
    between them go together.

    Parameters
    ----------
    reach : float
        Distance beyond which there is no pressure to speak of.
    nodes : int
        Nodes on one side, the middle included.

    Returns
    -------
    x, weights : ndarray, shape (n,)
        Read-only, shared between callers.
    """
    u = np.linspace(0.0, 1.0, nodes)
    x = reach * np.sinh(_GRADING * u) / math.sinh(_GRADING)
    weights = 2.0 * np.hypot(_GRADING * x, _GRADING * reach / math.sinh(_GRADING)) / (nodes - 1)
    weights[[0, -1]] *= 0.5
    for array in (x, weights):
        array.setflags(write=False)
    return x, weights


@lru_cache(maxsize=16)
def between_nodes(nodes: int, finer: int) -> Array:
    """Interpolation of an even function of u from nodes to points between them, by polynomials of degree seven.

    Parameters
    ----------
    nodes : int
        Nodes on one side, the middle included; at least `STENCIL`.
    finer : int
        Steps from point to point in one from node to node.

    Returns
    -------
    ndarray, shape (finer * (nodes - 1) + 1, STENCIL)
        Read-only. Point m's shares of the nodes from
        ``min(max(m // finer - STENCIL // 2 + 1, 0), nodes - STENCIL)`` on.
    """
    matrix = np.zeros((finer * (nodes - 1) + 1, STENCIL))
    for m in range(matrix.shape[0]):
        first = min(m // finer - STENCIL // 2 + 1, nodes - STENCIL)
        stencil = np.arange(first, first + STENCIL)
        for k in stencil:  # left of the middle lie the same values as right of it
            others = stencil[stencil != k]
            matrix[m, abs(k) - max(first, 0)] += np.prod((m / finer - others) / (k - others))
    matrix.setflags(write=False)
    return matrix
