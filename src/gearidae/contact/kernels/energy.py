r"""What a rough contact stores: the potential of its force law, compiled, tabulated alike.

An asperity holds the energy :math:`E(\Delta) = \int_{-D}^{\Delta} \hat p\,d\Delta'`, counted from the instant at which
it detaches. With G, Z, S and D as in `law`, a contact whose asperities above Z are joined stores

.. math::

    U(G, Z) = \int_{-S}^{\infty} E(\Delta)\,\psi(G + \Delta)\,d\Delta = A(G) + e(Z, S), \qquad
    A(G) = \int_G^\infty q(G', 0)\,dG',

.. math::

    e(Z, S) = E(0)\,\Psi(Z) - \int_0^S t(Z, S')\,dS', \qquad \Psi(Z) = \int_Z^\infty \psi(z)\,dz,

with :math:`\partial U / \partial G = -q` while Z stays. At full stretch e is a function :math:`V(Z)` of one variable,
:math:`V' = -t(Z, D)`, so that

.. math::

    e(Z, S) = V(Z) + \int_S^D t(Z, S')\,dS'.

An asperity that joins drops from nothing to :math:`E(0)` (for JKR :math:`-0.93550\, P_c d_c`), and nothing more is lost
at detachment. A surface without stretch has no such drop: E is counted from touching, e = 0.

Asperities that join before they touch drop to :math:`E(-d_\mathrm{on})`. With Z and S as in `law` the same holds, where
:math:`\Psi(Z)` counts the asperities above the height that Z stands for, :math:`Z - d_\mathrm{on}`.

The integrals are taken over the polynomials of a law's own table, so that table and potential agree as closely as the
table and the law. The potential has the law's layout: A in the place of the loading branch, V in that of t(Z, D), e in
that of t(Z, S), and what reads the one reads the other.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.asperities import AsperityLaw
from gearidae.compiled import compiled
from gearidae.contact.gauss import gauss_rule
from gearidae.contact.kernels.densities import kernel_at_knots
from gearidae.contact.kernels.division import Division
from gearidae.contact.kernels.evaluate import integrated_work, stretched_value
from gearidae.contact.kernels.knots import loading_derivatives
from gearidae.contact.kernels.law import law_table, stretch_followed
from gearidae.contact.kernels.layout import (
    DEGREE,
    GAP_HIGH,
    GAP_LOW,
    H_COUNT,
    H_END,
    H_LOW,
    H_MODE,
    H_PARTIAL,
    H_STRETCH,
    HEADER,
    KNOTS_PER_SIGMA,
    MODE_INTEGRATED,
    MODE_TABLE,
    N_LOADING,
    Kernel,
)
from gearidae.contact.kernels.pieces import hermite_matrix, hermite_pieces

_GAUSS: Final = 16


def joining_energy(law: AsperityLaw) -> float:
    """Energy that an asperity loses when it joins, in the unit of the force law times the roughness.

    Parameters
    ----------
    law : AsperityLaw
        In units of the roughness.

    Returns
    -------
    float
        0 where the surface has no hysteresis worth following.
    """
    return law.loss if stretch_followed(law) > 0.0 else 0.0


@lru_cache(maxsize=32)
def energy_table(law: AsperityLaw, kernel: Kernel = "line") -> Floats:
    """Tabulate the stored energy that goes with a force law.

    Parameters
    ----------
    law, kernel
        As for `gearidae.contact.kernels.law.law_table`.

    Returns
    -------
    ndarray, shape (n,)
        In the layout of a force law. Read-only, shared between callers.
    """
    force = law_table(law, kernel)
    table = force.copy()
    loading = slice(HEADER, HEADER + 8 * N_LOADING)
    table[loading] = _potential(force[loading].reshape(-1, 8), GAP_LOW).ravel()
    if force[H_STRETCH] > 0.0:
        count, first = int(force[H_COUNT]), int(force[H_END])
        end = force[first : first + 8 * count].reshape(-1, 8)
        table[first : first + 8 * count] = _potential(end, force[H_LOW]).ravel()
        if force[H_MODE] == MODE_TABLE:
            _store_partial(force, end, table)
    table.setflags(write=False)
    return table


@lru_cache(maxsize=32)
def loading_pieces(law: AsperityLaw, kernel: Kernel = "line", offset: float = 0.0) -> tuple[Floats, Floats]:
    """Tabulate the loading branch of a material whose gap is wider by an offset, and its potential.

    Parameters
    ----------
    law, kernel
        As for `gearidae.contact.kernels.law.law_table`.
    offset : float, optional
        By how much the material's gap is wider than that which the pieces are read at, in roughnesses, 0 or more.

    Returns
    -------
    loading, potential : ndarray, shape (8 * N_LOADING,)
        Pieces of q(G + offset, 0) and of A(G + offset) on the knots of G, without a header; without an offset those of
        the tables to the last bit. Read-only, shared between callers.
    """
    if offset == 0.0:
        part = slice(HEADER, HEADER + 8 * N_LOADING)
        return law_table(law, kernel)[part], energy_table(law, kernel)[part]
    knots = GAP_LOW + np.arange(N_LOADING + 1) / KNOTS_PER_SIGMA
    pieces = hermite_pieces(knots, loading_derivatives(knots + offset, law, kernel))
    loading, potential = pieces.ravel(), _potential(pieces, GAP_LOW).ravel()
    for part_of_both in (loading, potential):
        part_of_both.setflags(write=False)
    return loading, potential


@lru_cache(maxsize=8)
def number_table(kernel: Kernel = "line", join: float = 0.0) -> Floats:
    """Tabulate Psi, the number of asperities above a height, laid out as a loading branch without a header.

    Parameters
    ----------
    kernel : {"line", "plane"}, optional
        As for `gearidae.contact.kernels.law.law_table`.
    join : float, optional
        Distance at which asperities join, in roughnesses: the table is read at heights that are larger by that.

    Returns
    -------
    ndarray, shape (8 * N_LOADING,)
        Read-only, shared between callers.
    """
    knots = GAP_LOW + np.arange(N_LOADING + 1) / KNOTS_PER_SIGMA
    table = _potential(hermite_pieces(knots, kernel_at_knots(kernel, knots - join)), GAP_LOW).ravel()
    table.setflags(write=False)
    return table


def _potential(pieces: Floats, low: float) -> Floats:
    """Pieces of ``int_x^high f`` from pieces of f, shape (n, 8), both scaled by ``exp(max(x, 0)^2 / 2)``."""
    h = 1.0 / KNOTS_PER_SIGMA
    knots = low + h * np.arange(len(pieces) + 1)
    x, w = gauss_rule(_GAUSS)
    u = 0.5 * (x + 1.0)
    positions = np.maximum(knots[:-1, None] + h * u, 0.0)
    values = pieces @ np.vander(u, 8, increasing=True).T * np.exp(-0.5 * positions**2)
    parts = 0.5 * h * values @ w
    total = np.append(np.cumsum(parts[::-1])[::-1], 0.0)
    ends = []
    for u_end, span in ((0.0, slice(None, -1)), (1.0, slice(1, None))):
        # f and two derivatives at this end, scaled; then the potential with three: F' = -f
        powers = np.array(
            [[math.perm(p, k) * u_end ** (p - k) if p >= k else 0.0 for p in range(8)] for k in range(3)]
        )
        f, f1, f2 = (pieces @ powers.T / h ** np.arange(3.0)).T
        at = np.where(knots[:-1] >= 0.0, knots[span], 0.0)
        grown = total[span] * np.exp(0.5 * at**2)
        slope = at * grown - f
        second = np.where(knots[:-1] >= 0.0, grown, 0.0) + at * slope - f1
        third = np.where(knots[:-1] >= 0.0, 2.0 * slope, 0.0) + at * second - f2
        ends += [grown, h * slope, h**2 * second, h**3 * third]
    return np.asarray(np.stack(ends, axis=1) @ hermite_matrix().T)


def _store_partial(law: Floats, end: Floats, table: Floats) -> None:
    """Pieces of e(Z, S) as ``V(Z) + v^2 times a polynomial``, which begins with ``D t(Z, D)``."""
    division, limit, first = Division.read(law), law[H_STRETCH], int(law[H_PARTIAL])
    pieces, n = division.pieces, DEGREE + 1
    shape = (len(end), pieces, 8, n)
    size = math.prod(shape)
    # powers of v in all pieces, then those of u
    partial = law[first : first + size].reshape(shape).swapaxes(2, 3).reshape(len(end), pieces * n, 8)
    result = 2.0 * limit * (_stretch_integral(division) @ partial)
    result[:, ::n] += limit * end[:, None]
    table[first : first + size] = result.reshape(len(end), pieces, n, 8).swapaxes(2, 3).ravel()


@lru_cache(maxsize=8)
def _stretch_integral(division: Division) -> Floats:
    """Matrix from a piecewise polynomial f to ``v^-2 int_0^v v'^3 f dv'``, both in powers of the position."""
    nodes = np.polynomial.chebyshev.chebpts1(DEGREE + 1)
    to_powers = np.linalg.inv(np.vander(nodes, increasing=True))
    x, w = gauss_rule(_GAUSS)
    pieces, n = division.pieces, DEGREE + 1
    matrix = np.zeros((pieces, n, pieces, n))
    before = np.zeros((pieces, n))  # integral over all earlier pieces
    for piece in range(pieces):
        rows = np.zeros((n, pieces, n))
        for i, node in enumerate((*nodes, 1.0)):
            r = -1.0 + 0.5 * (node + 1.0) * (x + 1.0)
            v = division.at(piece, 0.5 * (r + 1.0))
            weight = 0.25 * (node + 1.0) * w / division.scale(piece) * v**3
            upto = before.copy()
            upto[piece] += weight @ np.vander(r, n, increasing=True)
            if i < n:
                rows[i] = upto / division.at(piece, 0.5 * (node + 1.0)) ** 2
            else:
                before = upto
        matrix[piece] = np.einsum("ab,bcd->acd", to_powers, rows)
    return matrix.reshape(pieces * n, pieces * n)


@compiled
def stretched_energy(table: Floats, adhered_energy: float, gap: float, joined: float) -> tuple[float, float]:
    """What joined asperities store beyond the loading branch, and its slope while the joined height stays.

    Parameters
    ----------
    table : ndarray
        From `energy_table`.
    adhered_energy : float
        e(Z, 0) = E(0) Psi(Z) at the joined height.
    gap, joined : float
        G and Z over roughness [1]; Z is clipped to no less than G - D. Asperities that a closing contact joins below
        Z are not counted.
    """
    limit = table[H_STRETCH]
    if limit == 0.0:
        return 0.0, 0.0
    stretch = gap - joined
    if stretch <= 0.0:
        return adhered_energy, 0.0
    if stretch < limit and table[H_MODE] == MODE_INTEGRATED and joined < GAP_HIGH:
        work, slope = integrated_work(table, joined, stretch)
        return adhered_energy - work, -slope
    return stretched_value(table, gap, joined)
