"""Value and slope of a tabulated force law, compiled."""

from __future__ import annotations

import math
from typing import Final, TypeAlias

import numpy as np

from gearidae.arrays import Floats
from gearidae.compiled import compiled
from gearidae.contact.kernels.division import position_of
from gearidae.contact.kernels.lanes import eight_powers
from gearidae.contact.kernels.layout import (
    DEGREE,
    GAP_HIGH,
    GAP_LOW,
    H_COUNT,
    H_END,
    H_KINK,
    H_LOW,
    H_MODE,
    H_PARTIAL,
    H_PIECES,
    H_PSI,
    H_STRETCH,
    HEADER,
    KNOTS_PER_SIGMA,
    MODE_TABLE,
    N_LOADING,
)

Three: TypeAlias = tuple[float, float, float]
Eight: TypeAlias = tuple[float, float, float, float, float, float, float, float]

# Indices are unsigned where it counts: a signed one makes numba test for Python's negative indices at every access.
_AT: Final = tuple(np.uintp(i) for i in range(8))
_A1, _A2, _A3, _A4, _A5, _A6, _A7 = _AT[1:]


@compiled
def power8(table: Floats, k: np.uintp, u: float, u2: float, u4: float) -> float:
    """Polynomial of eight coefficients, its halves evaluated side by side (Estrin's scheme)."""
    low = (table[k] + table[k + _A1] * u) + (table[k + _A2] + table[k + _A3] * u) * u2
    high = (table[k + _A4] + table[k + _A5] * u) + (table[k + _A6] + table[k + _A7] * u) * u2
    return low + high * u4


@compiled(inline=True)
def coefficients(table: Floats, k: np.uintp) -> Eight:
    """Eight coefficients in succession."""
    low = table[k], table[k + _A1], table[k + _A2], table[k + _A3]
    return (*low, table[k + _A4], table[k + _A5], table[k + _A6], table[k + _A7])


@compiled(inline=True)
def value_and_slope(c: Eight, u: float) -> tuple[float, float]:
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
    f, d = value_and_slope(coefficients(table, np.uintp(offset + 8 * j)), u)
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
def mixed_value(table: Floats, offset: int, gap: float, shares: Three) -> tuple[float, float]:
    """Sum of three loading branches that lie one after the other, each times its share, and its slope.

    Parameters
    ----------
    table, offset, gap
        As for `loading_value`.
    shares : tuple of three floats
    """
    if gap >= GAP_HIGH:
        return 0.0, 0.0
    position = (gap - GAP_LOW) * KNOTS_PER_SIGMA
    j = min(max(int(position), 0), N_LOADING - 1)
    a = coefficients(table, np.uintp(offset + 8 * j))
    b = coefficients(table, np.uintp(offset + 8 * (N_LOADING + j)))
    c = coefficients(table, np.uintp(offset + 8 * (2 * N_LOADING + j)))
    f, d = value_and_slope(
        (
            _mix(shares, a[0], b[0], c[0]),
            _mix(shares, a[1], b[1], c[1]),
            _mix(shares, a[2], b[2], c[2]),
            _mix(shares, a[3], b[3], c[3]),
            _mix(shares, a[4], b[4], c[4]),
            _mix(shares, a[5], b[5], c[5]),
            _mix(shares, a[6], b[6], c[6]),
            _mix(shares, a[7], b[7], c[7]),
        ),
        position - j,
    )
    d *= KNOTS_PER_SIGMA
    if gap > 0.0:
        decay = math.exp(-0.5 * gap * gap)
        return f * decay, (d - gap * f) * decay
    return f, d


@compiled(inline=True)
def _mix(shares: Three, a: float, b: float, c: float) -> float:
    return shares[0] * a + shares[1] * b + shares[2] * c


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
    along, scale = position_of(table, v)
    piece = min(int(along), pieces - 1)
    r = 2.0 * (along - piece) - 1.0
    start = int(table[H_PARTIAL]) + 8 * (DEGREE + 1) * (j * pieces + piece)
    f, d = value_and_slope(eight_powers(table, np.uintp(start), u), r)
    end = power8(table, np.uintp(int(table[H_END]) + 8 * j), u, u2, u4)
    decay = math.exp(-0.5 * joined * joined) if joined > 0.0 else 1.0
    return (end + v * v * f) * decay, -(f + v * scale * d) / limit * decay


