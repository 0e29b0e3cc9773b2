"""Where something ends that has held so far: one bisection, and what the engine asks it.

It is asked where a root must be bracketed to the last whatever its function looks like, and speed is of no account:
zeros of a cubic between two accepted times, and the time at which gears at rest let go. The root of the guard within
a step is asked for a million times in a run; it has a search of its own (`gearidae.engine.integrate.roots`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from gearidae.compiled import compiled
from gearidae.formulas.interpolation import cubic, cubic_slope

HALVINGS: Final = 40
"""Of a step: then a share of it is known to 1e-12."""


def bisected(holds: Callable[..., bool]) -> Any:
    """Make the compiled search for the end of a condition ``holds(x, *arguments)`` that holds at the lower end.

    Returns
    -------
    callable
        ``(low, high, halvings, least, *arguments)``, which gives the last argument found at which the condition holds
        and the first at which it does not, after so many halvings or once they are no farther apart than a share
        `least` of the latter.
    """

    # a closure over a compiled function: numba keeps each on disk by what it closes over
    @compiled
    def bisect(low: float, high: float, halvings: int, least: float, *arguments: Any) -> tuple[float, float]:
        for _ in range(halvings):
            middle = 0.5 * (low + high)
            if high - low <= least * abs(high):
                break
            if holds(middle, *arguments):
                low = middle
            else:
                high = middle
        return low, high

    return bisect


@compiled
def _keeps_sign(s: float, sign: float, h: float, f0: float, rate0: float, f1: float, rate1: float) -> bool:
    return cubic(s, h, f0, rate0, f1, rate1) * sign > 0.0


@compiled
def _keeps_way(s: float, sign: float, h: float, f0: float, rate0: float, f1: float, rate1: float) -> bool:
    return cubic_slope(s, h, f0, rate0, f1, rate1) * sign > 0.0


@compiled
def _stays(
    s: float, centre: float, most: float, h: float, f0: float, rate0: float, f1: float, rate1: float
) -> bool:
    return abs(cubic(s, h, f0, rate0, f1, rate1) - centre) <= most


zero_of_cubic = bisected(_keeps_sign)
"""Shares of the way h between which a `cubic` loses a sign; arguments: the sign, and those of the cubic."""
extremum_of_cubic = bisected(_keeps_way)
"""Shares between which its slope loses a sign; arguments likewise."""
departure_of_cubic = bisected(_stays)
"""Shares between which it leaves a value by a distance; arguments: value, distance, and those of the cubic."""
