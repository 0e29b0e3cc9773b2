"""Shares of the materials of a pair where they change with tooth and place; see `gearidae.scene.coating_table`.

Without tables the shares are in the materials' force scales, and these functions return ones.
"""

from __future__ import annotations

from typing import Final, NamedTuple, TypeAlias

from gearidae.compiled import compiled
from gearidae.contact.kernels.evaluate import blended_value
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.model.state import Model

__all__ = ["WHOLE", "Shares", "loading_of", "place_inside", "potential_of", "share_changes", "shares_of"]

Shares: TypeAlias = tuple[float, float, float]
"""Of bare, coated and mixed, the order of the materials."""

WHOLE: Final = (1.0, 1.0, 1.0)


class Fraction(NamedTuple):
    """Covered fraction of a flank, and its first two derivatives along the path of contact, per pitch."""

    value: float
    slope: float
    bend: float


@compiled
def _fraction(m: Model, side: int, tooth: int, inside: float) -> Fraction:
    """Fraction of a side's tooth, numbered without end, at a place on the path of contact in pitches."""
    own = m.scene.coverage[side]
    n = own.places
    row = own.values_at + (tooth % own.teeth) * n
    if n == 1:
        return Fraction(m.tables[row], 0.0, 0.0)
    scale = n / m.scene.contact_ratio
    position = min(max(inside * scale - 0.5, 0.0), n - 1.0)
    low = min(int(position), n - 2)
    u = position - low
    before = m.tables[row + low]
    change = m.tables[row + low + 1] - before
    value = before + change * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)
    slope = 30.0 * change * scale * u * u * (1.0 - u) * (1.0 - u)
    return Fraction(value, slope, 60.0 * change * scale * scale * u * (1.0 - u) * (1.0 - 2.0 * u))


@compiled
def _fractions(m: Model, coast: int, pair: int, inside: float) -> tuple[Fraction, Fraction]:
    """Fractions of the pinion's and the gear's flank of a pair; on the coast flank the gear's tooth is the next."""
    number = pair + int(m.state.turns)
    return _fraction(m, 0, number, inside), _fraction(m, 1, number + coast, inside)


@compiled
def _shares_by_place(m: Model, coast: int, pair: int, inside: float) -> Shares:
    f, g = _fractions(m, coast, pair, inside)
    if m.scene.patches != 0:
        return 1.0 - f.value, f.value, 0.0
    a, b = f.value, g.value
    return (1.0 - a) * (1.0 - b), a * b, a * (1.0 - b) + b * (1.0 - a)


@compiled(inline=True)
def shares_of(m: Model, coast: int, pair: int, inside: float) -> Shares:
    """Shares of the materials in a pair; ones where the materials' force scales have them already.

    Parameters
    ----------
    m : Model
    coast, pair : int
        Flank and number of the pair, counted without the turns taken out of the phase.
    inside : float
        Place along the path of contact, clipped to it, in pitches.
    """
    if m.scene.by_place == 0:
        return WHOLE
    return _shares_by_place(m, coast, pair, inside)


@compiled
def share_changes(m: Model, coast: int, pair: int, inside: float) -> tuple[Shares, Shares]:
    """First and second derivatives of the shares along the path of contact, per pitch."""
    f, g = _fractions(m, coast, pair, inside)
    if m.scene.patches != 0:
        return (-f.slope, f.slope, 0.0), (-f.bend, f.bend, 0.0)
    both, cross = f.slope * g.value + f.value * g.slope, 2.0 * f.slope * g.slope
    bend = f.bend * g.value + cross + f.value * g.bend
    one, one_bend = f.slope + g.slope, f.bend + g.bend
    return (both - one, both, one - 2.0 * both), (bend - one_bend, bend, one_bend - 2.0 * bend)


@compiled(inline=True)
def loading_of(m: Model, gap: float, shares: Shares) -> tuple[float, float]:
    """Loading branch of all materials and its slope, scaled, for a contact of unit length."""
    if m.scene.by_place == 0:
        return loading_value(m.tables, m.scene.loading_at, gap)
    bare, coated, mixed = m.scene.material[0], m.scene.material[1], m.scene.material[2]
    return blended_value(m.tables, (bare.loading_at, coated.loading_at, mixed.loading_at), shares, gap)


@compiled
def potential_of(m: Model, gap: float, shares: Shares) -> float:
    """Potential of the loading branch of all materials, scaled, per length."""
    if m.scene.by_place == 0:
        return loading_value(m.tables, m.scene.potential_at, gap)[0]
    bare, coated, mixed = m.scene.material[0], m.scene.material[1], m.scene.material[2]
    return blended_value(m.tables, (bare.potential_at, coated.potential_at, mixed.potential_at), shares, gap)[
        0
    ]


@compiled
def place_inside(m: Model, coast: int, pair: int, phase: float) -> float:
    """Place of a pair along the path of contact, clipped to it, in pitches."""
    along = m.scene.coast_phase + pair - phase if coast else phase - pair
    return min(max(along, 0.0), m.scene.contact_ratio)
