r"""The force law of a rough line contact, compiled: readable physics turned into tables of stated error.

In lengths of the roughness sigma (gap G, joined height Z, stretch S = G - Z, stretch limit D) and with the Hertz
pressure scale taken out, the force of Teodorescu et al. 2009 (Eqs. 12-15) on a parabolic gap is

.. math::

    q(G, S) = \int_{-S}^{\infty} \hat p(\Delta)\, \psi(G + \Delta)\, d\Delta, \qquad
    W = L \sqrt{2 R \sigma}\; N\, \tfrac43 E^* \sqrt\beta\, \sigma^{3/2}\; q,

with :math:`\hat p(\Delta) = \sqrt3 D^{3/2}\,(P/P_c)(\Delta/D)`, which tends to Hertz's :math:`\Delta^{3/2}` as
adhesion vanishes. One number, D, is all that tells one surface from another. The law has three branches that join
continuously: loading (S = 0), partly stretched (0 < S < D) and fully stretched (S = D).

Stretched asperities add :math:`t(Z, S) = \int_{-S}^0 \hat p\,\psi(Z + S + \Delta)\,d\Delta` to the loading branch,
with t(Z, D) a function of one variable again. Each is stored as
:math:`e^{\max(x, 0)^2/2}` times itself, which is smooth into the far tail, by septic Hermite pieces (three
continuous derivatives) in gap or joined height and by Chebyshev pieces in :math:`v = \sqrt{1 - S/D}`, in which
the square-root end of the stretch at the fold is regular. With the normal density in place of psi the same tables
hold the pressure between two planes, of which the elastic contact is made. The tests hold both to a relative error of
1e-9 for -8 <= gap <= 8; the measured one is nearer 1e-11.
"""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise
from typing import Final, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.contact.jkr import AsperityLaw, displacement, jkr_load, jkr_root, load
from gearidae.contact.kernels.lanes import eight_powers
from gearidae.contact.psi import psi_derivatives
from gearidae.contact.ranges import GAP_HIGH, GAP_LOW, STRETCH_HIGH

__all__ = [
    "DEGREE",
    "GAP_HIGH",
    "GAP_LOW",
    "HEADER",
    "H_COUNT",
    "H_END",
    "H_LOW",
    "H_MODE",
    "H_PARTIAL",
    "H_PIECES",
    "H_STRETCH",
    "KNOTS_PER_SIGMA",
    "MODE_INTEGRATED",
    "MODE_TABLE",
    "N_LOADING",
    "STRETCH_HIGH",
    "Kernel",
    "branch_length",
    "branch_value",
    "force_scale",
    "hermite_matrix",
    "integrated_value",
    "kernel_table",
    "law_table",
    "law_value",
    "loading_value",
    "set_branch",
    "stretched_value",
]

Floats = NDArray[np.float64]
Eight = tuple[float, float, float, float, float, float, float, float]
Kernel: TypeAlias = Literal["line", "plane"]

KNOTS_PER_SIGMA: Final = 8
NEGLIGIBLE_STRETCH: Final = (
    4e-5  # D^2.5 below 1e-11: stretching changes no force by more than the table's error
)
TABULATED_STRETCH: Final = 1.0  # above this the partly stretched branch is integrated when asked for
PIECE_STRETCH: Final = 0.04  # a Chebyshev piece in v covers no more than about twice this stretch
PIECES_LOW: Final = 4  # the asperity's own law wants this many however small the stretch
DEGREE: Final = 7  # of the Chebyshev pieces in v

# The header of a table: a flat array that compiled code can carry about.
H_STRETCH: Final = 0  # stretch limit; 0 where the surface has no stretch worth a branch
H_MODE: Final = 1  # of the partly stretched branch
H_LOW: Final = 2  # first knot in joined height, and number of pieces from there
H_COUNT: Final = 3
H_END: Final = 4  # offset of t(Z, D)
H_PARTIAL: Final = 5  # offset of t(Z, S), and its number of pieces in v
H_PIECES: Final = 6
H_PSI: Final = 7  # offset of psi, with its own first knot in front
HEADER: Final = 8  # the loading branch follows at once

MODE_NONE: Final = 0  # loading and unloading agree
MODE_TABLE: Final = 1
MODE_INTEGRATED: Final = 2
N_LOADING: Final = round((GAP_HIGH - GAP_LOW) * KNOTS_PER_SIGMA)
GAUSS: Final = 16

