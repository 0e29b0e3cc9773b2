r"""Pieces of polynomials of which a table is made: septic Hermite in gap or height, Chebyshev in what is regular."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from gearidae.arrays import Floats
from gearidae.asperities import AsperityLaw
from gearidae.contact.kernels.densities import kernel_at_knots
from gearidae.contact.kernels.division import Division
from gearidae.contact.kernels.knots import stretched_derivatives
from gearidae.contact.kernels.layout import DEGREE, GAP_HIGH, GAP_LOW, KNOTS_PER_SIGMA, STRETCH_HIGH, Kernel


def _scaled(x: Floats, derivatives: Floats, positive: bool) -> Floats:
    """Derivatives of ``exp(x^2/2) f`` from f and its own (first axis), on the side x > 0; f itself on the other."""
    if not positive:
        return derivatives
    x = np.maximum(x, 0.0)
    grow = np.exp(0.5 * x**2)
    g = (grow, x * grow, (1.0 + x**2) * grow, (3.0 * x + x**3) * grow)
    out = np.zeros_like(derivatives)
    for k in range(4):
        for i in range(k + 1):
            factor = g[k - i].reshape(-1, *[1] * (derivatives.ndim - 2))
            out[k] += math.comb(k, i) * factor * derivatives[i]
    return out


@lru_cache(maxsize=1)
def hermite_matrix() -> Floats:
    """Matrix from (f, h f', h^2 f'', h^3 f''') at both ends of a piece to its powers of u in 0..1."""
    rows = [
        [math.perm(p, k) * (u ** (p - k) if p >= k else 0.0) for p in range(8)]
        for u in (0.0, 1.0)
        for k in range(4)
    ]
    return np.linalg.inv(np.array(rows))


def hermite_pieces(knots: Floats, derivatives: Floats) -> Floats:
    """Septic Hermite pieces of a function given with three derivatives, scaled by ``exp(max(x, 0)^2/2)``.

    Parameters
    ----------
    knots : ndarray, shape (n + 1,)
    derivatives : ndarray, shape (4, n + 1, ...)

    Returns
    -------
    ndarray, shape (n, 8, ...)
        Coefficients of u^0 .. u^7, u in 0..1 across the piece.
    """
    h = 1.0 / KNOTS_PER_SIGMA
    left, right = _scaled(knots, derivatives, False), _scaled(knots, derivatives, True)
    powers = h ** np.arange(4.0)
    side = (knots[:-1] >= 0.0).reshape(-1, *[1] * (derivatives.ndim - 2))
    ends = [
        np.where(side, right[k][span], left[k][span]) * powers[k]
        for span in (slice(None, -1), slice(1, None))
        for k in range(4)
    ]
    ends_of_pieces = np.stack(ends, axis=1)
    # piece by piece: one product of all would start threads, which runs side by side have no use for
    pieces = hermite_matrix() @ ends_of_pieces.reshape(*ends_of_pieces.shape[:2], -1)
    return np.asarray(pieces.reshape(ends_of_pieces.shape))


def partial_pieces(
    joined: Floats, end: Floats, law: AsperityLaw, division: Division, kernel: Kernel
) -> Floats:
    """Pieces of t(Z, S) as ``t(Z, D) + v^2 times a polynomial`` (regular slope at the fold): the polynomial.

    Returns
    -------
    ndarray, shape (n, pieces, 8, DEGREE + 1)
        Powers of u, then of the position in the piece of v.
    """
    nodes = np.polynomial.chebyshev.chebpts1(DEGREE + 1)
    to_powers = np.linalg.inv(np.vander(nodes, increasing=True))
    v = np.stack([np.asarray(division.at(piece, 0.5 * (nodes + 1.0))) for piece in range(division.pieces)])
    rest = (stretched_derivatives(joined, law, v.ravel(), kernel) - end) / v.ravel() ** 2
    pieces = hermite_pieces(joined, rest).reshape(-1, 8, *v.shape) @ to_powers.T
    return np.moveaxis(pieces, 2, 1)


@lru_cache(maxsize=2)
def kernel_table(kernel: Kernel) -> Floats:
    """Pieces of the kernel itself, for the branch that is integrated on demand; the first knot in front."""
    low = GAP_LOW - STRETCH_HIGH - 1.0
    knots = low + np.arange(round((GAP_HIGH - low) * KNOTS_PER_SIGMA) + 1) / KNOTS_PER_SIGMA
    return np.concatenate([[low], hermite_pieces(knots, kernel_at_knots(kernel, knots)).ravel()])


def asperity_pieces(law: AsperityLaw, division: Division) -> Floats:
    """Pieces of one asperity's load while it is stretched, and of the work that stretching it has taken.

    Both are smooth in ``e = sqrt((Delta + detach) / D)``, from the fold e = 0, where an asperity detaches, to e = 1,
    where it joins.

    Returns
    -------
    ndarray
        Distance of joining; powers of the position in the piece, -1..1, of the load; powers of it, of the work.
    """
    nodes = np.polynomial.chebyshev.chebpts1(DEGREE + 1)
    to_powers = np.linalg.inv(np.vander(nodes, increasing=True))
    parts = 0.5 * (nodes + 1.0)
    e = np.stack([np.asarray(division.at(piece, parts)) for piece in range(division.pieces)])
    delta = (law.detach - law.join) * e**2 - law.detach
    work = law.energy(-law.join) - law.energy(delta)
    return np.concatenate([[law.join], (law.load(delta) @ to_powers.T).ravel(), (work @ to_powers.T).ravel()])
