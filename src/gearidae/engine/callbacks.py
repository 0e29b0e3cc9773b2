"""What SUNDIALS calls: residual, Jacobian, guard and, for an elastic contact, its linear solver, as C functions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import carray, types  # type: ignore[attr-defined]
from numpy.typing import NDArray

from gearidae.compiled import compiled_callback
from gearidae.engine import sundials as sun
from gearidae.engine.blocks import assemble, factorise, solve_blocks
from gearidae.engine.events import guard
from gearidae.engine.residual import jacobian, residual

__all__ = ["callbacks", "linear_steps"]

# This loads the library as well, without which the functions below would abort the process.
if _reason := sun.unavailable():
    raise ImportError(_reason)

Ints = NDArray[np.int64]

_REALS: Any = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
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
_HUGE = 1 << 40  # carray wants a length; the callbacks never look at it


@compiled_callback(types.int32(types.float64, types.intp, types.intp, types.intp, _REALS))
def _residual(t, yy, yp, rr, data):  # type: ignore[no-untyped-def]
    d = carray(data, (_HUGE,))
    residual(
        d,
        t,
        carray(sun.N_VGetArrayPointer(yy), (_HUGE,)),
        carray(sun.N_VGetArrayPointer(yp), (_HUGE,)),
        carray(sun.N_VGetArrayPointer(rr), (_HUGE,)),
    )
    return 0


@compiled_callback(_JACOBIAN)
def _jacobian(t, cj, yy, yp, rr, matrix, data, tmp1, tmp2, tmp3):  # type: ignore[no-untyped-def]
    d = carray(data, (_HUGE,))
    jacobian(
        d, t, cj, carray(sun.N_VGetArrayPointer(yy), (_HUGE,)), carray(sun.SUNDenseMatrix_Data(matrix), (16,))
    )
    return 0


@compiled_callback(_JACOBIAN)
def _blocks(t, cj, yy, yp, rr, matrix, data, tmp1, tmp2, tmp3):  # type: ignore[no-untyped-def]
    d = carray(data, (_HUGE,))
    store = carray(sun.SUNDenseMatrix_Data(matrix), (_HUGE,))
    assemble(d, t, cj, carray(sun.N_VGetArrayPointer(yy), (_HUGE,)), store)
    return 0


@compiled_callback(types.int32(types.intp, types.intp))
def _setup(linear, matrix):  # type: ignore[no-untyped-def]
    return factorise(carray(sun.SUNDenseMatrix_Data(matrix), (_HUGE,)))


@compiled_callback(types.int32(types.intp, types.intp, types.intp, types.intp, types.float64))
def _solve(linear, matrix, x, b, tolerance):  # type: ignore[no-untyped-def]
    solve_blocks(
        carray(sun.SUNDenseMatrix_Data(matrix), (_HUGE,)),
        carray(sun.N_VGetArrayPointer(b), (_HUGE,)),
        carray(sun.N_VGetArrayPointer(x), (_HUGE,)),
    )
    return 0


@compiled_callback(types.int32(types.float64, types.intp, types.intp, _REALS, _REALS))
def _guard(t, yy, yp, out, data):  # type: ignore[no-untyped-def]
    d = carray(data, (_HUGE,))
    carray(out, (1,))[0] = guard(d, t, carray(sun.N_VGetArrayPointer(yy), (_HUGE,)))
    return 0


def callbacks(elastic: bool = False) -> Ints:
    """Addresses of residual, Jacobian and guard."""
    slopes = _blocks if elastic else _jacobian
    return np.array([_residual.address, slopes.address, _guard.address], dtype=np.int64)


def linear_steps() -> tuple[int, int]:
    """Addresses of set-up and solution by blocks."""
    return _setup.address, _solve.address