# A branch: t at one joined height, for all stretches.
B_SHARE: Final = 0  # 1 / D
B_PIECES: Final = 1
B_END: Final = 2  # t at full stretch
B_BODY: Final = 3  # then eight powers for each piece in v


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


@lru_cache(maxsize=32)
def law_table(stretch_limit: float, asperity: AsperityLaw = "jkr", kernel: Kernel = "line") -> Floats:
    """Tabulate the force law of one surface.

    Parameters
    ----------
    stretch_limit : float
        D = dc / sigma, the stretch limit in roughnesses [1], 0 or more.
    asperity : {"jkr", "dmt", "hertz"}, optional
        Law of one asperity. Only JKR stretches.
    kernel : {"line", "plane"}, optional
        Force on a parabolic gap, or pressure between planes: what the loads are integrated against, psi or the
        normal density.

    Returns
    -------
    ndarray, shape (n,)
        Header and coefficients as `law_value` reads them. Read-only, shared between callers.
    """
    adhesive = stretch_limit if asperity != "hertz" else 0.0
    stretches = asperity == "jkr" and stretch_limit > NEGLIGIBLE_STRETCH
    knots = GAP_LOW + np.arange(N_LOADING + 1) / KNOTS_PER_SIGMA
    header = np.zeros(HEADER)
    parts = [header, _pieces(knots, _loading_derivatives(knots, adhesive, asperity, kernel)).ravel()]
    if stretches:
        low = math.floor((GAP_LOW - stretch_limit) * KNOTS_PER_SIGMA) / KNOTS_PER_SIGMA
        count = round((GAP_HIGH - low) * KNOTS_PER_SIGMA)
        joined = low + np.arange(count + 1) / KNOTS_PER_SIGMA
        header[[H_STRETCH, H_LOW, H_COUNT]] = stretch_limit, low, count
        header[H_END] = sum(part.size for part in parts)
        end = _stretched_derivatives(joined, stretch_limit, np.zeros(1), kernel)
        parts.append(_pieces(joined, end).ravel())
        following = sum(part.size for part in parts)
        if stretch_limit <= TABULATED_STRETCH:
            pieces = max(PIECES_LOW, math.ceil(stretch_limit / PIECE_STRETCH))
            header[[H_MODE, H_PARTIAL, H_PIECES]] = MODE_TABLE, following, pieces
            parts.append(_partial_pieces(joined, end, stretch_limit, pieces, kernel).ravel())
        else:
            header[[H_MODE, H_PSI]] = MODE_INTEGRATED, following
            parts.append(kernel_table(kernel))
    table = np.concatenate(parts)
    table.setflags(write=False)
    return table


# -- integrals at the knots ------------------------------------------------------------------------------------------


def _asperity_nodes(low: float, high: float, stretch_limit: float, order: int) -> tuple[Floats, Floats]:
    """Gauss nodes Delta and weights ``p(Delta) dDelta`` of JKR asperities, free of the fold's square root."""
    root_low, root_high = jkr_root(np.array([low, high]) / stretch_limit)
    x, w = np.polynomial.legendre.leggauss(order)
    s = 0.5 * (root_high - root_low) * x + 0.5 * (root_high + root_low)
    rate = 4.0 * 12.0 ** (1 / 3) * s**3 - 4.0 / 3.0 * 18.0 ** (1 / 6)
    weight = 0.5 * (root_high - root_low) * w * rate * load(s) * math.sqrt(3.0) * stretch_limit**2.5
    return displacement(s) * stretch_limit, weight


def _compressed_nodes(stretch_limit: float, asperity: AsperityLaw) -> tuple[Floats, Floats]:
    """Gauss nodes and weights over 0 <= Delta <= half a roughness, where the load is not smooth in Delta."""
    if asperity == "jkr" and stretch_limit > 0.0:
        return _asperity_nodes(0.0, 0.5, stretch_limit, 48)
    x, w = np.polynomial.legendre.leggauss(48)
    r = 0.5 * (x + 1.0) * math.sqrt(0.5)  # Delta = r^2
    return r**2, 0.5 * math.sqrt(0.5) * w * 2.0 * r * _pressure(r**2, stretch_limit, asperity)


