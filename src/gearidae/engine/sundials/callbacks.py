"""What SUNDIALS calls, as C functions: residual, Jacobian, weights, Newton's iteration and linear solver."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numba import carray, types  # type: ignore[attr-defined]
from numpy.typing import NDArray

from gearidae.compiled import compiled_callback
from gearidae.engine.elastic.block_jacobian import assemble, factorise, solve_blocks
from gearidae.engine.integrate.newton import iterate
from gearidae.engine.model import layout as at
from gearidae.engine.model.residual import jacobian, residual
from gearidae.engine.sundials import memory as ptr
from gearidae.engine.sundials import names as sun
from gearidae.engine.sundials.vectors import vector_operations

__all__ = ["Callbacks", "callbacks"]

# This loads the library as well, without which the functions below would abort the process.
if _reason := sun.unavailable():
    raise ImportError(_reason)

Ints = NDArray[np.int64]

_PTR, _INT, _REAL = types.intp, types.int32, types.float64
_REALS: Any = types.CPointer(types.float64)  # type: ignore[no-untyped-call]


@dataclass(frozen=True, slots=True)
class Callbacks:
    """Addresses of what SUNDIALS calls.

    Attributes
    ----------
    model : ndarray of int64, shape (3,)
        Residual, Jacobian (0 if nobody asks for it), error weights.
    steps : ndarray of int64, shape (2,) or (0,)
        Set-up and solution of a linear solver of ours; none where SUNDIALS has to solve, or nothing is left to.
    newton : ndarray of int64, shape (3,) or (0,)
        What a nonlinear solver of ours answers, see `gearidae.engine.integrate.newton`; none where SUNDIALS iterates.
    vectors : ndarray of int64, shape (4,) or (0,)
        Operations on vectors, see `gearidae.engine.sundials.vectors`; none where SUNDIALS has its own.
    """

    model: Ints
    steps: Ints
    newton: Ints
    vectors: Ints


_JACOBIAN = types.int32(
    types.float64,
    types.float64,
    types.intp,
    types.intp,
    types.intp,
    types.intp,
    _REALS,
    types.intp,
    types.intp,
    types.intp,
)


_RESIDUAL = types.int32(types.float64, types.intp, types.intp, types.intp, _REALS)


@compiled_callback(_RESIDUAL)
def _unasked(t, yy, yp, rr, data):  # type: ignore[no-untyped-def]
    return -1  # IDA wants a residual, but whether it vanishes is asked by Newton's iteration alone


@compiled_callback(_INT(_PTR, _PTR, _REALS))
def _weights(yy, weights, data):  # type: ignore[no-untyped-def]
    d, out = carray(data, (ptr.MANY,)), ptr.numbers(weights)
    first = int(d[at.WEIGHTS_AT])
    for i in range(int(d[at.STATES])):
        out[i] = d[first + i]
    return 0


@cache
def _residual() -> Any:
    """Make the residual."""

    @compiled_callback(_RESIDUAL)
    def evaluate(t, yy, yp, rr, data):  # type: ignore[no-untyped-def]
        residual(carray(data, (ptr.MANY,)), t, ptr.numbers(yy), ptr.numbers(yp), ptr.numbers(rr))
        return 0

    return evaluate


@cache
def _dense() -> Any:
    """Make the Jacobian of a motion."""

    @compiled_callback(_JACOBIAN)
    def dense(t, cj, yy, yp, rr, matrix, data, tmp1, tmp2, tmp3):  # type: ignore[no-untyped-def]
        d = carray(data, (ptr.MANY,))
        jacobian(d, t, cj, ptr.numbers(yy), carray(sun.SUNDenseMatrix_Data(matrix), (16,)))
        return 0

    return dense


@cache
def _bodies() -> tuple[Any, ...]:
    """Make the Jacobian of an elastic contact, and set-up and solution of its equations."""

    @compiled_callback(_JACOBIAN)
    def blocks(t, cj, yy, yp, rr, matrix, data, tmp1, tmp2, tmp3):  # type: ignore[no-untyped-def]
        d, store = carray(data, (ptr.MANY,)), carray(sun.SUNDenseMatrix_Data(matrix), (ptr.MANY,))
        assemble(d, t, cj, ptr.numbers(yy), store)
        return 0

    @compiled_callback(_INT(_PTR, _PTR))
    def set_up(linear, matrix):  # type: ignore[no-untyped-def]
        return factorise(carray(sun.SUNDenseMatrix_Data(matrix), (ptr.MANY,)))

    @compiled_callback(_INT(_PTR, _PTR, _PTR, _PTR, _REAL))
    def solve(linear, matrix, x, b, tolerance):  # type: ignore[no-untyped-def]
        store = carray(sun.SUNDenseMatrix_Data(matrix), (ptr.MANY,))
        solve_blocks(store, ptr.numbers(b), ptr.numbers(x))
        return 0

    return blocks, set_up, solve


@cache
def _newton(n: int, content: int) -> tuple[Any, ...]:
    """Make the functions of a nonlinear solver for n unknowns, its content at this place of its record."""

    @compiled_callback(_INT(_PTR))
    def kind(newton):  # type: ignore[no-untyped-def]
        return 0  # one that finds roots

    @compiled_callback(_INT(_PTR, _PTR, _PTR, _PTR, _REAL, _INT, _PTR))
    def solve(newton, start, correction, weights, tolerance, renew, solver):  # type: ignore[no-untyped-def]
        t, predicted, rates, yy, yp, rr, cj, data = ptr.system(solver)
        return iterate(
            n,
            ptr.reals(ptr.words(newton)[content]),
            ptr.reals(data),
            t,
            ptr.step(solver),
            cj,
            ptr.numbers(predicted),
            ptr.numbers(rates),
            ptr.numbers(correction),
            ptr.numbers(yy),
            ptr.numbers(yp),
            ptr.numbers(rr),
            ptr.numbers(weights),
            tolerance,
        )

    @compiled_callback(_INT(_PTR, _PTR))
    def note_equations(newton, function):  # type: ignore[no-untyped-def]
        return 0  # they are known

    return kind, solve, note_equations


@cache
def callbacks(n: int, elastic: bool, as_ida: bool = False) -> Callbacks:
    """Return the functions for n states; they are made on first use, and once.

    Parameters
    ----------
    n : int
        States, those of the nodes included.
    elastic : bool
        Whether the contact is elastic, and the equations solved by blocks.
    as_ida : bool, optional
        Whether IDA iterates and solves by itself, where it can.
    """
    steps: tuple[Any, ...] = ()
    newton: tuple[Any, ...] = ()
    vectors: tuple[Any, ...] = ()
    if elastic:
        slopes, set_up, solve = _bodies()
        model, steps = (_residual(), slopes, _weights), (set_up, solve)
    elif as_ida:
        model = (_residual(), _dense(), _weights)
    else:
        newton, vectors = _newton(n, int(sun.newton_places()[0])), vector_operations(n)
        model = (_unasked, None, _weights)
    return Callbacks(
        *(
            np.array([f.address if f else 0 for f in part], np.int64)
            for part in (model, steps, newton, vectors)
        )
    )
