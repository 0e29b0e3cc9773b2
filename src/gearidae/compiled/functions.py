"""Compiled functions, and callbacks for C."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, update_wrapper
from pathlib import Path
from typing import Any, TypeVar, cast, overload

import numba

from gearidae.compiled.cache import HAS_LOCATOR_HOOK, is_cached, own_cache
from gearidae.compiled.options import numba_options

F = TypeVar("F", bound=Callable[..., Any])


class Function:
    """A compiled function in two forms: one for compiled callers, and one for Python, each compiled when first called.

    Python's form has to take records and arrays out of Python's objects. Almost all functions are called from compiled
    code alone, and a third of the compilation would go into unused wrappers; so that form is not even declared before
    Python calls it. Where numba does not take the options for that, both are the same.
    """

    def __init__(self, function: Callable[..., Any], linked: Any, declare: Callable[[], Any]) -> None:
        update_wrapper(self, function)
        self.py_func = function
        self._declare = declare
        self._linked = linked
        self._numba_type_ = linked._numba_type_  # by which numba knows it for a compiled function

    def __call__(self, *arguments: Any) -> Any:
        """Call it from Python."""
        return self._called(*arguments)

    @cached_property
    def _called(self) -> Any:
        return self._declare()

    @property
    def cache_path(self) -> str:
        """Folder in which its compiled code is kept."""
        return str(self._linked.stats.cache_path)


@overload
def compiled(function: F, *, sources: tuple[Path, ...] = ()) -> F: ...


@overload
def compiled(
    *, makes_arrays: bool = False, inline: bool = False, sources: tuple[Path, ...] = ()
) -> Callable[[F], F]: ...


def compiled(
    function: F | None = None,
    *,
    makes_arrays: bool = False,
    inline: bool = False,
    sources: tuple[Path, ...] = (),
) -> F | Callable[[F], F]:
    """Compile a numerical function on first use; it runs without the GIL and divides as IEEE 754 says.

    Parameters
    ----------
    function : callable
    makes_arrays : bool
        Whether the function makes arrays, of its own or from an address. If not, compiled code keeps no count of
        who refers to the arrays it is given, which otherwise costs a fifth of a run; numba refuses to compile a
        function that is wrong about it.
    inline : bool
        Put the function into whatever calls it: for the few that every step goes through.
    sources : tuple of Path, optional
        As for `cache_folder`.
    """
    # only callbacks are called as C functions
    wanted = {"_nrt": makes_arrays, "forceinline": inline, "no_cfunc_wrapper": True}

    def declare(function: F) -> F:
        options = {name: value for name, value in wanted.items() if name in numba_options()}
        apart = HAS_LOCATOR_HOOK and "no_cpython_wrapper" in numba_options()
        of_linked, form = (options | {"no_cpython_wrapper": True}, "linked") if apart else (options, "called")
        linked = _declare(function, sources, of_linked, form)
        if not hasattr(linked, "_numba_type_"):  # a numba that compiles nothing
            return cast("F", linked)

        def declare_called() -> Any:
            return _declare(function, sources, options, "called") if apart else linked

        return cast("F", Function(function, linked, declare_called))

    return declare if function is None else declare(function)


def _declare(
    function: Callable[..., Any], sources: tuple[Path, ...], options: dict[str, Any], form: str
) -> Any:
    """Declare one form of a function to numba."""
    with own_cache(sources, form):
        return numba.njit(cache=is_cached(), nogil=True, error_model="numpy", **options)(function)


def compiled_callback(signature: Any, *, sources: tuple[Path, ...] = ()) -> Callable[[F], Any]:
    """Compile a C callback of this signature at once, or take it from the cache."""

    def decorate(function: F) -> Any:
        with own_cache(sources, "called"):
            return numba.cfunc(signature, cache=is_cached())(function)

    return decorate
