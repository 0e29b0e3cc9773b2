"""Cycle jump: a state that changes slowly with the number of passages, from rates that cost a simulation each.

The rates are those of a frozen state. Between them the state is integrated over passages by scipy's Runge-Kutta pair
of order 3(2) (Bogacki and Shampine), so that the error of each jump is estimated and its length follows from the
tolerance.
Where the gear sticks there is no rate: steps are then shortened until the passage is known. Steps that would be shorter
than what their rates cost are not worth a jump: there the cycles are simulated one after another.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Final, Protocol

import numpy as np

from gearidae.arrays import Floats

_FIRST: Final = 0.01
"""Change of the state in the first step."""
_ABSOLUTE: Final = 0.1
"""Absolute tolerance over the relative one."""
_FASTER: Final = 1.1
"""Loss in the second half of a stretch over that in the first, up to which a jump is tried again."""


class GearStuck(Exception):  # noqa: N818  # it is no error
    """The gear sticks in this state, so that there is no rate; of cycles simulated one by one, with the passages."""


class _TooFar(Exception):  # noqa: N818  # it is no error
    """A trial of a step has lost more than there is: its rate says nothing."""


class Direct(Protocol):
    """How to simulate cycle after cycle."""

    @property
    def worth(self) -> float:
        """Passages below which a jump is not worth its rates."""

    def follow(self, passages: float, state: Floats) -> Iterator[tuple[float, Floats]]:
        """Go through cycles from a state on: passages and states with which the gear turned, the given one first.

        Raises
        ------
        GearStuck
            With the passages by which the gear sticks.
        """


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
    direct: Direct | None = None,
    life: Life | None = None,
) -> Life:
    """Integrate a coverage over passages.

    Parameters
    ----------
    rate : callable
        Change of the state in a passage, of a state within 0..1; raises `GearStuck` where the gear sticks.
    start : ndarray, shape (n,)
        State at the beginning.
    passages : float
        After so many the integration ends.
    tolerance : float
        Relative tolerance of each step.
    least : float, optional
        Mean of the state at which the integration ends.
    bracket : float, optional
        Width, over the passages, at which the passage where the gear sticks is known well enough.
    direct : Direct, optional
        Simulates cycle after cycle where a jump is not worth its rates.
    life : Life, optional
        Continued with each step; what it holds is there also where an exception ends the integration. By default a new
        one.
    """
    life, known = Life() if life is None else life, dict[bytes, Floats]()
    life.add(0.0, start)

    def of(n: float, state: Floats) -> Floats:
        if np.mean(state) < 0.0 and np.mean(life.states[-1]) > _FIRST:
            raise _TooFar
        inside = np.clip(state, 0.0, 1.0)
        key = inside.tobytes()
        if key not in known:
            known[key] = rate(inside)
        return known[key]

    try:
        fastest = float(np.abs(of(0.0, start)).max())
    except GearStuck:
        life.ending, life.sticks_by = "sticks", 0.0
        return life
    if fastest == 0.0:
        life.add(passages, start)
        life.ending = "passages"
        return life
    _integrate(of, life, _Limits(passages, tolerance, least, bracket), direct, _FIRST / fastest)
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
    direct: Direct | None,
    step: float,
) -> None:
    """Step until something ends it; `life` is continued."""
    upper = np.inf  # passages by which the gear sticks
    while life.ending == "interrupted":
        n, state = life.passages[-1], life.states[-1]
        bound = min(limits.passages, 0.5 * (upper + n))
        step = min(step, bound - n)
        if direct is not None and step < direct.worth:
            if _go_through(direct, life, limits):
                step, upper = 2.0 * direct.worth, np.inf
            continue
        try:
            step = _step(rate, life, limits, bound, step)
        except _TooFar:
            step *= 0.5
        except GearStuck:
            upper = n + step
            if _sticks(
                rate, n, state
            ):  # a gear that starts here; the one that was followed so far still turns
                upper = n
            step *= 0.5
        if np.isfinite(upper) and upper - life.passages[-1] <= limits.bracket * upper:
            life.ending, life.sticks_by = "sticks", upper


def _sticks(rate: Callable[[float, Floats], Floats], n: float, state: Floats) -> bool:
    try:
        rate(n, state)
    except GearStuck:
        return True
    return False


def _step(
    rate: Callable[[float, Floats], Floats], life: Life, limits: _Limits, bound: float, step: float
) -> float:
    """Take one step, and return the length of the next."""
    from scipy.integrate import RK23

    n, state = life.passages[-1], life.states[-1]
    solver = RK23(
        rate, n, state, bound, rtol=limits.tolerance, atol=_ABSOLUTE * limits.tolerance, first_step=step
    )
    solver.step()
    if np.mean(solver.y) <= limits.least < np.mean(state):
        life.add(*_crossing(solver.dense_output(), n, solver.t, limits.least))
        life.ending = "coverage"
    else:
        life.add(solver.t, np.clip(solver.y, 0.0, 1.0))
        if solver.t >= limits.passages:
            life.ending = "passages"
    return float(solver.h_abs)


def _go_through(direct: Direct, life: Life, limits: _Limits) -> bool:
    """Simulate the cycles of a stretch; whether a jump may be tried again, as the loss does not grow.

    A state is noted wherever the coverage has changed by as much as in a first step.
    """
    start, first = life.passages[-1], life.states[-1]
    last, noted, middle = (start, first), first, float(np.mean(first))
    try:
        for n, state in direct.follow(start, first):
            least = float(np.mean(state)) <= limits.least < float(np.mean(first))
            if least or n >= limits.passages:
                life.add(*_between(last, (n, state), None if not least else limits.least, limits.passages))
                life.ending = "coverage" if least else "passages"
                return False
            if n <= start + 0.5 * direct.worth:
                middle = float(np.mean(state))
            whole = n >= start + direct.worth
            if whole or np.abs(state - noted).max() >= _FIRST:
                life.add(n, state)
                noted = state
            if whole:
                break
            last = (n, state)
    except GearStuck as stuck:
        if last[0] > life.passages[-1]:
            life.add(*last)
        life.ending, life.sticks_by = "sticks", float(stuck.args[0])
        return False
    before, after = float(np.mean(first)) - middle, middle - float(np.mean(life.states[-1]))
    return after <= _FASTER * before


def _between(
    last: tuple[float, Floats], here: tuple[float, Floats], least: float | None, passages: float
) -> tuple[float, Floats]:
    """Where between two cycles the mean of the state falls to its least, or the passages are reached."""
    ends, values = (last[0], here[0]), (float(np.mean(last[1])), float(np.mean(here[1])))
    if ends[0] == ends[1]:
        return here
    if least is None:
        part = (passages - ends[0]) / (ends[1] - ends[0])
    else:
        part = (values[0] - least) / (values[0] - values[1])
    return ends[0] + part * (ends[1] - ends[0]), last[1] + part * (here[1] - last[1])


def _crossing(
    between: Callable[[float], Floats], low: float, high: float, least: float
) -> tuple[float, Floats]:
    """Where in a step the mean of the state falls to its least."""
    from scipy.optimize import brentq

    n = float(brentq(lambda x: float(np.mean(between(x))) - least, low, high, xtol=1e-9 * high))
    return n, np.clip(between(n), 0.0, 1.0)
