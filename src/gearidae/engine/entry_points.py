"""Compiled functions that Python calls at every step, with the address of the model in place of the model.

Numba needs some 50 us to look at the three records of a model that is handed over from Python, and a fifth of one for
a number. Between compiled functions a model costs nothing.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.events.asperity_events import first_grazing_minimum, note_step_start
from gearidae.engine.events.events import guard
from gearidae.engine.integrate.driver import Output
from gearidae.engine.integrate.resting import rest_step
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import Floats
from gearidae.engine.motion.observe import observe
from gearidae.engine.motion.residual import jacobian
from gearidae.engine.step import finish_step, residual_of_attempt


@compiled
def residual_at(address: int, t: float, y: Floats, yp: Floats, out: Floats) -> None:
    """`gearidae.engine.step.residual_of_attempt`."""
    residual_of_attempt(model_at(address), t, y, yp, out)


@compiled
def jacobian_at(address: int, t: float, cj: float, y: Floats, out: Floats) -> None:
    """`gearidae.engine.motion.residual.jacobian`."""
    jacobian(model_at(address), t, cj, y, out)


@compiled
def guard_at(address: int, t: float, y: Floats) -> float:
    """`gearidae.engine.events.events.guard`."""
    return guard(model_at(address), t, y)


@compiled
def note_step_start_at(address: int, t: float, y: Floats) -> None:
    """`gearidae.engine.events.asperity_events.note_step_start`, with the guard asked there."""
    m = model_at(address)
    guard(m, t, y)
    note_step_start(m, y)


@compiled
def first_grazing_minimum_at(address: int, t: float, y: Floats, h: float) -> float:
    """`gearidae.engine.events.asperity_events.first_grazing_minimum`, with the guard asked at the end of the step."""
    m = model_at(address)
    guard(m, t, y)
    return first_grazing_minimum(m, y, h)


@compiled
def observe_at(address: int, t: float, y: Floats, row: Floats) -> None:
    """`gearidae.engine.motion.observe.observe`."""
    observe(model_at(address), t, y, row)


@compiled
def finish_step_at(
    address: int,
    t: float,
    y: Floats,
    yp: Floats,
    between: tuple[Floats, Floats],
    flag: int,
    out: Output,
) -> bool:
    """`gearidae.engine.step.finish_step`."""
    return finish_step(model_at(address), t, y, yp, between, flag, out)


@compiled
def rest_step_at(address: int, t: float, y: Floats) -> tuple[float, int]:
    """`gearidae.engine.integrate.resting.rest_step`."""
    return rest_step(model_at(address), t, y)
