r"""Branches of a force law and their derivatives at the knots of its table, by quadrature over one asperity's law.

With joined heights shifted by the distance of joining (see `gearidae.contact.kernels.law`) the loading branch begins at
the displacement ``-join``, and what is stretched beyond lies between ``-join - S`` and ``-join``.

All are integrals of a load times the kernel at a knot plus an offset. Over a panel of offsets the kernel is a
polynomial to the last digit or two: it is worked out at a few nodes of the panel, once for all stretches, and the law
becomes weights at these nodes.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.asperities import AsperityLaw
from gearidae.contact.gauss import gauss_rule
from gearidae.contact.kernels.densities import kernel_at
from gearidae.contact.kernels.layout import KNOTS_PER_SIGMA, Kernel

PANEL: Final = 0.5
"""Longest panel of offsets, in roughnesses."""
PANEL_NODES: Final = 16
"""Chebyshev nodes of a panel."""
CLOSE_NODES: Final = 48
"""Nodes of the rule over the law from joining to half a roughness of compression, where the load is not smooth; """
FAR_NODES: Final = 12
"""those over half a roughness beyond;"""
STRETCHED_NODES: Final = 16
"""and those over a panel of stretched asperities."""
KERNEL_END: Final = 12.0
"""Beyond which the kernel is nothing."""


def loading_derivatives(gap: Floats, law: AsperityLaw, kernel: Kernel) -> Floats:
    """q(G, 0) and three derivatives, shape (4, n), for gaps on a grid of `KNOTS_PER_SIGMA`.

    Panels of compression lie on the same grid, so that all gaps share the values of the kernel.
    """
    half, panels = round(PANEL * KNOTS_PER_SIGMA), math.ceil((KERNEL_END - gap[0]) / PANEL)
    begin = PANEL * np.arange(panels)
    steps = gap[0] + np.arange(len(gap) + (panels - 1) * half) / KNOTS_PER_SIGMA
    values = kernel_at(kernel, steps[:, None] + PANEL * _panel_nodes())
    result = np.zeros((4, len(gap)))
    for panel, weights in enumerate(
        (*_compressed(law, begin[:1], CLOSE_NODES), *_compressed(law, begin[1:], FAR_NODES))
    ):
        result += values[:, panel * half : panel * half + len(gap)] @ weights
    if law.join > 0.0:
        edges = np.linspace(-law.join, 0.0, math.ceil(law.join / PANEL) + 1)
        rule = law.nodes(edges[:-1], edges[1:], *gauss_rule(CLOSE_NODES))
        offset, weight = (numbers.reshape(1, -1) for numbers in rule)
        result += _integrals(gap, (-law.join, law.join), offset, weight, kernel)[:, :, 0]
    return result


def _compressed(law: AsperityLaw, begin: Floats, count: int) -> Floats:
    """Weights at the nodes of panels of compression, from a rule of so many nodes, shape (panels, PLACES)."""
    offset, weight = law.nodes(begin, begin + PANEL, *gauss_rule(count))
    return _weights_at_nodes((offset - begin[:, None]) / PANEL, weight)


def stretched_derivatives(joined: Floats, law: AsperityLaw, v: Floats, kernel: Kernel) -> Floats:
    """t(Z, S) and three derivatives in Z at fixed S = D (1 - v^2), shape (4, n, len(v))."""
    limit = law.detach - law.join
    stretch = limit * (1.0 - v**2)
    # rounding must not carry the first node beyond the fold
    low = np.maximum(-stretch - law.join, -law.detach)
    edges = np.linspace(low, -law.join, 2 + int(limit / PANEL), axis=1)
    rule = law.nodes(edges[:, :-1], edges[:, 1:], *gauss_rule(STRETCHED_NODES))
    delta, weight = (numbers.reshape(len(v), -1) for numbers in rule)
    return _integrals(joined, (-law.join, limit), stretch[:, None] + delta, weight, kernel)


def _integrals(
    knots: Floats, reach: tuple[float, float], offset: Floats, weight: Floats, kernel: Kernel
) -> Floats:
    """Sums of the kernel with three derivatives at knots plus offsets, shape (4, n, m).

    Parameters
    ----------
    knots : ndarray, shape (n,)
    reach : tuple of float
        Where the offsets begin, and over which length they lie.
    offset, weight : ndarray, shape (m, nodes)
        Offsets at which to take the kernel, and the weights of these values.
    kernel : {"line", "plane"}
    """
    low, length = reach
    panels = math.ceil(length / PANEL)
    panel = length / panels
    position = (offset - low) / panel
    which = np.clip(position.astype(int), 0, panels - 1)
    result = np.zeros((4, len(knots), len(offset)))
    for k in range(panels):
        inside = which == k
        weights = _weights_at_nodes(np.where(inside, position - k, 0.0), np.where(inside, weight, 0.0))
        result += kernel_at(kernel, knots[:, None] + (low + panel * (k + _panel_nodes()))) @ weights.T
    return result


@cache
def _panel_nodes() -> Floats:
    """Chebyshev nodes of a panel, as parts of it."""
    return np.asarray(0.5 * (np.polynomial.chebyshev.chebpts1(PANEL_NODES) + 1.0))


@cache
def _values_to_nodes() -> Floats:
    """Matrix from integrals of Chebyshev polynomials to weights at the nodes."""
    terms = np.polynomial.chebyshev.chebvander(2.0 * _panel_nodes() - 1.0, PANEL_NODES - 1)
    terms[:, 0] *= 0.5
    return np.asarray(terms.T * (2.0 / PANEL_NODES))


def _weights_at_nodes(part: Floats, weight: Floats) -> Floats:
    """Weights at a panel's `_panel_nodes` that do for any smooth function what other weights do elsewhere in the panel.

    Parameters
    ----------
    part, weight : ndarray, shape (m, nodes)
        Where in the panel, from 0 to 1, and the weights there.

    Returns
    -------
    ndarray, shape (m, PLACES)
    """
    terms = np.polynomial.chebyshev.chebvander(2.0 * part - 1.0, PANEL_NODES - 1)
    return np.asarray((weight[:, None, :] @ terms)[:, 0] @ _values_to_nodes())
