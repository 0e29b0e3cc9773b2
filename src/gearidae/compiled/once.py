"""Functions that are compiled once, on their own, and called at the address where this process has them.

Numba compiles what a function calls into it: the contact law into the force of a pair, both into the sum of all
forces, all three into the equations of motion, and so on up to the loop over steps. For what every step goes through
that is as it should be. What is called rarely would be compiled as often for nothing, and makes the code of the others
longer and slower.

A caller reads the address from a slot, which it knows by name: an external symbol of its code, so that this can be
kept on disk. The slot is empty until the function has been made ready in this process, and no file can
set it. A call costs 6 ns and more, where one between functions compiled into each other costs less than one.
"""

from __future__ import annotations

import ctypes
import inspect
from collections.abc import Callable
from functools import cached_property, update_wrapper
from typing import Any, Final, TypeVar, cast

from gearidae.compiled.functions import Function, compiled
from gearidae.compiled.ready import make_ready, wait

F = TypeVar("F", bound=Callable[..., Any])

_slots: Final[list[ctypes.c_int64]] = []
"""All there have ever been: compiled code may look at them for as long as the process lives."""
_unnamed: Final[list[tuple[str, int]]] = []
"""Symbols of functions, and addresses of their slots, that have come since `name_slots` was last called."""


def name_slots() -> None:
    """Make all slots known by their symbols, before code is loaded in which they stand."""
    from llvmlite import binding

    while _unnamed:
        binding.add_symbol(*_unnamed.pop())


class AddressedFunction:
    """A function that is compiled once; Python calls a form of its own, see `Function`."""

    def __init__(self, form: Function, part: str, makes_arrays: bool) -> None:
        update_wrapper(self, form.py_func)
        self.py_func = form.py_func
        self._form, self._part, self._makes_arrays = form, part, makes_arrays
        self._slot = ctypes.c_int64(0)
        self._symbol = f"{self.py_func.__module__}.{self.py_func.__qualname__}.slot"
        self._code: Any = None
        _slots.append(self._slot)
        _unnamed.append((self._symbol, ctypes.addressof(self._slot)))
        wait(part, self)

    def __call__(self, *arguments: Any) -> Any:
        """Call it from Python."""
        from gearidae.compiled.options import compiles

        if compiles():
            make_ready(self._part)
        return self._form(*arguments)

    def __reduce__(self) -> tuple[Any, ...]:
        """Say where it stands, as `Function` does."""
        return self._form.__reduce__()

    def make_ready(self) -> None:
        """Compile it, or take it from the cache, and fill its slot."""
        from gearidae.compiled.cache import is_cached, numba, own_cache
        from gearidae.compiled.options import numba_options

        name_slots()
        options: Any = {"_nrt": self._makes_arrays} if "_nrt" in numba_options() else {}
        with own_cache((), "once"):
            declare = numba.cfunc(self._signature, cache=is_cached(), error_model="numpy", **options)
            self._code = declare(self.py_func)
        self._slot.value = self._code.address

    @cached_property
    def _signature(self) -> Any:
        from gearidae.compiled.kinds import signature_of

        return signature_of(self.py_func)

    @cached_property
    def _numba_type_(self) -> Any:
        """By which numba knows it in a compiled function, and how it writes a call."""
        from numba import types
        from numba.core.typing.templates import CallableTemplate
        from numba.extending import lower_builtin

        any_number: Any = types.VarArg(types.Any)  # type: ignore[no-untyped-call]
        write: Any = lower_builtin(self, any_number)  # type: ignore[no-untyped-call]
        write(self._call)
        members = {"key": self, "generic": lambda template: self._typing}
        template = type(f"{self.py_func.__name__}_template", (CallableTemplate,), members)
        return types.Function(template)

    @property
    def _typing(self) -> Callable[..., Any]:
        """Tells numba what a call takes and returns: numbers that are written out have no types of their own here."""

        def typed(*_arguments: Any) -> Any:
            return self._signature

        typed.__signature__ = inspect.signature(self.py_func)  # type: ignore[attr-defined]
        return typed

    def _call(self, context: Any, builder: Any, signature: Any, values: Any) -> Any:
        """Write a call into a caller's code."""
        from llvmlite import ir

        slot = builder.module.globals.get(self._symbol)
        if slot is None:
            slot = ir.GlobalVariable(builder.module, ir.IntType(64), self._symbol)
            slot.linkage = "external"
        address = builder.load(slot)
        empty = builder.icmp_unsigned("==", address, ir.Constant(ir.IntType(64), 0))
        with builder.if_then(empty, likely=False):
            message = f"{self.py_func.__module__}.{self.py_func.__qualname__} has not been made ready"
            context.call_conv.return_user_exc(builder, RuntimeError, (message,))
        kinds = [context.get_value_type(argument) for argument in signature.args]
        kind = ir.FunctionType(context.get_value_type(signature.return_type), kinds)
        return builder.call(builder.inttoptr(address, kind.as_pointer()), values)


def compiled_once(part: str, *, makes_arrays: bool = False) -> Callable[[F], F]:
    """Compile a numerical function on its own, and not into its callers; for what is called rarely or takes long.

    Its annotations are its signature, see `gearidae.compiled.kinds.signature_of`; callers give all arguments.

    Parameters
    ----------
    part : str
        Of the program, by any name. The function is compiled by `make_ready` with the same name, before the first call
        from compiled code.
    makes_arrays : bool
        As for `compiled`.
    """

    def declare(function: F) -> F:
        form: Any = compiled(makes_arrays=makes_arrays)(function)
        return cast("F", AddressedFunction(form, part, makes_arrays))

    return declare
