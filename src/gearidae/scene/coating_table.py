"""Fractions of a coating by tooth and place: how a table is given, and what it means between its places.

A table has a row for each tooth, or one row for all of them, and in each row a fraction for each place. Places are
equal parts of the path of contact, and so of the roll angle, which grows in proportion along it. Those of both tables
are counted from the root of the pinion's teeth, which meets the tip of the gear's: on the drive flank from where
contact begins. Both flanks of a tooth have the row of the tooth.

A fraction is that of the table in the middle of its place. Between two middles it follows ``u^3 (10 - 15 u + 6 u^2)``,
whose first and second derivatives are zero at both ends, so that it never leaves the range of the two, has the mean of
a straight line, and is smooth enough for formulas of high order; before the first and behind the last middle it stays.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.scene.group import shorten
from gearidae.scene.quantity import Quantity

if TYPE_CHECKING:
    from gearidae.scene.scene import Scene

MOST_PLACES: Final = 64
"""Places along a flank: steps of the solver follow each of them."""
_MOST_TEETH: Final = 10_000
_POINTS: Final = 16  # in each place, for means along the path


def _as_rows(value: object) -> object:
    """Turn nested lists or an array of shape (teeth, places) or (teeth,) into rows; what they hold is read later."""
    value = value.tolist() if hasattr(value, "tolist") else value
    if not isinstance(value, (list, tuple)):
        raise ValueError("must be a list of teeth, each a list of fractions along the flank, or one fraction")
    if len(value) > _MOST_TEETH:
        raise ValueError(f"has {len(value)} rows; there may be {_MOST_TEETH} at most")
    rows = tuple(tuple(row) if isinstance(row, (list, tuple)) else (row,) for row in value)
    positions = {len(row) for row in rows}
    if len(positions) > 1:
        first = next(k for k, row in enumerate(rows) if len(row) != len(rows[0]))
        raise ValueError(
            f"row {first + 1} has {len(rows[first])} places and the first {len(rows[0])}: all must have as many"
        )
    if not positions <= set(range(1, MOST_PLACES + 1)):
        raise ValueError(f"has {positions.pop()} places; there must be 1..{MOST_PLACES}")
    return rows


FractionTable = Annotated[
    tuple[tuple[Annotated[float, Quantity(unit="1", at_least=0, at_most=1)], ...], ...],
    BeforeValidator(_as_rows),
]


def fraction_at(table: Sequence[Sequence[float]], tooth: ArrayLike, place: ArrayLike) -> Floats:
    """Fraction that a table gives for a tooth at a place.

    Parameters
    ----------
    table : sequence of sequences of float
        A row for each tooth, or one.
    tooth : array_like of int
        Number of the tooth; they go round.
    place : array_like
        Place along the path of contact as a share of it; broadcasts against `tooth`. What is outside 0..1 is at the
        end.

    Returns
    -------
    ndarray
        Fractions [1], of the broadcast shape.
    """
    values = np.asarray(table, dtype=np.float64)
    teeth, positions = values.shape
    row, at = np.broadcast_arrays(np.asarray(tooth) % teeth, np.asarray(place, dtype=np.float64))
    position = np.clip(at * positions - 0.5, 0.0, positions - 1.0)
    low = np.minimum(position.astype(np.int64), max(positions - 2, 0))
    u = position - low
    before, after = values[row, low], values[row, np.minimum(low + 1, positions - 1)]
    return np.asarray(before + (after - before) * u**3 * (10.0 - 15.0 * u + 6.0 * u**2))


def met_teeth(pair: ArrayLike, *, coast: bool) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Numbers of the pinion's and the gear's tooth that make a pair, not yet reduced by the gears' teeth.

    Parameters
    ----------
    pair : array_like of int
        Number of the pair, as in ``event_pair``.
    coast : bool
        Whether it is one of the coast flank: there the back of a pinion's tooth meets the gear's tooth behind it.

    Returns
    -------
    pinion, gear : ndarray of int
    """
    number = np.asarray(pair, dtype=np.int64)
    return number, number + int(coast)


def path_means(
    pinion: Sequence[Sequence[float]], gear: Sequence[Sequence[float]]
) -> tuple[float, float, float]:
    """Means of both fractions and of their product, over all pairs of teeth that meet and along the path of contact.

    Teeth that meet have numbers that differ by multiples of the greatest common divisor of the numbers of teeth.

    Parameters
    ----------
    pinion, gear : sequence of sequences of float
        Tables.

    Returns
    -------
    first, second, product : float
    """
    positions = max(len(pinion[0]), len(gear[0]))
    along = (np.arange(_POINTS * positions) + 0.5) / (_POINTS * positions)
    sides = [fraction_at(table, np.arange(len(table))[:, None], along) for table in (pinion, gear)]
    meets = math.gcd(*(len(side) for side in sides))
    first, second = (side.reshape(-1, meets, along.size).mean(axis=0) for side in sides)
    return float(first.mean()), float(second.mean()), float((first * second).mean())


def check_tables(scene: Scene) -> None:
    """Refuse tables that do not fit the gears, and contacts that have none.

    Raises
    ------
    SceneError
        Naming ``coating.pinion_table`` or ``coating.gear_table``.
    """
    if scene.gears is None and scene.roller is None:
        return  # each mesh of a train is checked as a pair
    for side in ("pinion", "gear"):
        table: Any = getattr(scene.coating, f"{side}_table")
        if not table:
            continue
        key = f"coating.{side}_table"
        if scene.gears is None:
            raise SceneError(key, shorten(table), "needs gears: a roller has no teeth")
        teeth = getattr(scene.gears, f"{side}_teeth")
        if len(table) not in (1, teeth):
            raise SceneError(
                key,
                f"({len(table)} rows)",
                f"must have {teeth} rows, one for each tooth, or one row for all",
            )
