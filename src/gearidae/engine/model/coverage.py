"""Shares of the materials of a pair where they change with tooth and place; see `gearidae.scene.coating_table`.

Without tables the shares are in the materials' force scales, and these functions return ones.
"""

from __future__ import annotations

import math
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


@compiled(inline=True)
def _row_and_place(m: Model, side: int, number: float, inside: float) -> tuple[int, float]:
    """Where the row of a side's tooth begins, numbered without end, and the place in it, in middles of places."""
    own = m.scene.coverage[side]
    # a remainder of floats takes a tenth of that of integers; the quotient may be rounded across a whole number
    tooth = number - math.floor(number * own.inverse_teeth) * own.teeth
    if tooth < 0.0:
        tooth += own.teeth
    elif tooth >= own.teeth:
        tooth -= own.teeth
    position = min(max(inside * own.place_scale - 0.5, 0.0), own.places - 1.0)
    return own.values_at + int(tooth) * own.places, position


@compiled(inline=True)
def _value(m: Model, side: int, number: float, inside: float) -> float:
    """Covered fraction of a side's tooth at a place on the path of contact in pitches."""
    row, position = _row_and_place(m, side, number, inside)
    low = int(position)
    u = position - low
    before = m.tables[row + low]
    if u == 0.0:
        return before
    return before + (m.tables[row + low + 1] - before) * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)


@compiled
def _fraction(m: Model, side: int, number: float, inside: float) -> Fraction:
    """Covered fraction of a side's tooth at a place on the path of contact in pitches, with its derivatives."""
    row, position = _row_and_place(m, side, number, inside)
    low, scale = int(position), m.scene.coverage[side].place_scale
    u = position - low
    if u == 0.0:
        return Fraction(m.tables[row + low], 0.0, 0.0)
    before = m.tables[row + low]
    change = m.tables[row + low + 1] - before
    value = before + change * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)
    slope = 30.0 * change * scale * u * u * (1.0 - u) * (1.0 - u)
    return Fraction(value, slope, 60.0 * change * scale * scale * u * (1.0 - u) * (1.0 - 2.0 * u))


@compiled
def _shares_by_place(m: Model, coast: int, pair: int, inside: float) -> Shares:
    """Shares of the materials of a pair; on the coast flank the gear's tooth is the next."""
    number = pair + m.state.turns
    f = _value(m, 0, number, inside)
    if m.scene.patches != 0:
        return 1.0 - f, f, 0.0
    g = _value(m, 1, number + coast, inside)
    both = f * g
    return 1.0 - f - g + both, both, f + g - 2.0 * both


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
def share_changes(m: Model, coast: int, pair: int, inside: float) -> tuple[Shares, Shares, Shares]:
    """Shares of the materials in a pair, and their first and second derivatives along the path, per pitch."""
    number = pair + m.state.turns
    f = _fraction(m, 0, number, inside)
    if m.scene.patches != 0:
        return (1.0 - f.value, f.value, 0.0), (-f.slope, f.slope, 0.0), (-f.bend, f.bend, 0.0)
    g = _fraction(m, 1, number + coast, inside)
    one, one_slope, one_bend = f.value + g.value, f.slope + g.slope, f.bend + g.bend
    both, slope = f.value * g.value, f.slope * g.value + f.value * g.slope
    bend = f.bend * g.value + 2.0 * f.slope * g.slope + f.value * g.bend
    return (
        (1.0 - one + both, both, one - 2.0 * both),
        (slope - one_slope, slope, one_slope - 2.0 * slope),
        (bend - one_bend, bend, one_bend - 2.0 * bend),
    )


@compiled(inline=True)
def loading_of(m: Model, gap: float, shares: Shares) -> tuple[float, float]:
    """Loading branch of all materials and its slope, scaled, for a contact of unit length."""
    if m.scene.by_place == 0:
        return loading_value(m.tables, m.scene.loading_at, gap)
    return blended_value(m.tables, m.scene.blended_at, shares, gap)


@compiled
def potential_of(m: Model, gap: float, shares: Shares) -> float:
    """Potential of the loading branch of all materials, scaled, per length."""
    if m.scene.by_place == 0:
        return loading_value(m.tables, m.scene.potential_at, gap)[0]
    bare, coated, mixed = m.scene.material[0], m.scene.material[1], m.scene.material[2]
    value = shares[0] * loading_value(m.tables, bare.potential_at, gap)[0]
    value += shares[1] * loading_value(m.tables, coated.potential_at, gap)[0]
    if shares[2] != 0.0:
        value += shares[2] * loading_value(m.tables, mixed.potential_at, gap)[0]
    return value


@compiled
def place_inside(m: Model, coast: int, pair: int, phase: float) -> float:
    """Place of a pair along the path of contact, clipped to it, in pitches."""
    along = m.scene.coast_phase + pair - phase if coast else phase - pair
    return min(max(along, 0.0), m.scene.contact_ratio)
