"""Long variables looked at piece by piece, so that what is asked of them takes no more memory than a piece."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

PIECE = 2**18
"""Values looked at together."""


@dataclass(frozen=True, slots=True)
class Spread:
    """How the finite ones of some values are spread; extremes and mean are NaN if there are none.

    Attributes
    ----------
    number : int
        How many they are.
    low, high, mean : float
        Smallest, largest and mean value.
    """

    number: int
    low: float
    high: float
    mean: float


def pieces(
    array: xr.DataArray, start: int = 0, stop: int | None = None, *, size: int | None = None
) -> Iterator[tuple[int, NDArray[Any]]]:
    """Go through a variable of one dimension.

    Parameters
    ----------
    array : DataArray, shape (n,)
        In memory or in a file.
    start, stop : int, optional
        Which part, from `start` to before `stop`.
    size : int, optional
        Length of the pieces, by default `PIECE`.

    Yields
    ------
    offset : int
        Of the piece's first value.
    values : ndarray
        At most `size` values.
    """
    stop = array.size if stop is None else min(stop, array.size)
    size = size or PIECE
    for offset in range(start, stop, size):
        yield offset, array.variable[offset : min(offset + size, stop)].values


def spread(array: xr.DataArray, start: int = 0, stop: int | None = None) -> Spread:
    """Extremes and mean of a part of a variable."""
    number, low, high, total = 0, math.inf, -math.inf, 0.0
    for _, values in pieces(array, start, stop):
        finite = values[np.isfinite(values)]
        if finite.size:
            number += finite.size
            low, high = min(low, float(finite.min())), max(high, float(finite.max()))
            total += float(finite.sum())
    return Spread(number, low, high, total / number) if number else Spread(0, math.nan, math.nan, math.nan)


def reached(array: xr.DataArray) -> int:
    """Samples of a run up to its last one; the first ones may be missing, as in a running mean."""
    for offset in reversed(range(0, array.size, PIECE)):
        present = np.isfinite(array.variable[offset : offset + PIECE].values)
        if present.any():
            return offset + len(present) - int(present[::-1].argmax())
    return 0


def count(array: xr.DataArray, value: float) -> int:
    """How often a value occurs."""
    return sum(int(np.count_nonzero(values == value)) for _, values in pieces(array))
