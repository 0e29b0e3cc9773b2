"""Shares of the materials of a pair where they change with tooth and place; see `gearidae.scene.coating_table`.

Without tables the shares are in the materials' force scales, and these functions return ones.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple, TypeAlias

from gearidae.compiled import compiled, compiled_once
from gearidae.contact.kernels.evaluate import three_values, value_of_shares
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.compiling import SOLVER
from gearidae.engine.model.state import Model

__all__ = [
    "WHOLE",
    "Shares",
    "loading_of",
    "note_shares",
    "noted_shares",
    "path_position",
    "potential_of",
    "potentials_of",
    "share_changes",
    "shares_of",
]

Shares: TypeAlias = tuple[float, float, float]
"""Of bare, coated and mixed, the order of the materials."""

WHOLE: Final = (1.0, 1.0, 1.0)


class Fraction(NamedTuple):
    """Covered fraction of a flank, and its first two derivatives along the path of contact, per pitch."""

    value: float
    slope: float
    bend: float


@compiled_once(SOLVER)
def _enter_cell(m: Model, k: int, coast: int, pair: int, inside: float) -> None:
    """Have the cell of a pair and a place noted: the way along which neither side passes a middle of its places.

    Parameters
    ----------
    m : Model
    k : int
        Index of the pair's history.
    coast, pair : int
        Flank and number of the pair.
    inside : float
        Place along the path of contact, clipped to it, in pitches.
    """
    cell = m.work.cell[k]
    if inside < cell.low or inside >= cell.high or cell.number != pair + m.state.turns:
        _find_cell(m, k, coast, pair + m.state.turns, inside)


@compiled
def _find_cell(m: Model, k: int, coast: int, number: float, inside: float) -> None:
    """Note the cell of a place and a pair numbered without end; on the coast flank the gear's tooth is the next."""
    cell = m.work.cell[k]
    cell.number, cell.low, cell.high = number, -math.inf, math.inf
    for side in range(2):
        own, part = m.scene.coverage[side], cell.side[side]
        row = own.values_at + int(number + side * coast) % own.teeth * own.places
        # between the middles of two places, or before the first or behind the last
        low = min(max(math.floor(inside * own.place_scale - 0.5), -1), own.places - 1)
        part.origin, part.scale = (low + 0.5) / own.place_scale, own.place_scale
        part.before = m.tables[row + max(low, 0)]
        part.change = m.tables[row + min(low + 1, own.places - 1)] - part.before
        if low >= 0:
            cell.low = max(cell.low, part.origin)
        if low < own.places - 1:
            cell.high = min(cell.high, (low + 1.5) / own.place_scale)


@compiled(inline=True)
def _value(m: Model, k: int, side: int, inside: float) -> float:
    """Covered fraction of a side at a place in the cell that is noted."""
    part = m.work.cell[k].side[side]
    u = (inside - part.origin) * part.scale
    return part.before + part.change * (u * u * u * (10.0 - 15.0 * u + 6.0 * u * u))


@compiled(inline=True)
def _fraction(m: Model, k: int, side: int, inside: float) -> Fraction:
    """Covered fraction of a side at a place in the cell that is noted, with its derivatives."""
    part = m.work.cell[k].side[side]
    u, rise = (inside - part.origin) * part.scale, part.change * part.scale
    slope = 30.0 * rise * u * u * (1.0 - u) * (1.0 - u)
    bend = 60.0 * rise * part.scale * u * (1.0 - u) * (1.0 - 2.0 * u)
    return Fraction(_value(m, k, side, inside), slope, bend)


@compiled(inline=True)
def _shares_by_place(m: Model, k: int, coast: int, pair: int, inside: float) -> Shares:
    """Shares of the materials of a pair."""
    _enter_cell(m, k, coast, pair, inside)
    f = _value(m, k, 0, inside)
    if m.scene.patches != 0:
        return 1.0 - f, f, 0.0
    g = _value(m, k, 1, inside)
    both = f * g
    return 1.0 - f - g + both, both, f + g - 2.0 * both


@compiled(inline=True)
def shares_of(m: Model, k: int, coast: int, pair: int, inside: float) -> Shares:
    """Shares of the materials in a pair; ones where the materials' force scales have them already.

    Parameters
    ----------
    m : Model
    k : int
        Index of the pair's history.
    coast, pair : int
        Flank and number of the pair, counted without the turns taken out of the phase.
    inside : float
        Place along the path of contact, clipped to it, in pitches.
    """
    if m.scene.by_place == 0:
        return WHOLE
    return _shares_by_place(m, k, coast, pair, inside)


@compiled
def note_shares(m: Model, k: int, coast: int, pair: int, inside: float) -> None:
    """Note the shares of the materials in a pair before the nodes of its elastic contact are asked for anything.

    Parameters
    ----------
    m : Model
    k : int
        Index of the pair's history.
    coast, pair : int
        Flank and number of the pair.
    inside : float
        Place along the path of contact, clipped to it, in pitches.
    """
    if m.scene.by_place != 0:
        own = m.work.shares[k]
        own[0], own[1], own[2] = _shares_by_place(m, k, coast, pair, inside)


@compiled
def noted_shares(m: Model, k: int) -> Shares:
    """Shares that `note_shares` has noted last; ones where the materials' force scales have them already."""
    if m.scene.by_place == 0:
        return WHOLE
    own = m.work.shares[k]
    return own[0], own[1], own[2]


@compiled(inline=True)
def share_changes(m: Model, k: int, coast: int, pair: int, inside: float) -> tuple[Shares, Shares, Shares]:
    """Shares of the materials in a pair, and their first and second derivatives along the path, per pitch."""
    _enter_cell(m, k, coast, pair, inside)
    f = _fraction(m, k, 0, inside)
    if m.scene.patches != 0:
        return (1.0 - f.value, f.value, 0.0), (-f.slope, f.slope, 0.0), (-f.bend, f.bend, 0.0)
    g = _fraction(m, k, 1, inside)
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
    return value_of_shares(m.tables, m.scene.loadings_at, gap, shares)


@compiled
def potential_of(m: Model, gap: float, shares: Shares) -> float:
    """Potential of the loading branch of all materials, scaled, per length."""
    if m.scene.by_place == 0:
        return loading_value(m.tables, m.scene.potential_at, gap)[0]
    return value_of_shares(m.tables, m.scene.potentials_at, gap, shares)[0]


@compiled
def potentials_of(m: Model, gap: float) -> tuple[Shares, Shares]:
    """Potential of each material's loading branch where shares change, scaled, per length and share; its slopes."""
    return three_values(m.tables, m.scene.potentials_at, gap)


@compiled
def path_position(m: Model, coast: int, pair: int, phase: float) -> float:
    """Place of a pair along the path of contact, clipped to it, in pitches."""
    along = m.scene.coast_phase + pair - phase if coast else phase - pair
    return min(max(along, 0.0), m.scene.contact_ratio)
