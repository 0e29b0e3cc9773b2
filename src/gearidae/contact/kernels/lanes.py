"""Eight polynomials at one place, side by side in the processor's wide registers.

Compilers do not see that the eight coefficients of the second variable in a two-dimensional table are eight polynomials
of the first, so the vector instructions are written down here.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

__all__ = ["eight_powers"]

_LANES = 8


def _eight_powers(typing: Any, table: Any, start: Any, u: Any) -> Any:
    """Type and code of `eight_powers`."""

    def evaluate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        real = ir.DoubleType()
        lanes = ir.VectorType(real, _LANES)
        array = context.make_array(signature.args[0])(context, builder, values[0])

        def spread(value: Any) -> Any:
            """Put one number into all lanes."""
            result = ir.Constant(lanes, ir.Undefined)
            for k in range(_LANES):
                result = builder.insert_element(result, value, ir.Constant(ir.IntType(32), k))
            return result

        def coefficients(power: int) -> Any:
            place = builder.add(values[1], ir.Constant(values[1].type, _LANES * power))
            address = cgutils.gep_inbounds(builder, array.data, place)  # type: ignore[no-untyped-call]
            return builder.load(builder.bitcast(address, lanes.as_pointer()), align=8)

        def line(power: int, by: Any) -> Any:
            return builder.fadd(coefficients(power), builder.fmul(coefficients(power + 1), by))

        once = values[2]
        square = builder.fmul(once, once)
        u1, u2, u4 = spread(once), spread(square), spread(builder.fmul(square, square))
        low = builder.fadd(line(0, u1), builder.fmul(line(2, u1), u2))
        high = builder.fadd(line(4, u1), builder.fmul(line(6, u1), u2))
        total = builder.fadd(low, builder.fmul(high, u4))
        parts = [builder.extract_element(total, ir.Constant(ir.IntType(32), k)) for k in range(_LANES)]
        return context.make_tuple(builder, signature.return_type, parts)

    result = types.UniTuple(types.float64, _LANES)  # type: ignore[no-untyped-call]
    return result(table, types.uintp, types.float64), evaluate


eight_powers: Any = intrinsic(_eight_powers)
"""Eight polynomials of degree seven at u: their coefficients of u^0 lie at ``start``, those of u^1 after these, ..."""
