"""What SUNDIALS calls, as C functions: residual, Jacobian, weights, Newton's iteration and linear solver."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numba import carray, types  # type: ignore[attr-defined]
from numpy.typing import NDArray

from gearidae.compiled import compiled_callback
from gearidae.engine import layout as at
from gearidae.engine import pointers as ptr
from gearidae.engine import small
from gearidae.engine import sundials as sun
from gearidae.engine.blocks import assemble, factorise, solve_blocks
from gearidae.engine.newton import STORE, iterate, keep_set_up
from gearidae.engine.residual import jacobian, residual

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
        Residual, Jacobian, error weights.
    steps : ndarray of int64, shape (2,)
        The linear solver's set-up and solution.
    newton : ndarray of int64, shape (4,) or (0,)
        What a nonlinear solver answers, see `gearidae.engine.newton`; none where SUNDIALS iterates by itself.
    """

    model: Ints
    steps: Ints
    newton: Ints


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


@compiled_callback(types.int32(types.float64, types.intp, types.intp, types.intp, _REALS))
def _residual(t, yy, yp, rr, data):  # type: ignore[no-untyped-def]
    d = carray(data, (ptr.MANY,))
    residual(
        d,
        t,
        ptr.numbers(yy),
        ptr.numbers(yp),
        ptr.numbers(rr),
    )
    return 0


@compiled_callback(_JACOBIAN)
def _jacobian(t, cj, yy, yp, rr, matrix, data, tmp1, tmp2, tmp3):  # type: ignore[no-untyped-def]
    d = carray(data, (ptr.MANY,))
    jacobian(d, t, cj, ptr.numbers(yy), carray(sun.SUNDenseMatrix_Data(matrix), (16,)))
    return 0


@compiled_callback(_INT(_PTR, _PTR, _REALS))
def _weights(yy, weights, data):  # type: ignore[no-untyped-def]
    d, out = carray(data, (ptr.MANY,)), ptr.numbers(weights)
    first = int(d[at.WEIGHTS_AT])
    for i in range(int(d[at.STATES])):
        out[i] = d[first + i]
    return 0


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
def _few_steps(n: int) -> tuple[Any, ...]:
    """Make the set-up and solution of n linear equations."""

    @compiled_callback(_INT(_PTR, _PTR))
    def set_up(linear, matrix):  # type: ignore[no-untyped-def]
        return small.factorise(n, carray(sun.SUNDenseMatrix_Data(matrix), (ptr.MANY,)))

    @compiled_callback(_INT(_PTR, _PTR, _PTR, _PTR, _REAL))
    def solve(linear, matrix, x, b, tolerance):  # type: ignore[no-untyped-def]
        store = carray(sun.SUNDenseMatrix_Data(matrix), (ptr.MANY,))
        small.solve(n, store, ptr.numbers(b), ptr.numbers(x))
        return 0

    return set_up, solve


@cache
def _newton(n: int, content: int) -> tuple[Any, ...]:
    """Make the functions of a nonlinear solver for n unknowns, its content at this place of its record."""

    @compiled_callback(_INT(_PTR))
    def kind(newton):  # type: ignore[no-untyped-def]
        return 0  # one that finds roots

    @compiled_callback(_INT(_PTR, _PTR, _PTR, _PTR, _REAL, _INT, _PTR))
    def solve(newton, start, correction, weights, tolerance, renew, solver):  # type: ignore[no-untyped-def]
        t, predicted, rates, yy, yp, rr, cj, data = ptr.system(solver)
        desk_at = ptr.words(newton)[content]
        desk = ptr.words(desk_at)
        return iterate(
            n,
            desk,
            ptr.reals(desk_at),
            ptr.reals(desk[STORE]),
            ptr.reals(data),
            t,
            cj,
            ptr.numbers(predicted),
            ptr.numbers(rates),
            ptr.numbers(correction),
            ptr.numbers(yy),
            ptr.numbers(yp),
            ptr.numbers(rr),
            ptr.numbers(weights),
            tolerance,
            renew != 0,
            solver,
        )

    @compiled_callback(_INT(_PTR, _PTR))
    def note_equations(newton, function):  # type: ignore[no-untyped-def]
        return 0  # they are known

    @compiled_callback(_INT(_PTR, _PTR))
    def note_set_up(newton, function):  # type: ignore[no-untyped-def]
        keep_set_up(newton, content, function)
        return 0

    return kind, solve, note_equations, note_set_up


@cache
def callbacks(n: int, elastic: bool) -> Callbacks:
    """Return the functions for n states; they are made on first use, and once.

    Parameters
    ----------
    n : int
        States, those of the nodes included.
    elastic : bool
        Whether the contact is elastic, and the equations solved by blocks.
    """
    slopes, *steps = _bodies() if elastic else (_jacobian, *_few_steps(n))
    model = (_residual, slopes, _weights)
    newton = () if elastic else _newton(n, int(sun.newton_places()[0]))
    return Callbacks(
        *(np.array([f.address for f in part], dtype=np.int64) for part in (model, steps, newton))
    )
