"""Search along a number for where an outcome changes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise

STRIDE = 4.0
"""Factor by which a search widens."""
_HEAVIEST = 1e12
"""Nothing above this many times the lowest value is tried."""


def bracket(tried: Mapping[float, bool], *, falling: bool = False) -> tuple[float, float]:
    """Return the two values tried between which an outcome changes.

    Parameters
    ----------
    tried : mapping of float to bool
        Whether it holds at each value.
    falling : bool, optional
        Whether it holds at the small values, and not at the large ones.

    Returns
    -------
    float, float
        The value at which it does not hold that is nearest to those at which it does, and the next beyond, at which it
        holds. NaN in place of both where there are no such neighbours.
    """
    ends = (math.nan, math.nan)
    for value, beyond in pairwise(sorted(tried, reverse=falling)):
        if tried[beyond] and not tried[value]:
            ends = (value, beyond)
    return ends


def next_value(tried: Mapping[float, bool], first: float, lowest: float, tolerance: float) -> float | None:
    """Return the value to try next where an outcome holds above some positive value, and not below.

    Parameters
    ----------
    tried : mapping of float to bool
        Whether it holds at each value.
    first : float
        Where the search begins.
    lowest : float
        No value below is tried.
    tolerance : float
        Relative width at which the bracket is narrow enough.

    Returns
    -------
    float or None
        None if it is, or no value in reach makes a bracket.
    """
    fails, holds = bracket(tried)
    if not tried:
        return first if first <= lowest * _HEAVIEST else None
    if not any(tried.values()):
        wider = max(tried) * STRIDE
        return wider if wider <= lowest * _HEAVIEST else None
    if all(tried.values()):
        return max(min(tried) / STRIDE, lowest) if min(tried) > lowest else None
    return math.sqrt(holds * fails) if holds > (1.0 + tolerance) * fails else None