def _pressure(delta: Floats, stretch_limit: float, asperity: AsperityLaw) -> Floats:
    """Load of an asperity compressed by `delta`, over the Hertz load at one roughness."""
    if stretch_limit == 0.0 or asperity == "hertz":
        return delta**1.5
    if asperity == "dmt":
        return delta**1.5 - 4.0 / 3.0 * math.sqrt(3.0) * stretch_limit**1.5
    return math.sqrt(3.0) * stretch_limit**1.5 * jkr_load(delta / stretch_limit)


def _loading_derivatives(gap: Floats, stretch_limit: float, asperity: AsperityLaw, kernel: Kernel) -> Floats:
    """q(G, 0) and three derivatives, shape (4, n), for gaps on a grid of `KNOTS_PER_SIGMA`.

    Beyond the first half roughness the compression is integrated by panels of half a roughness, so that all gaps
    share the values of the kernel.
    """
    delta, weight = _compressed_nodes(stretch_limit, asperity)
    result = np.einsum("i,kji->kj", weight, _kernel_at(kernel, gap[:, None] + delta[None, :]))
    x, w = np.polynomial.legendre.leggauss(12)
    within, half = 0.25 * (x + 1.0), KNOTS_PER_SIGMA // 2
    panels = math.ceil((12.0 - gap[0]) / 0.5)
    step = np.arange(len(gap) + panels * half)
    shared = _kernel_at(kernel, (gap[0] + step / KNOTS_PER_SIGMA)[:, None] + within[None, :])
    for panel in range(1, panels):
        load_weight = 0.25 * w * _pressure(0.5 * panel + within, stretch_limit, asperity)
        first = panel * half
        result += shared[:, first : first + len(gap)] @ load_weight
    return np.asarray(result)


def _stretched_derivatives(joined: Floats, stretch_limit: float, v: Floats, kernel: Kernel) -> Floats:
    """t(Z, S) and three derivatives in Z at fixed S = D (1 - v^2), shape (4, n, len(v))."""
    result = np.empty((4, len(joined), len(v)))
    panels = 1 + int(stretch_limit / 0.5)
    for m, value in enumerate(v):
        stretch = stretch_limit * (1.0 - value**2)
        edges = np.linspace(-stretch, 0.0, panels + 1)
        total = np.zeros((4, len(joined)))
        for low, high in pairwise(edges):
            delta, weight = _asperity_nodes(low, high, stretch_limit, GAUSS)
            total += _kernel_at(kernel, joined[:, None] + (stretch + delta)[None, :]) @ weight
        result[:, :, m] = total
    return result


# -- pieces ----------------------------------------------------------------------------------------------------------


def _scaled(x: Floats, derivatives: Floats, positive: bool) -> Floats:
    """Derivatives of ``exp(x^2/2) f`` from those of f (first axis), on the side x > 0; f itself on the other."""
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


def _pieces(knots: Floats, derivatives: Floats) -> Floats:
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
    return np.moveaxis(np.tensordot(hermite_matrix(), np.stack(ends), axes=1), 0, 1)


def _partial_pieces(joined: Floats, end: Floats, stretch_limit: float, pieces: int, kernel: Kernel) -> Floats:
    """Pieces of t(Z, S) as ``t(Z, D) + v^2 times a polynomial`` (regular slope at the fold): the polynomial.

    Returns
    -------
    ndarray, shape (n, pieces, 8, DEGREE + 1)
        Powers of u, then of the place in the piece of v.
    """
    nodes = np.polynomial.chebyshev.chebpts1(DEGREE + 1)
    to_powers = np.linalg.inv(np.vander(nodes, increasing=True))
    out = np.empty((len(joined) - 1, pieces, 8, DEGREE + 1))
    for piece in range(pieces):
        v = (piece + 0.5 * (nodes + 1.0)) / pieces
        rest = (_stretched_derivatives(joined, stretch_limit, v, kernel) - end) / v**2
        out[:, piece] = _pieces(joined, rest) @ to_powers.T
    return out


@lru_cache(maxsize=2)
def kernel_table(kernel: Kernel) -> Floats:
    """Pieces of the kernel itself, for the branch that is integrated when asked for."""
    low = GAP_LOW - STRETCH_HIGH - 1.0
    knots = low + np.arange(round((GAP_HIGH - low) * KNOTS_PER_SIGMA) + 1) / KNOTS_PER_SIGMA
    derivatives = psi_derivatives(knots, 3) if kernel == "line" else _normal_derivatives(knots)
    return np.concatenate([[low], _pieces(knots, derivatives).ravel()])


