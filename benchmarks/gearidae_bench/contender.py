"""What takes part in the benchmark: a name, a ladder of tolerances, and a way to run a scaled problem."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.engine.backend import run_blocks
from gearidae.engine.integrate.driver import Ending
from gearidae.engine.model.state import Model
from gearidae.engine.setup.problem import Problem
from gearidae.records import Statistics
from gearidae_bench.loop import run_dop853, run_rk4
from gearidae_bench.reference import alone, end_of, physical
from gearidae_bench.roots import CALLS, FAILED, STEPS

__all__ = ["TOLERANCES", "Contender", "Outcome", "engine_contenders", "explicit_contenders", "unused"]

Floats = NDArray[np.float64]

TOLERANCES: Final = tuple(10.0**-k for k in range(3, 13))
STEP_LENGTHS: Final = tuple(0.4 * 0.5**k for k in range(9))
"""Of the fixed-step method, over the scene's tau."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """Samples of a run and what they cost.

    Attributes
    ----------
    speed, position : ndarray, shape (n,)
        As in `gearidae_bench.reference.Reference`; shorter for a run that broke off.
    steps, evaluations : int
        Steps of the integrator, and evaluations of the right-hand side or residual.
    """

    speed: Floats
    position: Floats
    steps: int
    evaluations: int


BROKEN: Final = Outcome(np.empty(0), np.empty(0), 0, 0)


def unused(problem: Problem) -> Problem:
    """Copy of a problem, for a run that may use it up."""
    m = problem.model
    scene, state, work = (np.array([record])[0] for record in (m.scene, m.state, m.work))
    model = Model(scene, state, work, m.tables.copy(), m.rows.copy())
    return replace(problem, model=model, start=problem.start.copy())


def _always() -> str:
    return ""


@dataclass(frozen=True, slots=True)
class Contender:
    """One way to integrate a scene.

    Attributes
    ----------
    key, label : str
        Short name, and what tables and pictures say.
    run : callable
        Takes a problem (which it may use up), a tolerance and the sample times over tau; returns an `Outcome`.
    ladder : tuple of float
        Tolerances (or step lengths), from loose to tight.
    unavailable : callable
        Says why it cannot run here; an empty string if it can.
    peer : str
        What kind of peer it is: ``gearidae``, ``python`` (steps driven from Python) or ``compiled``.
    jumps : bool
        Whether it begins anew where forces jump, so that it can run a population of asperities.
    """

    key: str
    label: str
    run: Callable[[Problem, float, Floats], Outcome]
    peer: str
    ladder: tuple[float, ...] = TOLERANCES
    unavailable: Callable[[], str] = field(default=_always)
    jumps: bool = False


def _engine(backend: str, *, follow: bool = True) -> Callable[[Problem, float, Floats], Outcome]:
    """Run with one of the package's drivers; with its energy balance and extremes, or like a peer that has neither."""

    def run(problem: Problem, tolerance: float, times: Floats) -> Outcome:
        statistics = Statistics()
        if not follow:
            alone(problem)
        table = np.concatenate(
            [b.rows for b in run_blocks(problem, tolerance, times.size, backend, statistics)]
        )
        if statistics.ending is not Ending.FINISHED:
            return BROKEN
        names = ("speed", "height") if "height" in problem.columns else ("gear_speed", "transmission_error")
        speed, position = (table[:, problem.columns.index(name)] for name in names)
        return Outcome(speed, position, statistics.steps, statistics.residual_evaluations)

    return run


def _no_native() -> str:
    from gearidae.engine.sundials.names import unavailable

    return unavailable()


def engine_contenders() -> tuple[Contender, ...]:
    """gearidae's own drivers."""
    return (
        Contender(
            "native", "gearidae, native", _engine("native"), "gearidae", unavailable=_no_native, jumps=True
        ),
        Contender(
            "native_alone",
            "gearidae, native, without balance and extremes",
            _engine("native", follow=False),
            "gearidae",
            unavailable=_no_native,
            jumps=True,
        ),
        Contender("portable", "gearidae, sksundae", _engine("sksundae"), "gearidae", jumps=True),
    )


def _dop853(problem: Problem, tolerance: float, times: Floats) -> Outcome:
    states, counts = np.empty((times.size, problem.start.size)), np.zeros(4, np.int64)
    atol = tolerance * problem.tolerance_scale
    # ending steps at the kinks was tried and takes twice as long at equal error; where forces jump, steps must
    land = bool(problem.model.scene.population.flanks > 0)
    m = alone(problem).model
    run_dop853(m, problem.start, end_of(problem), times, states, atol, land, counts, np.zeros(2))
    return _outcome(problem, states, counts)


def _rk4(problem: Problem, step: float, times: Floats) -> Outcome:
    states, counts = np.empty((times.size, problem.start.size)), np.zeros(4, np.int64)
    m = alone(problem).model
    run_rk4(m, problem.start, end_of(problem), times, states, step, counts, np.zeros(2))
    return _outcome(problem, states, counts)


def _outcome(problem: Problem, states: Floats, counts: NDArray[np.int64]) -> Outcome:
    if counts[FAILED]:
        return BROKEN
    return Outcome(*physical(problem, states), int(counts[STEPS]), int(counts[CALLS]))


def explicit_contenders() -> tuple[Contender, ...]:
    """Compiled explicit methods over the same right-hand side."""
    return (
        Contender("dop853", "DOP853, compiled", _dop853, "compiled", jumps=True),
        Contender("rk4", "RK4 of fixed step, compiled", _rk4, "compiled", STEP_LENGTHS),
    )
