"""What lies at an address: SUNDIALS' records, vectors and functions as compiled code sees them."""

from __future__ import annotations

from typing import Any, Final

from llvmlite import ir
from numba import carray, types  # type: ignore[attr-defined]
from numba.core import cgutils
from numba.extending import intrinsic

from gearidae.arrays import Floats, Ints
from gearidae.compiled import compiled


def _to_integers(typing: Any, address: Any) -> Any:
    """Type of an address taken as a pointer to integers."""
    return types.CPointer(types.int64)(address), _cast  # type: ignore[no-untyped-call]


def _to_reals(typing: Any, address: Any) -> Any:
    """Type of an address taken as a pointer to real numbers."""
    return types.CPointer(types.float64)(address), _cast  # type: ignore[no-untyped-call]


def _cast(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    return builder.inttoptr(values[0], context.get_value_type(signature.return_type))


SYSTEM: Final = "IDAGetNonlinearSystemData"


def _system(typing: Any, solver: Any) -> Any:
    """Type of what IDA lets a nonlinear solver see, and the code that reads it."""
    kinds = [types.float64, *[types.int64] * 5, types.float64, types.int64]

    def ask(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        cells = [cgutils.alloca_once(builder, context.get_value_type(kind)) for kind in kinds]  # type: ignore[no-untyped-call]
        word = ir.IntType(64)
        kind = ir.FunctionType(ir.IntType(32), [word] * (1 + len(cells)))
        function = cgutils.get_or_insert_function(builder.module, kind, SYSTEM)  # type: ignore[no-untyped-call]
        builder.call(function, [values[0], *(builder.ptrtoint(cell, word) for cell in cells)])
        return context.make_tuple(builder, signature.return_type, [builder.load(cell) for cell in cells])

    return types.Tuple(kinds)(solver), ask  # type: ignore[no-untyped-call]


CURRENT_STEP: Final = "IDAGetCurrentStep"


def _step(typing: Any, solver: Any) -> Any:
    """Make what types and compiles the question to IDA for its step."""

    def ask(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        word = ir.IntType(64)
        cell = cgutils.alloca_once(builder, ir.DoubleType())  # type: ignore[no-untyped-call]
        function = cgutils.get_or_insert_function(  # type: ignore[no-untyped-call]
            builder.module, ir.FunctionType(ir.IntType(32), [word, word]), CURRENT_STEP
        )
        builder.call(function, [values[0], builder.ptrtoint(cell, word)])
        return builder.load(cell)

    return types.float64(solver), ask


_integers_at: Any = intrinsic(_to_integers)
_reals_at: Any = intrinsic(_to_reals)
system: Any = intrinsic(_system)
"""Time, vectors (predicted state and rates, state, rates, residual), leading coefficient and user data of a solver."""
step: Any = intrinsic(_step)
"""Length of the step that IDA tries, or has chosen for the next."""


@compiled(makes_arrays=True, inline=True)
def words(address: int, count: int) -> Ints:
    """Look at what lies at an address as so many pointers."""
    return carray(_integers_at(address), (count,))


@compiled(makes_arrays=True, inline=True)
def numbers(vector: int, n: int) -> Floats:
    """Look at the n numbers of a serial vector, given by its address, without a call."""
    return carray(_reals_at(words(words(vector, 1)[0], 2)[1]), (n,))


OPERATIONS: Final = 64
"""Entries that a table of SUNDIALS' functions has at most."""


@compiled
def replace(record: int, where: Ints, functions: Ints) -> None:
    """Give a solver other functions.

    Parameters
    ----------
    record : int
        Its address.
    where : ndarray of int64, shape (n + 1,)
        Index of the table in the record, and of the functions in the table.
    functions : ndarray of int64, shape (n,)
        Addresses.
    """
    table = words(words(record, where[0] + 1)[where[0]], OPERATIONS)
    for k in range(functions.size):
        table[where[k + 1]] = functions[k]
