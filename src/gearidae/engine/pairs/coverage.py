"""Shares of the materials of a pair; tables by tooth and position are `gearidae.scene.coating_table`.

Without such tables the shares are in the materials' force scales, and the loading branches of all materials have been
added up at set-up: shares are then ones, which do not change.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple, TypeAlias

from gearidae.compiled import compiled
from gearidae.contact.kernels.evaluate import mixed_value
from gearidae.contact.kernels.law import N_LOADING, loading_value
from gearidae.engine.model.state import Model

Shares: TypeAlias = tuple[float, float, float]
"""A number for each of bare, coated and mixed, the order of the materials."""

WHOLE: Final = (1.0, 1.0, 1.0)
NONE: Final = (0.0, 0.0, 0.0)


class Fraction(NamedTuple):
    """Covered fraction of a flank, and its first two derivatives along the path of contact, per pitch."""

    value: float
    slope: float
    curvature: float


@compiled(inline=True)
def fraction_of(m: Model, side: int, flank: int, pair: int, inside: float) -> Fraction:
    """Covered fraction of a side's tooth: smooth steps between the middles of the intervals of its table.

    On the coast flank the gear's tooth is the next one.
    """
    coverage = m.scene.coverage[side]
    row = (
        coverage.values_at
        + int(pair + m.state.whole_pitches + side * flank) % coverage.teeth * coverage.positions
    )
    along = inside * coverage.position_scale - 0.5
    # it stays before the middle of the first interval, or behind that of the last one
    last = min(max(math.floor(along), -1), coverage.positions - 1)
    before = m.tables[row + max(last, 0)]
    change = m.tables[row + min(last + 1, coverage.positions - 1)] - before
    u, rise = along - last, change * coverage.position_scale
    return Fraction(
        before + change * (u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)),
        30.0 * rise * u * u * (1.0 - u) * (1.0 - u),
        60.0 * rise * coverage.position_scale * u * (1.0 - u) * (1.0 - 2.0 * u),
    )


@compiled(inline=True)
def share_changes(m: Model, flank: int, pair: int, inside: float) -> tuple[Shares, Shares, Shares]:
    """Shares of the materials in a pair, and their first and second derivatives along the path, per pitch.

    Parameters
    ----------
    flank, pair : int
        Flank and number of the pair, counted without the turns taken out of the phase.
    inside : float
        Path position, clipped to the path of contact, in pitches.
    """
    if m.scene.covered_by_position == 0:
        return WHOLE, NONE, NONE
    f = fraction_of(m, 0, flank, pair, inside)
    if m.scene.patches != 0:
        return (1.0 - f.value, f.value, 0.0), (-f.slope, f.slope, 0.0), (-f.curvature, f.curvature, 0.0)
    g = fraction_of(m, 1, flank, pair, inside)
    total, total_slope, total_curvature = f.value + g.value, f.slope + g.slope, f.curvature + g.curvature
    both, slope = f.value * g.value, f.slope * g.value + f.value * g.slope
    curvature = f.curvature * g.value + 2.0 * f.slope * g.slope + f.value * g.curvature
    return (
        (1.0 - total + both, both, total - 2.0 * both),
        (slope - total_slope, slope, total_slope - 2.0 * slope),
        (curvature - total_curvature, curvature, total_curvature - 2.0 * curvature),
    )


@compiled(inline=True)
def shares_of(m: Model, flank: int, pair: int, inside: float) -> Shares:
    """Shares of the materials in a pair; parameters as for `share_changes`."""
    return share_changes(m, flank, pair, inside)[0]


@compiled
def note_shares(m: Model, k: int, flank: int, pair: int, inside: float) -> None:
    """Note the shares of the materials in the pair with the k-th history, for the nodes of its elastic contact."""
    if m.scene.covered_by_position != 0:
        shares = m.work.shares[k]
        shares[0], shares[1], shares[2] = shares_of(m, flank, pair, inside)


@compiled
def noted_shares(m: Model, k: int) -> Shares:
    """Shares that `note_shares` has noted last."""
    if m.scene.covered_by_position == 0:
        return WHOLE
    shares = m.work.shares[k]
    return shares[0], shares[1], shares[2]


@compiled(inline=True)
def weighed(shares: Shares, values: Shares) -> float:
    """Sum of the materials' values times their shares."""
    return shares[0] * values[0] + shares[1] * values[1] + shares[2] * values[2]


@compiled(inline=True)
def loading_of(m: Model, gap: float, shares: Shares) -> tuple[float, float]:
    """Loading branch of all materials and its slope, scaled, for a contact of unit length."""
    if m.scene.covered_by_position == 0:
        return loading_value(m.tables, m.scene.loading_at, gap)
    return mixed_value(m.tables, m.scene.loading_at, gap, shares)


@compiled(inline=True)
def rubs_by_material(m: Model) -> bool:
    """Whether the limits of the flanks' friction are sums of the materials', not the same share of all forces."""
    return bool(m.scene.friction.flanks != 0 and m.scene.friction.even == 0.0)


@compiled(inline=True)
def limit_of_loading(m: Model, gap: float, shares: Shares) -> tuple[float, float]:
    """Limit of the friction of the loading branch of all materials and its slope, as `loading_of`."""
    if m.scene.covered_by_position == 0:
        return loading_value(m.tables, m.scene.friction.loading_at, gap)
    return mixed_value(m.tables, m.scene.friction.loading_at, gap, shares)


@compiled(inline=True)
def added(a: tuple[Shares, Shares], b: tuple[Shares, Shares]) -> tuple[Shares, Shares]:
    """Sum of what two laws say of each material, and of its slope."""
    (a0, a1, a2), (a3, a4, a5) = a
    (b0, b1, b2), (b3, b4, b5) = b
    return (a0 + b0, a1 + b1, a2 + b2), (a3 + b3, a4 + b4, a5 + b5)


@compiled
def potential_of(m: Model, gap: float, shares: Shares) -> float:
    """Potential of the loading branch of all materials, scaled, per length."""
    if m.scene.covered_by_position == 0:
        return loading_value(m.tables, m.scene.potential_at, gap)[0]
    return mixed_value(m.tables, m.scene.potential_at, gap, shares)[0]


@compiled
def potentials_of(m: Model, gap: float) -> tuple[Shares, Shares]:
    """Potential of each material's loading branch, scaled, per length and share, and its slopes.

    Without tables the first is that of the loading branches of all materials together.
    """
    first = m.scene.potential_at
    a, a1 = loading_value(m.tables, first, gap)
    b = b1 = c = c1 = 0.0
    if m.scene.covered_by_position != 0:
        b, b1 = loading_value(m.tables, first + 8 * N_LOADING, gap)
        c, c1 = loading_value(m.tables, first + 16 * N_LOADING, gap)
    return (a, b, c), (a1, b1, c1)


@compiled
def path_position(m: Model, flank: int, pair: int, phase: float) -> float:
    """Position of a pair along the path of contact, clipped to it, in pitches."""
    along = m.scene.coast_phase + pair - phase if flank else phase - pair
    return min(max(along, 0.0), m.scene.contact_ratio)
