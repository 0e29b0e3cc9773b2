"""Search along a number for where an outcome changes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from itertools import pairwise

STRIDE = 4.0
"""Factor by which a search widens."""
_HEAVIEST = 1e12
"""Nothing above this many times the lowest value is tried."""


def bracket(tried: Mapping[float, bool], *, falling: bool = False) -> tuple[float, float]:
    """Return the two values tried between which an outcome changes.

    `tried` says whether it holds at each value; it does at the large ones, or with `falling` at the small ones. The
    first of the two is the value at which it does not hold that is nearest to those, the other the next beyond, at
    which it holds; both are NaN where there are no such neighbours.
    """
    ends = (math.nan, math.nan)
    for value, beyond in pairwise(sorted(tried, reverse=falling)):
        if tried[beyond] and not tried[value]:
            ends = (value, beyond)
    return ends


def next_value(tried: Mapping[float, bool], first: float, lowest: float, tolerance: float) -> float | None:
    """Return the value to try next where an outcome holds above some positive value, and not below.

    The search begins at `first` and tries no value below `lowest`. None where the bracket is as narrow as `tolerance`,
    relative to the value, or no value in reach makes one.
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


def crossing(surplus: Callable[[float], float], lowest: float, error: float = 1e-3) -> float:
    """Value at which a surplus becomes positive as the value grows, with a relative error.

    Returns
    -------
    float
        0 where it is positive at the lowest value already, infinite where it is at none.
    """
    from scipy.optimize import brentq  # which takes long to load

    tried: dict[float, bool] = {}
    while (value := next_value(tried, lowest, lowest, STRIDE)) is not None:
        tried[value] = surplus(value) > 0.0
    if tried[lowest]:
        return 0.0
    if not any(tried.values()):
        return math.inf
    low, high = map(math.log, bracket(tried))
    return math.exp(float(brentq(lambda logarithm: surplus(math.exp(logarithm)), low, high, xtol=error)))
