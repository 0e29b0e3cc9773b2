"""What SUNDIALS calls, as C functions: residual, Jacobian, weights, Newton's iteration and linear solver."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numba import carray, types  # type: ignore[attr-defined]

from gearidae.compiled import compiled, compiled_callback
from gearidae.engine.model.addresses import model_at
from gearidae.engine.motion.block_jacobian import assemble, factorise, solve_blocks, unknowns
from gearidae.engine.motion.residual import jacobian
from gearidae.engine.step import Attempt, iterate, residual_of_attempt
from gearidae.engine.sundials import memory as ptr
from gearidae.engine.sundials import names as sun
from gearidae.engine.sundials.ida_memory import Functions

# This loads the library as well, without which the functions below would abort the process.
if _reason := sun.unavailable():
    raise ImportError(_reason)

_PTR, _INT, _REAL = types.intp, types.int32, types.float64


_JACOBIAN = types.int32(
    types.float64,
    types.float64,
    types.intp,
    types.intp,
    types.intp,
    types.intp,
    types.intp,
    types.intp,
    types.intp,
    types.intp,
)


_RESIDUAL = types.int32(types.float64, types.intp, types.intp, types.intp, types.intp)


@compiled_callback(_RESIDUAL)
def _unasked(t, yy, yp, rr, data):  # type: ignore[no-untyped-def]
    return -1  # IDA requires a residual function, but only Newton's iteration evaluates the residual


@compiled_callback(_INT(_PTR, _PTR, _PTR))
def _weights(yy, weights, data):  # type: ignore[no-untyped-def]
    m = model_at(data)
    count = m.scene.states
    if m.work.adams.native_newton != 0:  # nodes are eliminated
        count -= m.scene.nodes * m.scene.histories
    out = ptr.numbers(weights, count)
    first = m.scene.error_weights_at
    for i in range(count):
        out[i] = m.rows[first + i]
    return 0


@cache
def _residual() -> Any:
    """Make the residual."""

    @compiled_callback(_RESIDUAL)
    def evaluate(t, yy, yp, rr, data):  # type: ignore[no-untyped-def]
        m = model_at(data)
        n = m.scene.states
        residual_of_attempt(m, t, ptr.numbers(yy, n), ptr.numbers(yp, n), ptr.numbers(rr, n))
        return 0

    return evaluate


@cache
def _dense() -> Any:
    """Make the Jacobian of a motion."""

    @compiled_callback(_JACOBIAN)
    def dense(t, cj, yy, yp, rr, matrix, data, tmp1, tmp2, tmp3):  # type: ignore[no-untyped-def]
        m = model_at(data)
        n = m.scene.states
        jacobian(m, t, cj, ptr.numbers(yy, n), carray(sun.SUNDenseMatrix_Data(matrix), (n * n,)))
        return 0

    return dense


@cache
def _bodies() -> tuple[Any, ...]:
    """Make the Jacobian of an elastic contact, and set-up and solution of its equations."""

    @compiled_callback(_JACOBIAN)
    def blocks(t, cj, yy, yp, rr, matrix, data, tmp1, tmp2, tmp3):  # type: ignore[no-untyped-def]
        m = model_at(data)
        assemble(m, t, cj, ptr.numbers(yy, m.scene.states), _store(matrix))
        return 0

    @compiled_callback(_INT(_PTR, _PTR))
    def set_up(linear, matrix):  # type: ignore[no-untyped-def]
        return factorise(_store(matrix))

    @compiled_callback(_INT(_PTR, _PTR, _PTR, _PTR, _REAL))
    def solve(linear, matrix, x, b, tolerance):  # type: ignore[no-untyped-def]
        store = _store(matrix)
        n = unknowns(store)
        solve_blocks(store, ptr.numbers(b, n), ptr.numbers(x, n))
        return 0

    return blocks, set_up, solve


@compiled(makes_arrays=True)
def _store(matrix: int) -> Any:
    """Numbers of a matrix that is one column."""
    return carray(sun.SUNDenseMatrix_Data(matrix), (sun.SUNDenseMatrix_Rows(matrix),))


@cache
def _newton(n: int) -> tuple[Any, ...]:
    """Make the functions of a nonlinear solver for n unknowns."""

    @compiled_callback(_INT(_PTR))
    def kind(newton):  # type: ignore[no-untyped-def]
        return 0  # one that finds roots

    @compiled_callback(_INT(_PTR, _PTR, _PTR, _PTR, _REAL, _INT, _PTR))
    def solve(newton, start, correction, weights, tolerance, renew, solver):  # type: ignore[no-untyped-def]
        t, predicted, rates, yy, yp, rr, cj, data = ptr.system(solver)
        attempt = Attempt(
            t,
            ptr.step(solver),
            cj,
            tolerance,
            ptr.numbers(predicted, n),
            ptr.numbers(rates, n),
            ptr.numbers(correction, n),
            ptr.numbers(yy, n),
            ptr.numbers(yp, n),
            ptr.numbers(rr, n),
            ptr.numbers(weights, n),
        )
        return iterate(n, model_at(data), attempt)

    @compiled_callback(_INT(_PTR, _PTR))
    def note_equations(newton, function):  # type: ignore[no-untyped-def]
        return 0  # they are known

    return kind, solve, note_equations


@cache
def callbacks(n: int, elastic: bool, as_ida: bool = False) -> Functions:
    """Return the functions for n states; they are made on first use, and once.

    Parameters
    ----------
    n : int
        Unknowns that IDA sees: states of the motion, and deflections of the nodes where IDA iterates by itself.
    elastic : bool
        Whether the contact is elastic, and the equations solved by blocks.
    as_ida : bool, optional
        Whether IDA iterates and solves by itself, where it can.
    """
    steps: tuple[Any, ...] = ()
    newton: tuple[Any, ...] = ()
    if not as_ida:
        newton = _newton(n)
        model = (_unasked, None, _weights)
    elif elastic:
        slopes, set_up, solve = _bodies()
        model, steps = (_residual(), slopes, _weights), (set_up, solve)
    else:
        model = (_residual(), _dense(), _weights)
    return Functions(
        *(np.array([f.address if f else 0 for f in part], np.int64) for part in (model, steps, newton))
    )