@compiled
def _sums(table: Floats, joined: float, stretch: float) -> tuple[float, float, float]:
    """Integrals over the stretched asperities, by composite Gauss quadrature in a variable regular at the fold.

    Returns
    -------
    pull, rate, work : float
        Of the load times the density of heights, of the load times the density's slope, and of the work that has
        stretched an asperity times the density.
    """
    limit = table[H_STRETCH]
    loads, works, pieces = _asperity_offsets(table)
    offset = int(table[H_PSI])
    low = table[offset]
    count = round((GAP_HIGH - low) * KNOTS_PER_SIGMA)
    # of the asperity that is stretched least
    lowest = joined + stretch - table[int(table[H_PARTIAL])]
    panels = 1 + int(stretch / 0.25)
    pull = rate = work = 0.0
    # the fold is regular in e = sqrt((Delta + detach) / D), and above a kink sqrt(e - kink) is
    start, kink = math.sqrt(max(1.0 - stretch / limit, 0.0)), table[H_KINK]
    while start < 1.0:
        above = kink <= start
        end = 1.0 if above or kink >= 1.0 else kink
        first, last = (math.sqrt((start - kink) / (1.0 - kink)), 1.0) if above else (start, end)
        for panel in range(panels):
            a = first + (last - first) * panel / panels
            b = first + (last - first) * (panel + 1) / panels
            for i in range(8):
                e = 0.5 * (a + b) + 0.5 * (b - a) * _GAUSS_X[i]
                weight = 0.5 * (b - a) * _GAUSS_W[i] * 2.0 * limit
                if above:
                    weight *= 2.0 * (1.0 - kink) * e
                    e = kink + (1.0 - kink) * e * e
                weight *= e
                value, slope = _septic(table, offset + 1, lowest + limit * (e * e - 1.0), low, count)
                load = weight * _piece_value(table, loads, pieces, e)
                pull += load * value
                rate += load * slope
                work += weight * _piece_value(table, works, pieces, e) * value
        start = end
    return pull, rate, work


@compiled(inline=True)
def _asperity_offsets(table: Floats) -> tuple[int, int, int]:
    """Offsets of one asperity's load and of the work to stretch it, and the number of pieces of each."""
    loads, pieces = int(table[H_PARTIAL]) + 1, int(table[H_PIECES])
    return loads, loads + (DEGREE + 1) * pieces, pieces


@compiled(inline=True)
def _piece_value(table: Floats, offset: int, pieces: int, e: float) -> float:
    """Polynomial pieces on 0..1 at e."""
    position, _ = position_of(table, e)
    piece = min(int(position), pieces - 1)
    r = 2.0 * (position - piece) - 1.0
    r2 = r * r
    return power8(table, np.uintp(offset + (DEGREE + 1) * piece), r, r2, r2 * r2)


@compiled
def integrated_value(table: Floats, joined: float, stretch: float) -> tuple[float, float]:
    """t(Z, S) and its slope in S, whatever the stretch limit.

    Parameters
    ----------
    table : ndarray
        From `law_table`, of a surface whose partly stretched branch is not tabulated.
    joined, stretch : float
        Z and S over roughness [1], 0 < S < D.
    """
    pull, rate, _ = _sums(table, joined, stretch)
    loads, _, pieces = _asperity_offsets(table)
    offset = int(table[H_PSI])
    low = table[offset]
    count = round((GAP_HIGH - low) * KNOTS_PER_SIGMA)
    # S moves both the heights and the lower end, where the load is that of stretch S
    edge, _ = _septic(table, offset + 1, joined - table[int(table[H_PARTIAL])], low, count)
    e_low = math.sqrt(max(1.0 - stretch / table[H_STRETCH], 0.0))
    return pull, rate + _piece_value(table, loads, pieces, e_low) * edge


@compiled
def integrated_work(table: Floats, joined: float, stretch: float) -> tuple[float, float]:
    """Integral of t(Z, S') over S' from 0 to S, and its slope t(Z, S); parameters as for `integrated_value`."""
    pull, _, work = _sums(table, joined, stretch)
    return work, pull


_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(8)


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
    return integrated_value(table, joined, stretch)


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
        Z, height above which asperities are joined plus the distance of joining, over roughness [1]; clipped to
        G - D .. G.

    Returns
    -------
    q, slope : float
        Positive pushes apart. The slope is along the branch that the contact is on.
    """
    q, slope = loading_value(table, HEADER, gap)
    more, rate = stretched_value(table, gap, joined)
    return q + more, slope + rate
