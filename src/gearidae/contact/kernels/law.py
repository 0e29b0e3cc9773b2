r"""The force law of a rough line contact, compiled: readable physics turned into tables of stated error.

In lengths of the roughness sigma (gap G, joined height Z, stretch S = G - Z, stretch limit D) and with the Hertz
pressure scale taken out, the force of Teodorescu et al. 2009 (Eqs. 12-15) on a parabolic gap is

.. math::

    q(G, S) = \int_{-S}^{\infty} \hat p(\Delta)\, \psi(G + \Delta)\, d\Delta, \qquad
    W = L \sqrt{2 R \sigma}\; N\, \tfrac43 E^* \sqrt\beta\, \sigma^{3/2}\; q,

with :math:`\hat p` the load of one asperity by any law (`gearidae.asperities`), in the units in which
Hertz's is :math:`\Delta^{3/2}`. The law has three branches that join continuously: loading (S = 0), partly stretched
(0 < S < D) and fully stretched (S = D).

Stretched asperities add :math:`t(Z, S) = \int_{-S}^0 \hat p\,\psi(Z + S + \Delta)\,d\Delta` to the loading branch,
with t(Z, D) a function of one variable again.

**Asperities that join before they touch**, at a distance :math:`d_\mathrm{on}`, and detach at :math:`d_\mathrm{off}`,
change nothing for those who use a table: Z is the joined height *plus* :math:`d_\mathrm{on}`, so that it lies in
[G - D, G] with :math:`D = d_\mathrm{off} - d_\mathrm{on}`; S = G - Z is what an asperity is stretched beyond joining,
and

.. math::

    q(G, 0) = \int_{-d_\mathrm{on}}^{\infty} \hat p(\Delta)\, \psi(G + \Delta)\, d\Delta, \qquad
    t(Z, S) = \int_{-d_\mathrm{on} - S}^{-d_\mathrm{on}} \hat p(\Delta)\, \psi(Z + S + \Delta)\, d\Delta.

Each branch is stored as :math:`e^{\max(x, 0)^2/2}` times itself, which is smooth into the far tail, by septic Hermite
pieces (three continuous derivatives) in gap or joined height and by Chebyshev pieces in :math:`v = \sqrt{1 - S/D}`, in
which the square-root end of the stretch at the fold is regular. A stretch limit of more than one roughness would take
too many of these: there the branch is integrated on demand, from one asperity's load in pieces of that kind. With
the normal density in place of psi the same tables hold the pressure between two planes, of which the elastic contact is
made. The tests hold both to a relative error of 1e-9 for -8 <= gap <= 8; the measured one is nearer 1e-11. Of a load
with a kink (Maugis' below lambda = 0.94) a piece ends there, and the error stays below 1e-8.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.asperities import AsperityLaw
from gearidae.compiled import compiled
from gearidae.contact.kernels.branches import B_JOINED, B_PIECES, branch_length, branch_value, set_branch
from gearidae.contact.kernels.division import Division
from gearidae.contact.kernels.evaluate import law_value, loading_value, stretched_value
from gearidae.contact.kernels.knots import loading_derivatives, stretched_derivatives
from gearidae.contact.kernels.layout import (
    ASPERITY_PIECES,
    GAP_HIGH,
    GAP_LOW,
    H_COUNT,
    H_END,
    H_LOW,
    H_MODE,
    H_PARTIAL,
    H_PSI,
    H_STRETCH,
    HEADER,
    KNOTS_PER_SIGMA,
    MODE_INTEGRATED,
    MODE_TABLE,
    N_LOADING,
    Kernel,
)
from gearidae.contact.kernels.pieces import asperity_pieces, hermite_pieces, kernel_table, partial_pieces

__all__ = [
    "B_JOINED",
    "B_PIECES",
    "GAP_HIGH",
    "GAP_LOW",
    "HEADER",
    "H_STRETCH",
    "N_LOADING",
    "Kernel",
    "branch_length",
    "branch_value",
    "force_scale",
    "largest_forces",
    "law_table",
    "law_value",
    "loading_table",
    "loading_value",
    "set_branch",
    "stretch_followed",
    "stretched_value",
]

NEGLIGIBLE_STRETCH: Final = (
    4e-5  # D^2.5 below 1e-11: stretching changes no force by more than the table's error
)
TABULATED_STRETCH: Final = 1.0  # above this the partly stretched branch is integrated on demand
PIECE_STRETCH: Final = 0.04  # a Chebyshev piece in v covers no more than about twice this stretch


def force_scale(roughness: float, hertz_factor: float, density: float, width: float) -> float:
    """Force of unit q and unit ``sqrt(2 R sigma)``: ``L N (4/3) E* sqrt(beta) sigma^1.5`` [N/m].

    Parameters
    ----------
    roughness : float
        sigma [m].
    hertz_factor : float
        ``4/3 E* sqrt(beta)`` [N/m^1.5].
    density : float
        Asperities per area [1/m^2].
    width : float
        Face width L [m].
    """
    return width * density * hertz_factor * roughness**1.5


def stretch_followed(law: AsperityLaw) -> float:
    """Stretch limit D that a table keeps branches for: 0 where stretching changes no force by more than its error."""
    limit = law.detach - law.join
    return limit if limit > NEGLIGIBLE_STRETCH else 0.0


@lru_cache(maxsize=32)
def law_table(law: AsperityLaw, kernel: Kernel = "line") -> Floats:
    """Tabulate the force law of one surface.

    Parameters
    ----------
    law : AsperityLaw
        Law of one asperity in units of the roughness, see `gearidae.asperities.law_of`. Equal laws share a
        table.
    kernel : {"line", "plane"}, optional
        Force on a parabolic gap, or pressure between planes: what the loads are integrated against, psi or the
        normal density.

    Returns
    -------
    ndarray, shape (n,)
        Header and coefficients as `law_value` reads them. Read-only, shared between callers.
    """
    loading = loading_table(law, kernel)
    parts = [loading[:HEADER].copy(), loading[HEADER:]]
    if stretch_followed(law) > 0.0:
        _add_stretched(parts, law, kernel)
    table = np.concatenate(parts)
    table.setflags(write=False)
    return table


@lru_cache(maxsize=32)
def loading_table(law: AsperityLaw, kernel: Kernel = "line") -> Floats:
    """Tabulate the loading branch alone, as `law_table` does it for asperities that cannot stretch.

    Parameters
    ----------
    law : AsperityLaw
        As for `law_table`.
    kernel : {"line", "plane"}, optional
        As for `law_table`.

    Returns
    -------
    ndarray, shape (n,)
        Likewise. Read-only, shared between callers.
    """
    knots = GAP_LOW + np.arange(N_LOADING + 1) / KNOTS_PER_SIGMA
    pieces = hermite_pieces(knots, loading_derivatives(knots, law, kernel)).ravel()
    table = np.concatenate([np.zeros(HEADER), pieces])
    table.setflags(write=False)
    return table


@lru_cache(maxsize=32)
def largest_forces(law: AsperityLaw, kernel: Kernel = "line") -> tuple[Floats, Floats]:
    """Return gaps from the widest with any force inwards, an eighth apart, and the largest force at each.

    Parameters
    ----------
    law : AsperityLaw
        As for `law_table`.
    kernel : {"line", "plane"}, optional
        As for `law_table`.

    Returns
    -------
    gaps, forces : ndarray, shape (n,)
        In roughnesses, and sizes of q; the larger of fully joined and fully stretched.
    """
    # a copy: numba compiles everything a second time for arrays that are read-only
    table = law_table(law, kernel).copy()
    gaps = np.arange(GAP_HIGH + table[H_STRETCH], GAP_LOW, -0.125)
    forces = np.empty_like(gaps)
    _larger_forces(table, gaps, forces)
    return gaps, forces


@compiled
def _larger_forces(table: Floats, gaps: Floats, out: Floats) -> None:
    for i in range(gaps.size):
        joined, stretched = law_value(table, gaps[i], gaps[i])[0], law_value(table, gaps[i], -math.inf)[0]
        out[i] = max(abs(joined), abs(stretched))


def _add_stretched(parts: list[Floats], law: AsperityLaw, kernel: Kernel) -> None:
    """Add the branches of stretched asperities to a table whose header is its first part."""
    header, limit = parts[0], law.detach - law.join
    low = math.floor((GAP_LOW - limit) * KNOTS_PER_SIGMA) / KNOTS_PER_SIGMA
    count = round((GAP_HIGH - low) * KNOTS_PER_SIGMA)
    joined = low + np.arange(count + 1) / KNOTS_PER_SIGMA
    header[[H_STRETCH, H_LOW, H_COUNT]] = limit, low, count
    header[H_END] = sum(part.size for part in parts)
    end = stretched_derivatives(joined, law, np.zeros(1), kernel)
    parts.append(hermite_pieces(joined, end).ravel())
    following = sum(part.size for part in parts)
    if limit <= TABULATED_STRETCH:
        division = Division.of(law, max(law.pieces, math.ceil(limit / PIECE_STRETCH)))
        header[[H_MODE, H_PARTIAL]] = MODE_TABLE, following
        parts.append(partial_pieces(joined, end, law, division, kernel).ravel())
    else:
        density = kernel_table(kernel)
        after = following + density.size
        division = Division.of(law, ASPERITY_PIECES)
        header[[H_MODE, H_PSI, H_PARTIAL]] = MODE_INTEGRATED, following, after
        parts += [density, asperity_pieces(law, division)]
    division.write(header)
