"""Calls of compiled functions at addresses that a process has only once it runs."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

from gearidae.compiled.functions import named


class WrittenCall:
    """A function for compiled callers whose code is written, and not compiled from Python; known to numba on first use.

    Parameters
    ----------
    name : str
        Of the function in this module.
    typed : callable
        As for ``numba.extending.intrinsic``.
    """

    def __init__(self, name: str, typed: Callable[..., Any]) -> None:
        self._name, self._typed = name, typed

    def __reduce__(self) -> tuple[Any, ...]:
        """Say where it stands, as `gearidae.compiled.Function` does."""
        return named, (__name__, self._name, ())

    @cached_property
    def _numba_type_(self) -> Any:
        from numba import types
        from numba.core.typing.templates import make_intrinsic_template

        make: Any = make_intrinsic_template
        template = make(self, self._typed, self._typed.__name__, prefer_literal=False, kwargs={})
        return types.Function(template)


def _typed(  # the arguments of the law, where its parameters are, and which number of it is asked for
    typing: Any, address: Any, t: Any, angle: Any, speed: Any, numbers: Any, at: Any, count: Any, which: Any
) -> Any:
    """Type of a call of the law at an address, and the code that makes it."""
    from llvmlite import ir
    from numba import types
    from numba.core.errors import TypingError

    if numbers.layout != "C":
        raise TypingError(f"the array must be contiguous, and {numbers} may not be")

    def call(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        address, t, angle, speed, numbers, at, count, which = values
        array = context.make_array(signature.args[4])(context, builder, numbers)
        handed = [t, angle, speed, builder.gep(array.data, [at]), count, which]
        kind = ir.FunctionType(ir.DoubleType(), [value.type for value in handed])
        return builder.call(builder.inttoptr(address, kind.as_pointer()), handed)

    real, whole = types.float64, types.int64
    return real(whole, real, real, real, numbers, whole, whole, whole), call


call_at: Any = WrittenCall("call_at", _typed)