def _kernel_at(kernel: Kernel, y: Floats) -> Floats:
    """Psi or the normal density, with three derivatives, shape (4, *y.shape)."""
    return _psi_at(y) if kernel == "line" else _normal_derivatives(y)


def _normal_derivatives(y: Floats) -> Floats:
    """Standard normal density and three derivatives, shape (4, *y.shape)."""
    density = np.exp(-0.5 * y**2) / math.sqrt(2.0 * math.pi)
    return np.stack([density, -y * density, (y**2 - 1.0) * density, (3.0 * y - y**3) * density])


PSI_KNOTS: Final = 16  # per roughness, of the Taylor expansions below
PSI_ORDER: Final = 12


@lru_cache(maxsize=1)
def _psi_knots() -> tuple[float, Floats]:
    """First knot and Taylor coefficients of psi, shape (n, order + 1), wide enough for every surface."""
    low, high = GAP_LOW - STRETCH_HIGH - 2.0, 30.0
    knots = np.arange(round(low * PSI_KNOTS), round(high * PSI_KNOTS) + 1) / PSI_KNOTS
    factorial = np.cumprod(np.maximum(np.arange(PSI_ORDER + 1.0), 1.0))
    return low, np.ascontiguousarray((psi_derivatives(knots, PSI_ORDER) / factorial[:, None]).T)


def _psi_at(y: Floats) -> Floats:
    """psi and three derivatives at y, shape (4, *y.shape), from Taylor expansions about knots; 0 beyond 30."""
    low, table = _psi_knots()
    out = np.zeros((4, y.size))
    _psi_taylor(np.ascontiguousarray(y).ravel(), low, table, out)
    return out.reshape(4, *y.shape)


@compiled
def _psi_taylor(y: Floats, low: float, table: Floats, out: Floats) -> None:
    for i in range(y.size):
        j = math.floor((y[i] - low) * PSI_KNOTS + 0.5)
        if j >= table.shape[0]:
            continue
        d = y[i] - (low + j / PSI_KNOTS)
        f0 = f1 = f2 = f3 = 0.0
        for k in range(PSI_ORDER, -1, -1):
            f3 = f3 * d + f2
            f2 = f2 * d + f1
            f1 = f1 * d + f0
            f0 = f0 * d + table[j, k]
        out[0, i], out[1, i], out[2, i], out[3, i] = f0, f1, 2.0 * f2, 6.0 * f3


# -- the compiled law ------------------------------------------------------------------------------------------------


# Indices are unsigned where it counts: a signed one makes numba test for Python's negative indices at every access.
_AT: Final = tuple(np.uintp(i) for i in range(8))
_A1, _A2, _A3, _A4, _A5, _A6, _A7 = _AT[1:]


@compiled
def _power8(table: Floats, k: np.uintp, u: float, u2: float, u4: float) -> float:
    """Polynomial of eight coefficients, its halves evaluated side by side (Estrin's scheme)."""
    low = (table[k] + table[k + _A1] * u) + (table[k + _A2] + table[k + _A3] * u) * u2
    high = (table[k + _A4] + table[k + _A5] * u) + (table[k + _A6] + table[k + _A7] * u) * u2
    return low + high * u4


@compiled(inline=True)
def _coefficients(table: Floats, k: np.uintp) -> Eight:
    """Eight coefficients in succession."""
    low = table[k], table[k + _A1], table[k + _A2], table[k + _A3]
    return (*low, table[k + _A4], table[k + _A5], table[k + _A6], table[k + _A7])


@compiled(inline=True)
def _value_and_slope(c: Eight, u: float) -> tuple[float, float]:
    """Polynomial of eight coefficients and its derivative, their halves evaluated side by side (Estrin's scheme)."""
    u2 = u * u
    u4 = u2 * u2
    low = (c[0] + c[1] * u) + (c[2] + c[3] * u) * u2
    high = (c[4] + c[5] * u) + (c[6] + c[7] * u) * u2
    slope = (c[1] + 2.0 * c[2] * u) + (3.0 * c[3] + 4.0 * c[4] * u) * u2
    slope += ((5.0 * c[5] + 6.0 * c[6] * u) + 7.0 * c[7] * u2) * u4
    return low + high * u4, slope


