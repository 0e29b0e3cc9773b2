"""Polynomials at one argument, and sums over eight numbers, side by side in the processor's wide registers.

Compilers do not see that the eight coefficients of the second variable in a two-dimensional table are eight polynomials
of the first, nor that a point between the nodes of an elastic contact has shares of eight of them, so the vector
instructions are written down here.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

LANES = 8


class _Lanes:
    """Vectors of the lanes of a function that is being compiled."""

    def __init__(self, context: Any, builder: Any, kind: Any, array: Any, start: Any) -> None:
        self._builder, self._start = builder, start
        self._vector = ir.VectorType(ir.DoubleType(), LANES)
        self._data = context.make_array(kind)(context, builder, array).data

    def spread(self, value: Any) -> Any:
        """Put one number into all lanes."""
        result = ir.Constant(self._vector, ir.Undefined)
        for k in range(LANES):
            result = self._builder.insert_element(result, value, ir.Constant(ir.IntType(32), k))
        return result

    def power(self, power: int) -> Any:
        """Coefficients of a power."""
        index = self._builder.add(self._start, ir.Constant(self._start.type, LANES * power))
        address = cgutils.gep_inbounds(self._builder, self._data, index)  # type: ignore[no-untyped-call]
        return self._builder.load(self._builder.bitcast(address, self._vector.as_pointer()), align=8)

    def line(self, low: Any, high: Any, by: Any) -> Any:
        """``low + high * by``."""
        return self._builder.fadd(low, self._builder.fmul(high, by))

    def powers(self, u: Any) -> tuple[Any, Any, Any]:
        """First, second and fourth power of a number, in all lanes."""
        square = self._builder.fmul(u, u)
        return self.spread(u), self.spread(square), self.spread(self._builder.fmul(square, square))

    def parts(self, vector: Any, count: int) -> list[Any]:
        """Return the numbers of the first lanes."""
        return [self._builder.extract_element(vector, ir.Constant(ir.IntType(32), k)) for k in range(count)]


def _eight_powers(typing: Any, table: Any, start: Any, u: Any) -> Any:
    """Type and code of `eight_powers`."""

    def evaluate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        lanes = _Lanes(context, builder, signature.args[0], values[0], values[1])
        u1, u2, u4 = lanes.powers(values[2])

        def line(power: int) -> Any:
            return lanes.line(lanes.power(power), lanes.power(power + 1), u1)

        low, high = lanes.line(line(0), line(2), u2), lanes.line(line(4), line(6), u2)
        parts = lanes.parts(lanes.line(low, high, u4), LANES)
        return context.make_tuple(builder, signature.return_type, parts)

    result = types.UniTuple(types.float64, LANES)  # type: ignore[no-untyped-call]
    return result(table, types.uintp, types.float64), evaluate


eight_powers: Any = intrinsic(_eight_powers)
"""Eight polynomials of degree seven at u: their coefficients of u^0 lie at ``start``, those of u^1 after these, ..."""


def _eight(context: Any, builder: Any, kind: Any, array: Any, start: Any) -> Any:
    """Address of eight numbers of an array, as a vector."""
    data = context.make_array(kind)(context, builder, array).data
    address = cgutils.gep_inbounds(builder, data, start)  # type: ignore[no-untyped-call]
    return builder.bitcast(address, ir.VectorType(ir.DoubleType(), LANES).as_pointer())


def _add_lanes(typing: Any, out: Any, index: Any, numbers: Any, start: Any, factor: Any) -> Any:
    """Type and code of `add_lanes`."""

    def evaluate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        lanes = _Lanes(context, builder, signature.args[0], values[0], values[1])
        address = _eight(context, builder, signature.args[0], values[0], values[1])
        other = builder.load(_eight(context, builder, signature.args[2], values[2], values[3]), align=8)
        total = lanes.line(builder.load(address, align=8), other, lanes.spread(values[4]))
        builder.store(total, address, align=8)
        return context.get_dummy_value()

    return types.void(out, types.uintp, numbers, types.uintp, types.float64), evaluate


add_lanes: Any = intrinsic(_add_lanes)
"""Add eight numbers from ``start`` on, times a factor, to those of another array from ``index`` on."""


def _product_of_lanes(typing: Any, numbers: Any, index: Any, other: Any, start: Any) -> Any:
    """Type and code of `product_of_lanes`."""

    def evaluate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        first = builder.load(_eight(context, builder, signature.args[0], values[0], values[1]), align=8)
        second = builder.load(_eight(context, builder, signature.args[2], values[2], values[3]), align=8)
        total, count = builder.fmul(first, second), LANES
        while count > 1:
            count //= 2
            halves = [
                ir.Constant(ir.VectorType(ir.IntType(32), count), [part * count + k for k in range(count)])
                for part in range(2)
            ]
            low, high = (builder.shuffle_vector(total, total, half) for half in halves)
            total = builder.fadd(low, high)
        return builder.extract_element(total, ir.Constant(ir.IntType(32), 0))

    return types.float64(numbers, types.uintp, other, types.uintp), evaluate


product_of_lanes: Any = intrinsic(_product_of_lanes)
"""Scalar product of eight numbers from ``index`` on and eight of another array from ``start`` on."""


def _sum_rows(
    typing: Any, out: Any, index: Any, rows: Any, start: Any, stride: Any, factors: Any, count: Any
) -> Any:
    """Type and code of `sum_rows`."""

    def evaluate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        lanes = _Lanes(context, builder, signature.args[0], values[0], values[1])
        zero = ir.Constant(ir.VectorType(ir.DoubleType(), LANES), None)
        total = cgutils.alloca_once_value(builder, zero)  # type: ignore[no-untyped-call]
        data = context.make_array(signature.args[5])(context, builder, values[5]).data
        with cgutils.for_range(builder, values[6]) as loop:
            here = builder.add(values[3], builder.mul(loop.index, values[4]))
            row = builder.load(_eight(context, builder, signature.args[2], values[2], here), align=8)
            factor = builder.load(cgutils.gep_inbounds(builder, data, loop.index))  # type: ignore[no-untyped-call]
            builder.store(lanes.line(builder.load(total), row, lanes.spread(factor)), total)
        address = _eight(context, builder, signature.args[0], values[0], values[1])
        builder.store(builder.load(total), address, align=8)
        return context.get_dummy_value()

    uintp = types.uintp
    return types.void(out, uintp, rows, uintp, uintp, factors, uintp), evaluate


sum_rows: Any = intrinsic(_sum_rows)
"""Set eight numbers from ``index`` on to a sum over rows of a matrix times factors; its first begins at ``start``."""
