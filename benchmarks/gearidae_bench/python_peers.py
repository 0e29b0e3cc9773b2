"""What a capable user would write with scipy or scikit-sundae: compiled right-hand side, steps driven from Python.

All of them follow histories and events as gearidae does: after each step the guard is looked at, the first root is
found on the solver's own dense output, the history is taken on there, and the integration goes on without a restart.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np
import scipy.integrate
from numpy.typing import NDArray
from sksundae.cvode import CVODE
from sksundae.ida import IDA

from gearidae.engine.entry_points import guard_at, jacobian_at, residual_at
from gearidae.engine.events.histories import accept
from gearidae.engine.events.record import EVENT_NUMBERS, EVENTS_AT_ONCE
from gearidae.engine.integrate.start import set_rates
from gearidae.engine.model.addresses import Addresses, model_at
from gearidae.engine.model.state import GEARS, V, W
from gearidae.engine.motion.residual import jacobian
from gearidae.engine.setup.problem import Problem
from gearidae_bench.compiling import compiled
from gearidae_bench.contender import BROKEN, Contender, Outcome
from gearidae_bench.reference import alone, end_of, physical
from gearidae_bench.roots import CONTINUE, handle_event
from gearidae_bench.steps import rates

__all__ = ["scipy_contenders", "sundials_contenders"]

Floats = NDArray[np.float64]

_SMALLEST_RTOL: Final = (
    2.3e-14  # scipy takes no smaller one; the absolute tolerances shall decide, as they do for IDA
)
_ROOT: Final = 2  # flag of IDA's and CVODE's
_ROOT_TRIALS: Final = 60
_MOST_STEPS: Final = 10_000_000


@compiled(makes_arrays=True)
def _slope(place: int, t: float, y: Floats) -> Floats:
    out = np.empty(y.size)
    rates(model_at(place), t, y, np.zeros(y.size), out)
    return out


@compiled(makes_arrays=True)
def _slope_jacobian(place: int, t: float, y: Floats) -> Floats:
    """Partial derivatives of y' by y, from those of the residual."""
    m, n = model_at(place), y.size
    columns = np.empty(n * n)
    jacobian(m, t, 0.0, y, columns)
    out = -columns.reshape(n, n).T
    if m.scene.kind == GEARS:
        out[V] -= out[W]
    return out


@compiled()
def _rates(place: int, t: float, y: Floats, zero: Floats, out: Floats) -> None:
    rates(model_at(place), t, y, zero, out)


@compiled()
def _accept(place: int, t: float, y: Floats) -> None:
    accept(model_at(place), t, y)


@compiled()
def _arrive(place: int, t: float, y: Floats, room: Floats) -> int:
    m = model_at(place)
    accept(m, t, y)
    return handle_event(m, t, y, room)


class _Events:
    """Follows histories and events behind a solver that knows nothing of them."""

    def __init__(self, addresses: Addresses, start: Floats) -> None:
        self._addresses, self._place = addresses, addresses.base
        self._room = np.empty((EVENTS_AT_ONCE, EVENT_NUMBERS))
        self._before = guard_at(self._place, 0.0, start)
        self.failed = False

    def follow(
        self, start: float, end: float, y: Floats, value: Callable[[], Callable[[float], Floats]]
    ) -> None:
        """Go from one accepted time to the next; `value` makes the interpolant if it is needed."""
        after = guard_at(self._place, end, y)
        while self._before > 0.0 > after:
            start = self._root(start, end, after, value())
            if self.failed:
                return
            after = guard_at(self._place, end, y)
        _accept(self._place, end, y)
        self._before = guard_at(self._place, end, y)

    def _root(self, a: float, b: float, high: float, value: Callable[[float], Floats]) -> float:
        low, weight, side = self._before, 1.0, 0
        for _ in range(_ROOT_TRIALS):
            if b - a <= 1e-15 * abs(b):
                break
            place = b - (b - a) * min(max(high / (high - weight * low), 1e-3), 0.999)
            middle = guard_at(self._place, place, value(place))
            if middle < 0.0:
                b, high = place, middle
                weight = 0.5 * weight if side == 1 else 1.0
                side = 1
            else:
                a, low = place, middle
                weight = 2.0 * weight if side == -1 else 1.0
                side = -1
        state = np.ascontiguousarray(value(b))
        self.arrive(b, state)
        return b

    def arrive(self, t: float, y: Floats) -> None:
        """Deal with a root at t."""
        self.failed = _arrive(self._place, t, y, self._room) != CONTINUE
        self._before = guard_at(self._place, t, y)


def _scipy(method: Any, implicit: bool) -> Callable[[Problem, float, Floats], Outcome]:
    def run(problem: Problem, tolerance: float, times: Floats) -> Outcome:
        addresses = Addresses(alone(problem).model)
        place = addresses.base

        def fun(t: float, y: Floats) -> Floats:
            return _slope(place, t, y)

        def jac(t: float, y: Floats) -> Floats:
            return _slope_jacobian(place, t, y)

        options: dict[str, Any] = {"rtol": _SMALLEST_RTOL, "atol": tolerance * problem.tolerance_scale}
        if implicit:
            options["jac"] = jac
        solver = method(fun, 0.0, problem.start, end_of(problem), **options)
        events = _Events(addresses, problem.start)
        states = np.empty((times.size, problem.start.size))
        sample, steps = 0, 0
        while solver.status == "running":
            solver.step()
            steps += 1
            if solver.status == "failed":
                return BROKEN
            dense: list[Any] = []

            def value(dense: list[Any] = dense) -> Callable[[float], Floats]:
                if not dense:
                    dense.append(solver.dense_output())
                return dense[0]

            last = int(np.searchsorted(times, solver.t, side="right"))
            if last > sample:
                states[sample:last] = value()(times[sample:last]).T  # type: ignore[arg-type]
                sample = last
            events.follow(solver.t_old, solver.t, solver.y, value)
            if events.failed:
                return BROKEN
        states[sample:] = solver.y
        return Outcome(*physical(problem, states), steps, solver.nfev)

    return run


