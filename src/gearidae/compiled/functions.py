"""Compiled functions, and callbacks for C."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, reduce, update_wrapper
from importlib import import_module
from pathlib import Path
from typing import Any, Final, TypeVar, cast, overload

F = TypeVar("F", bound=Callable[..., Any])

LINKED: Final = "linked"
CALLED: Final = "called"
"""Forms of a compiled function: for compiled callers, and for Python."""


class Function:
    """A compiled function in two forms: one for compiled callers, and one for Python, each declared on first use.

    Python's form has to take records and arrays out of Python's objects. Almost all functions are called from compiled
    code alone, and a third of the compilation would go into unused wrappers. Where numba does not take the options for
    that, both are the same.
    """

    def __init__(self, function: Callable[..., Any], declare: Callable[[str], Any]) -> None:
        update_wrapper(self, function)
        self.py_func = function
        self._declare = declare

    def __call__(self, *arguments: Any) -> Any:
        """Call it from Python."""
        return self._called(*arguments)

    def prepare(self, *arguments: Any) -> None:
        """Compile the form for Python, or take it from the cache, without calling it; for arguments like these."""
        from gearidae.compiled.cache import numba

        self._called.compile(tuple(map(numba.typeof, arguments)))

    def __reduce__(self) -> tuple[Any, ...]:
        """Say where it stands and what it closes over: by this numba knows the code of a closure on disk again.

        By itself numba would pickle a number that each process draws anew, and compile the closure in all of them.
        """
        cells = tuple(cell.cell_contents for cell in self.py_func.__closure__ or ())
        return named, (self.__module__, self.py_func.__qualname__, cells)

    @cached_property
    def _linked(self) -> Any:
        return self._declare(LINKED)

    @cached_property
    def _called(self) -> Any:
        return self._declare(CALLED)

    @property
    def _numba_type_(self) -> Any:
        """By which numba knows it for a compiled function."""
        return self._linked._numba_type_

    @property
    def cache_path(self) -> str:
        """Folder in which its compiled code is kept."""
        return str(self._linked.stats.cache_path)


def named(module: str, name: str, cells: tuple[Any, ...]) -> Any:
    """Find a function by where it stands; one that closes over others is made by its own module only."""
    if cells:
        raise TypeError(f"{module}.{name} closes over {len(cells)} values and cannot be found by its name")
    return reduce(getattr, name.split("."), import_module(module))


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

    def declare(function: F) -> F:
        made: dict[bool, Any] = {}

        def form(which: str) -> Any:
            from gearidae.compiled.cache import HAS_LOCATOR_HOOK
            from gearidae.compiled.options import numba_options

            taken = numba_options()
            # only callbacks are called as C functions
            wanted = {"_nrt": makes_arrays, "forceinline": inline, "no_cfunc_wrapper": True}
            options = {name: value for name, value in wanted.items() if name in taken}
            apart = HAS_LOCATOR_HOOK and "no_cpython_wrapper" in taken
            linked = apart and which == LINKED
            if linked not in made:
                more = {"no_cpython_wrapper": True} if linked else {}
                made[linked] = _declare(function, sources, options | more, LINKED if linked else CALLED)
            return made[linked]

        return cast("F", Function(function, form))

    return declare if function is None else declare(function)


def _declare(
    function: Callable[..., Any], sources: tuple[Path, ...], options: dict[str, Any], form: str
) -> Any:
    """Declare one form of a function to numba."""
    from gearidae.compiled.cache import is_cached, numba, own_cache
    from gearidae.compiled.once import name_slots

    name_slots()
    with own_cache(sources, form):
        return numba.njit(cache=is_cached(), nogil=True, error_model="numpy", **options)(function)


def compiled_callback(signature: Any, *, sources: tuple[Path, ...] = ()) -> Callable[[F], Any]:
    """Compile a C callback of this signature at once, or take it from the cache."""
    from gearidae.compiled.cache import is_cached, numba, own_cache
    from gearidae.compiled.once import name_slots

    def decorate(function: F) -> Any:
        name_slots()
        with own_cache(sources, CALLED):
            return numba.cfunc(signature, cache=is_cached())(function)

    return decorate
