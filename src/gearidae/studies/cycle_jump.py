"""Cycle jump: a state that changes slowly with the number of passages, from rates that cost a simulation each.

The rates are those of a frozen state. Between them the state is integrated over passages by scipy's Runge-Kutta pair
of order 3(2) (Bogacki and Shampine), so that the error of each jump is estimated and its length follows from the
tolerance.
Where the gear sticks there is no rate: steps are then shortened until the place is known.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["Life", "Sticks", "jump"]

Floats: TypeAlias = NDArray[np.float64]

_FIRST: Final = 0.01
"""Change of the state in the first step."""
_ABSOLUTE: Final = 0.1
"""Absolute tolerance over the relative one."""


class Sticks(Exception):  # noqa: N818  # it is no error
    """The gear sticks in this state, so that there is no rate."""


@dataclass
class Life:
    """How a state has changed.

    Attributes
    ----------
    passages : list of float
        Where steps of the integration ended; the first is 0.
    states : list of ndarray
        State there.
    ending : str
        ``sticks``, ``coverage`` or ``passages``: what was reached; ``interrupted`` until one of them is.
    sticks_by : float
        Passages by which the gear sticks, the upper end of a bracket whose lower end is the last of `passages`; NaN if
        it has not stuck.
    """

    passages: list[float] = field(default_factory=list)
    states: list[Floats] = field(default_factory=list)
    ending: str = "interrupted"
    sticks_by: float = np.nan

    def add(self, passages: float, state: Floats) -> None:
        """Note a state."""
        self.passages.append(float(passages))
        self.states.append(np.array(state))


def jump(
    rate: Callable[[Floats], Floats],
    start: Floats,
    *,
    passages: float,
    tolerance: float,
    least: float = 0.0,
    bracket: float = 0.01,
    life: Life | None = None,
) -> Life:
    """Integrate a coverage over passages.

    Parameters
    ----------
    rate : callable
        Change of the state in a passage, of a state within 0..1; raises `Sticks` where the gear sticks.
    start : ndarray, shape (n,)
        State at the beginning.
    passages : float
        After so many the integration ends.
    tolerance : float
        Relative tolerance of each step.
    least : float, optional
        Mean of the state at which the integration ends.
    bracket : float, optional
        Width, over the passages, at which the place where the gear sticks is known well enough.
    life : Life, optional
        Continued with each step; what it holds is there also where an exception ends the integration. By default a new
        one.

    Returns
    -------
    Life
    """
    life, known = Life() if life is None else life, dict[bytes, Floats]()
    life.add(0.0, start)

    def of(n: float, state: Floats) -> Floats:
        inside = np.clip(state, 0.0, 1.0)
        key = inside.tobytes()
        if key not in known:
            known[key] = rate(inside)
        return known[key]

    try:
        fastest = float(np.abs(of(0.0, start)).max())
    except Sticks:
        life.ending, life.sticks_by = "sticks", 0.0
        return life
    if fastest == 0.0:
        life.add(passages, start)
        life.ending = "passages"
        return life
    _integrate(of, life, _Limits(passages, tolerance, least, bracket), _FIRST / fastest)
    return life


@dataclass(frozen=True)
class _Limits:
    """What ends an integration, and how accurate it is."""

    passages: float
    tolerance: float
    least: float
    bracket: float


def _integrate(
    rate: Callable[[float, Floats], Floats],
    life: Life,
    limits: _Limits,
    step: float,
) -> None:
    """Step until something ends it; `life` is continued."""
    from scipy.integrate import RK23

    upper = np.inf  # passages by which the gear sticks
    while life.passages[-1] < limits.passages:
        n, state = life.passages[-1], life.states[-1]
        bound = min(limits.passages, 0.5 * (upper + n))
        room = bound - n
        step = min(step, room)
        try:
            solver = RK23(
                rate,
                n,
                state,
                bound,
                rtol=limits.tolerance,
                atol=_ABSOLUTE * limits.tolerance,
                first_step=step,
            )
            solver.step()
        except Sticks:
            upper = n + min(step, room)
            if upper - n <= limits.bracket * upper:
                life.ending, life.sticks_by = "sticks", upper
                return
            step *= 0.5
            continue
        if np.mean(solver.y) <= limits.least < np.mean(state):
            life.add(*_crossing(solver.dense_output(), n, solver.t, limits.least))
            life.ending = "coverage"
            return
        life.add(solver.t, np.clip(solver.y, 0.0, 1.0))
        step = solver.h_abs
        if upper < np.inf and upper - solver.t <= limits.bracket * upper:
            life.ending, life.sticks_by = "sticks", upper
            return
    life.ending = "passages"


def _crossing(
    between: Callable[[float], Floats], low: float, high: float, least: float
) -> tuple[float, Floats]:
    """Where in a step the mean of the state falls to its least."""
    from scipy.optimize import brentq

    n = float(brentq(lambda x: float(np.mean(between(x))) - least, low, high, xtol=1e-9 * high))
    return n, np.clip(between(n), 0.0, 1.0)