@compiled
def _septic(table: Floats, offset: int, x: float, low: float, count: int) -> tuple[float, float]:
    """Value and slope of scaled septic pieces at x."""
    position = (x - low) * KNOTS_PER_SIGMA
    j = min(max(int(position), 0), count - 1)
    u = position - j
    f, d = _value_and_slope(_coefficients(table, np.uintp(offset + 8 * j)), u)
    d *= KNOTS_PER_SIGMA
    if x > 0.0:
        decay = math.exp(-0.5 * x * x)
        return f * decay, (d - x * f) * decay
    return f, d


@compiled
def loading_value(table: Floats, offset: int, gap: float) -> tuple[float, float]:
    """Loading branch and its slope; `offset` is `HEADER` in a law's own table."""
    if gap >= GAP_HIGH:
        return 0.0, 0.0
    return _septic(table, offset, gap, GAP_LOW, N_LOADING)


@compiled
def branch_length(table: Floats) -> int:
    """Size of the array that `set_branch` fills; 0 where a surface keeps no branches."""
    if table[H_MODE] != MODE_TABLE:
        return 0
    return B_BODY + (DEGREE + 1) * int(table[H_PIECES])


@compiled
def set_branch(table: Floats, joined: float, branch: Floats) -> None:
    """Work out t(Z, S) at one joined height for all stretches S.

    Parameters
    ----------
    table : ndarray
        From `law_table`, of a surface whose partly stretched branch is tabulated.
    joined : float
        Z, height above which asperities are joined, over roughness [1].
    branch : ndarray, shape (branch_length(table),)
        Filled in.
    """
    pieces = int(table[H_PIECES])
    position = (joined - table[H_LOW]) * KNOTS_PER_SIGMA
    j = min(max(int(position), 0), int(table[H_COUNT]) - 1)
    u = position - j
    u2 = u * u
    u4 = u2 * u2
    decay = math.exp(-0.5 * joined * joined) if joined > 0.0 else 1.0
    branch[B_SHARE] = 1.0 / table[H_STRETCH]
    branch[B_PIECES] = table[H_PIECES]
    branch[B_END] = decay * _power8(table, np.uintp(int(table[H_END]) + 8 * j), u, u2, u4)
    start = int(table[H_PARTIAL]) + 8 * (DEGREE + 1) * j * pieces
    for piece in range(pieces):
        body = B_BODY + (DEGREE + 1) * piece
        c = eight_powers(table, np.uintp(start + 8 * (DEGREE + 1) * piece), u)
        for m in range(DEGREE + 1):
            branch[body + m] = decay * c[m]


@compiled
def branch_value(branch: Floats, stretch: float) -> tuple[float, float]:
    """t(Z, S) and its slope in S on a branch, 0 <= S <= D."""
    share = branch[B_SHARE]
    v = math.sqrt(max(1.0 - stretch * share, 0.0))
    place = v * branch[B_PIECES]
    piece = min(int(place), int(branch[B_PIECES]) - 1)
    r = 2.0 * (place - piece) - 1.0
    f, d = _value_and_slope(_coefficients(branch, np.uintp(B_BODY + (DEGREE + 1) * piece)), r)
    return branch[B_END] + v * v * f, -(f + place * d) * share


@compiled(inline=True)
def _partial(table: Floats, joined: float, stretch: float) -> tuple[float, float]:
    """t(Z, S) and its slope in S, where no branch is kept."""
    pieces = int(table[H_PIECES])
    limit = table[H_STRETCH]
    position = (joined - table[H_LOW]) * KNOTS_PER_SIGMA
    j = min(max(int(position), 0), int(table[H_COUNT]) - 1)
    u = position - j
    u2 = u * u
    u4 = u2 * u2
    v = math.sqrt(1.0 - stretch / limit)
    place = v * pieces
    piece = min(int(place), pieces - 1)
    r = 2.0 * (place - piece) - 1.0
    start = int(table[H_PARTIAL]) + 8 * (DEGREE + 1) * (j * pieces + piece)
    f, d = _value_and_slope(eight_powers(table, np.uintp(start), u), r)
    end = _power8(table, np.uintp(int(table[H_END]) + 8 * j), u, u2, u4)
    decay = math.exp(-0.5 * joined * joined) if joined > 0.0 else 1.0
    return (end + v * v * f) * decay, -(f + place * d) / limit * decay