def _sundials(
    make: Callable[[Problem, int, float, Any], Any], names: tuple[str, ...]
) -> Callable[..., Outcome]:
    def run(problem: Problem, tolerance: float, times: Floats) -> Outcome:
        addresses, end = Addresses(alone(problem).model), end_of(problem)
        place = addresses.base

        def eventsfn(t: float, y: Floats, *rest: Floats) -> None:
            rest[-1][0] = guard_at(place, t, y.copy())  # what scikit-sundae passes is read-only

        watch: Any = (
            (lambda t, y, yp, out: eventsfn(t, y, out))
            if "_yp" in names
            else (lambda t, y, out: eventsfn(t, y, out))
        )
        watch.direction = [-1]
        solver = make(problem, place, tolerance, watch)
        events = _Events(addresses, problem.start)
        states = np.empty((times.size, problem.start.size))
        states[0] = problem.start
        sample, steps, t = 1, 0, 0.0
        while t < end:
            result = solver.step(end, method="onestep", tstop=end)
            if result.status < 0:
                return BROKEN
            if result.t == t and t > 0.0 and result.status != _ROOT:
                continue  # back from an interpolated sample: the same step once more
            t, y = float(result.t), np.ascontiguousarray(result.y)
            steps += result.status != _ROOT
            while sample < times.size and times[sample] < t:
                # a time within the last step is interpolated
                states[sample] = solver.step(times[sample]).y
                sample += 1
            if result.status == _ROOT:
                events.arrive(t, y)
                if events.failed:
                    return BROKEN
                for name in names:  # else the whole history is copied at every further step
                    getattr(watch, name).clear()
            else:
                _accept(place, t, y)
        states[sample:] = y
        return Outcome(*physical(problem, states), steps, int(result.nfev))

    return run


def _make_ida(problem: Problem, place: int, tolerance: float, watch: Any) -> Any:
    n = problem.start.size
    columns = np.empty(n * n)

    def resfn(t: float, y: Floats, yp: Floats, out: Floats) -> None:
        residual_at(place, t, y.copy(), yp.copy(), out)

    def jacfn(t: float, y: Floats, yp: Floats, res: Floats, cj: float, out: Floats) -> None:
        jacobian_at(place, t, cj, y.copy(), columns)
        out[:] = columns.reshape(n, n).T

    solver = IDA(
        resfn,
        jacfn=jacfn,
        eventsfn=watch,
        num_events=1,
        rtol=0.0,
        atol=tolerance * problem.tolerance_scale,
        max_num_steps=_MOST_STEPS,
    )
    yp = np.empty(n)
    set_rates(problem.model, 0.0, problem.start, yp)
    solver.init_step(0.0, problem.start, yp)
    return solver


def _make_cvode(method: str) -> Callable[[Problem, int, float, Any], Any]:
    def make(problem: Problem, place: int, tolerance: float, watch: Any) -> Any:
        zero = np.zeros(problem.start.size)

        def rhsfn(t: float, y: Floats, yp: Floats) -> None:
            _rates(place, t, y.copy(), zero, yp)

        def jacfn(t: float, y: Floats, yp: Floats, out: Floats) -> None:
            out[:] = _slope_jacobian(place, t, y.copy())

        solver = CVODE(
            rhsfn,
            jacfn=jacfn,
            method=method,
            eventsfn=watch,
            num_events=1,
            rtol=0.0,
            atol=tolerance * problem.tolerance_scale,
            max_num_steps=_MOST_STEPS,
        )
        solver.init_step(0.0, problem.start)
        return solver

    return make


def sundials_contenders() -> tuple[Contender, ...]:
    """scikit-sundae's own Python API."""
    ida, cvode = ("_i", "_t", "_y", "_yp"), ("_i", "_t", "_y")
    return (
        Contender("ida", "scikit-sundae IDA", _sundials(_make_ida, ida), "python"),
        Contender("cvode_bdf", "scikit-sundae CVODE, BDF", _sundials(_make_cvode("BDF"), cvode), "python"),
        Contender(
            "cvode_adams", "scikit-sundae CVODE, Adams", _sundials(_make_cvode("Adams"), cvode), "python"
        ),
    )


def scipy_contenders() -> tuple[Contender, ...]:
    """scipy's integrators, through their class API."""
    methods = (("LSODA", False), ("Radau", True), ("BDF", True), ("DOP853", False))
    return tuple(
        Contender(
            f"scipy_{name.lower()}",
            f"scipy {name}",
            _scipy(getattr(scipy.integrate, name), implicit),
            "python",
        )
        for name, implicit in methods
    )
