"""SUNDIALS' operations on vectors, for the few numbers of a motion.

Its own are made for long vectors: with four numbers, to find out which special case a sum is takes longer than the sum.
The four that a step needs most are done here, in the same order, so that nothing comes out differently.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

from numba import carray, types  # type: ignore[attr-defined]

from gearidae.compiled import compiled_callback
from gearidae.engine.integrate.adams import weighed_squares
from gearidae.engine.sundials import memory as ptr

__all__ = ["vector_operations"]

_PTR, _INT, _REAL = types.intp, types.int32, types.float64
_REALS: Any = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_WORDS: Any = types.CPointer(types.int64)  # type: ignore[no-untyped-call]


@cache
def vector_operations(n: int) -> tuple[Any, ...]:
    """Make the operations `gearidae.engine.sundials.names.OF_VECTORS` for vectors of n numbers."""

    @compiled_callback(_REAL(_PTR, _PTR))
    def norm(x, weights):  # type: ignore[no-untyped-def]
        return math.sqrt(weighed_squares(n, ptr.numbers(x, n), ptr.numbers(weights, n)) / n)

    @compiled_callback(types.void(_REAL, _PTR, _REAL, _PTR, _PTR))
    def linear_sum(a, x, b, y, z):  # type: ignore[no-untyped-def]
        first, second, out = ptr.numbers(x, n), ptr.numbers(y, n), ptr.numbers(z, n)
        for j in range(n):
            out[j] = a * first[j] + b * second[j]

    @compiled_callback(_INT(_INT, _REALS, _WORDS, _PTR))
    def combination(count, factors, vectors, z):  # type: ignore[no-untyped-def]
        out, c, x = ptr.numbers(z, n), carray(factors, (count,)), carray(vectors, (count,))
        for j in range(n):
            total = 0.0
            for i in range(count):
                total += c[i] * ptr.numbers(x[i], n)[j]
            out[j] = total
        return 0

    @compiled_callback(_INT(_INT, _REAL, _WORDS, _REAL, _WORDS, _WORDS))
    def linear_sums(count, a, xs, b, ys, zs):  # type: ignore[no-untyped-def]
        x, y, z = carray(xs, (count,)), carray(ys, (count,)), carray(zs, (count,))
        for i in range(count):
            first, second, out = ptr.numbers(x[i], n), ptr.numbers(y[i], n), ptr.numbers(z[i], n)
            for j in range(n):
                out[j] = a * first[j] + b * second[j]
        return 0

    return norm, linear_sum, combination, linear_sums