@compiled
def integrated_value(table: Floats, joined: float, stretch: float, energy: bool) -> tuple[float, float]:
    """t(Z, S) and its slope in S by composite Gauss quadrature over the asperity's root: any stretch limit.

    Parameters
    ----------
    table : ndarray
        From `law_table`, of a surface whose partly stretched branch is not tabulated.
    joined, stretch : float
        Z and S over roughness [1], 0 < S < D.
    energy : bool
        Return the integral of t from no stretch to S, and t, instead.
    """
    limit = table[H_STRETCH]
    offset = int(table[H_PSI])
    low = table[offset]
    count = round((GAP_HIGH - low) * KNOTS_PER_SIGMA)
    panels = 1 + int(stretch / 0.25)
    total = 0.0
    slope = 0.0
    # the fold is regular in e = sqrt(1 + Delta/D): t = 1 + u with u sqrt(u^2 + 4u + 6) = sqrt(3) e
    e_low = math.sqrt(max(1.0 - stretch / limit, 0.0))
    scale = math.sqrt(3.0) * limit**1.5
    for panel in range(panels):
        a = e_low + (1.0 - e_low) * panel / panels
        b = e_low + (1.0 - e_low) * (panel + 1) / panels
        for i in range(8):
            e = 0.5 * (a + b) + 0.5 * (b - a) * _GAUSS_X[i]
            q = math.sqrt(3.0) * e
            u = min(q / math.sqrt(6.0), math.sqrt(q))
            for _ in range(6):
                radicand = u * (u + 4.0) + 6.0
                u -= (u * radicand - q * math.sqrt(radicand)) / (2.0 * (u * (u + 3.0) + 3.0))
            cube = (1.0 + u) ** 3
            y = joined + stretch + limit * (e * e - 1.0)
            value, rate = _septic(table, offset + 1, y, low, count)
            weight = 0.5 * (b - a) * _GAUSS_W[i] * scale * 2.0 * limit * e
            pull = weight * cube * (cube - 6.0) / 9.0
            if energy:
                # what it took to stretch this asperity: the integral of its load, a polynomial in t = 1 + u
                fourth = cube * (1.0 + u)
                lifted = fourth * ((0.1 * cube - 1.0) * cube + 1.5) + 3.6 * _TOUCH
                total -= weight * limit * (4.0 / 27.0) * lifted * value
                slope += pull * value
            else:
                total += pull * value
                slope += pull * rate
    if energy:
        return total, slope
    # S moves both the heights and the lower end, where the load is that of stretch S
    q = math.sqrt(3.0) * e_low
    u = min(q / math.sqrt(6.0), math.sqrt(q))
    for _ in range(6):
        radicand = u * (u + 4.0) + 6.0
        if u > 0.0:
            u -= (u * radicand - q * math.sqrt(radicand)) / (2.0 * (u * (u + 3.0) + 3.0))
    cube = (1.0 + u) ** 3
    edge, _ = _septic(table, offset + 1, joined, low, count)
    return total, slope + scale * cube * (cube - 6.0) / 9.0 * edge


_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(8)
_TOUCH: Final = 4.0 ** (1.0 / 3.0)  # t of an asperity that is not stretched


@compiled(inline=True)
def stretched_value(table: Floats, gap: float, joined: float) -> tuple[float, float]:
    """What stretched asperities add to the loading branch, and its slope while the joined height stays."""
    limit = table[H_STRETCH]
    stretch = gap - joined
    if limit == 0.0 or stretch <= 0.0 or max(joined, gap - limit) >= GAP_HIGH:
        return 0.0, 0.0
    if stretch >= limit:
        return _septic(table, int(table[H_END]), gap - limit, table[H_LOW], int(table[H_COUNT]))
    if table[H_MODE] == MODE_TABLE:
        return _partial(table, joined, stretch)
    return integrated_value(table, joined, stretch, False)


@compiled
def law_value(table: Floats, gap: float, joined: float) -> tuple[float, float]:
    """Force q and its slope in the gap while the joined height stays.

    Parameters
    ----------
    table : ndarray
        From `law_table`.
    gap : float
        G, gap over roughness [1].
    joined : float
        Z, height above which asperities are joined, over roughness [1]; clipped to G - D .. G.

    Returns
    -------
    q, slope : float
        Positive pushes apart. The slope is that of the branch the contact is on.
    """
    q, slope = loading_value(table, HEADER, gap)
    more, rate = stretched_value(table, gap, joined)
    return q + more, slope + rate
