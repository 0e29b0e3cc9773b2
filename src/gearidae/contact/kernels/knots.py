r"""Branches of a force law and their derivatives at the knots of its table, by quadrature over one asperity's law.

With joined heights shifted by the distance of joining (see `gearidae.contact.kernels.law`) the loading branch begins at
the displacement ``-join``, and what is stretched beyond lies between ``-join - S`` and ``-join``.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Final

import numpy as np

from gearidae.asperities import AsperityLaw
from gearidae.contact.gauss import gauss_rule
from gearidae.contact.kernels.densities import kernel_at
from gearidae.contact.kernels.layout import KNOTS_PER_SIGMA, Floats, Kernel

__all__ = ["loading_derivatives", "stretched_derivatives"]

GAUSS: Final = 16
PANEL: Final = 0.5  # longest panel, in roughnesses


def _close_nodes(law: AsperityLaw) -> tuple[Floats, Floats]:
    """Gauss nodes and weights from joining to half a roughness of compression, where the load is not smooth."""
    rule = gauss_rule(48)
    edges = np.linspace(-law.join, 0.0, math.ceil(law.join / PANEL) + 1)
    parts = [law.nodes(low, high, *rule) for low, high in pairwise([*edges, PANEL])]
    delta, weight = (np.concatenate(column) for column in zip(*parts, strict=True))
    return delta, weight


def loading_derivatives(gap: Floats, law: AsperityLaw, kernel: Kernel) -> Floats:
    """q(G, 0) and three derivatives, shape (4, n), for gaps on a grid of `KNOTS_PER_SIGMA`.

    Beyond the first half roughness the compression is integrated by panels of half a roughness, so that all gaps
    share the values of the kernel.
    """
    delta, weight = _close_nodes(law)
    result = np.einsum("i,kji->kj", weight, kernel_at(kernel, gap[:, None] + delta[None, :]))
    x, w = gauss_rule(12)
    within, half = 0.25 * (x + 1.0), KNOTS_PER_SIGMA // 2
    panels = math.ceil((12.0 - gap[0]) / PANEL)
    step = np.arange(len(gap) + panels * half)
    shared = kernel_at(kernel, (gap[0] + step / KNOTS_PER_SIGMA)[:, None] + within[None, :])
    load_weights = 0.25 * w * law.load(0.5 * np.arange(panels)[:, None] + within)
    for panel in range(1, panels):
        first = panel * half
        result += shared[:, first : first + len(gap)] @ load_weights[panel]
    return np.asarray(result)


def stretched_derivatives(joined: Floats, law: AsperityLaw, v: Floats, kernel: Kernel) -> Floats:
    """t(Z, S) and three derivatives in Z at fixed S = D (1 - v^2), shape (4, n, len(v))."""
    limit = law.detach - law.join
    rule = gauss_rule(GAUSS)
    result = np.empty((4, len(joined), len(v)))
    panels = 1 + int(limit / PANEL)
    for m, value in enumerate(v):
        stretch = limit * (1.0 - value**2)
        # rounding must not carry the first node beyond the fold
        edges = np.linspace(max(-stretch - law.join, -law.detach), -law.join, panels + 1)
        total = np.zeros((4, len(joined)))
        for low, high in pairwise(edges):
            delta, weight = law.nodes(low, high, *rule)
            total += kernel_at(kernel, joined[:, None] + (stretch + delta)[None, :]) @ weight
        result[:, :, m] = total
    return result
