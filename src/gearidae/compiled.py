"""Compile with numba, once per machine, and never run what has gone stale.

Numba's own cache looks at the file of the function it compiles, not at the files of the functions that this one
calls, and not at the SUNDIALS library. So gearidae keeps its compiled code in a folder named after everything
that went into it (`cache_folder`), and within that folder under a function's place in the package, not under the path
of its file: environments with the same sources and versions share it.

A few of numba's options are not documented and could be gone in its next version. They are tried once, and done without
where they are not taken (`numba_options`).
"""

from __future__ import annotations

import hashlib
import json
import logging
import os
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache, update_wrapper
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeVar, cast, overload

import numba
from llvmlite import binding
from numba.core import caching
from platformdirs import user_cache_path

__all__ = [
    "Function",
    "cache_folder",
    "compiled",
    "compiled_callback",
    "is_cached",
    "name_type",
    "numba_options",
]

log = logging.getLogger(__name__)

F = TypeVar("F", bound=Callable[..., Any])

COMPILED_PACKAGES: Final = ("asperities/ranges.py", "contact", "engine", "compiled.py", "records")
PLAIN: Final = "GEARIDAE_PLAIN_NUMBA"
"""Environment variable that makes gearidae do without numba's undocumented options."""

_ROOT: Final = Path(__file__).parent
_OF_NO_EFFECT: Final = ("NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS", "NUMBA_DEBUG_CACHE")  # on what is compiled


# -- where compiled code is kept -------------------------------------------------------------------------------------


@cache
def cache_folder(sources: tuple[Path, ...] = ()) -> Path:
    """Where the compiled code of exactly these sources, library versions, settings and this processor is kept.

    Under ``NUMBA_CACHE_DIR`` if that is set, else in the user's cache folder.

    Parameters
    ----------
    sources : tuple of Path, optional
        Folders or files besides gearidae's own whose functions are compiled, of a package that builds on it.
    """
    digest = hashlib.sha256(sys.version.encode())
    for name in ("numba", "llvmlite", "numpy", "scikit-sundae"):
        digest.update(f"{name} {version(name)}".encode())
    digest.update(f"{binding.get_host_cpu_name()} {binding.get_host_cpu_features().flatten()}".encode())
    for name, value in sorted(os.environ.items()):
        if name.startswith(("NUMBA_", PLAIN)) and name not in _OF_NO_EFFECT:
            digest.update(f"{name}={value}".encode())
    for path in (*(_ROOT / package for package in COMPILED_PACKAGES), *sources):
        for source in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            digest.update(source.relative_to(path.parent).as_posix().encode())
            digest.update(source.read_bytes())
    base = os.environ.get("NUMBA_CACHE_DIR")
    folder = Path(base) / "gearidae" if base else user_cache_path("gearidae")
    return folder / digest.hexdigest()[:16]


@cache
def is_cached() -> bool:
    """Whether compiled code can be kept; if not, each process compiles its own, which is said.

    Numba would keep it beside the sources instead, where nothing tells whether a function that it calls has changed.
    """
    try:
        cache_folder().mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=cache_folder()).close()
    except OSError as error:
        log.warning(
            "compiled code cannot be kept in %s (%s): every process compiles its own; "
            "let NUMBA_CACHE_DIR name a folder that can be written",
            cache_folder().parent,
            error.strerror,
        )
        return False
    if getattr(numba.config, "CACHE_LOCATOR_CLASSES", ""):
        log.warning(
            "NUMBA_CACHE_LOCATOR_CLASSES is set, under which compiled code could go stale: none is kept"
        )
        return False
    return True


class _Declared(NamedTuple):
    """What is being declared: what besides gearidae's own sources it is made of, and whether Python calls it."""

    sources: tuple[Path, ...]
    called: bool


_declaring = threading.RLock()
_declared: _Declared | None = None  # nothing of ours


class _Place(getattr(caching, "_CacheLocator", object)):  # type: ignore[misc]
    """Tells numba where the compiled code of one function is kept.

    Of sources that are named the folder's name says all; a file from elsewhere, an extension, is looked at besides.
    """

    def __init__(self, function: Callable[..., Any], file: str, declared: _Declared) -> None:
        path = Path(file).resolve()
        self._py_file = file  # numba names it where it says that a function's code cannot be kept
        kind = "called" if declared.called else "linked"
        self._which, self._stamp = f"{function.__code__.co_firstlineno}-{kind}", ""
        known = [root.resolve() for root in (_ROOT, *declared.sources)]
        roots = [root for root in known if path.is_relative_to(root)]
        if roots:
            inside = path.parent.relative_to(roots[0].parent) if path != roots[0] else Path(path.parent.name)
            name = "_".join(inside.parts)
        else:
            name = hashlib.sha256(str(path.parent).encode()).hexdigest()[:16]
            self._stamp = hashlib.sha256(path.read_bytes()).hexdigest()
        self._folder = cache_folder(declared.sources) / name

    def get_cache_path(self) -> str:
        """Folder of the function's module."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """What has to be the same for kept code to be fresh."""
        return self._stamp

    def get_disambiguator(self) -> str:
        """What tells functions of one name in one module apart, and the two forms of one function."""
        return self._which

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> _Place | None:
        """Return the place of a function that is declared here, and of no other."""
        if _declared is None or not Path(file).exists():
            return None
        return cls(function, file, _declared)


# numba asks the first of these that answers; its own name folders after the sources' absolute paths
_CAN_BE_ASKED: Final = hasattr(caching, "_CacheLocator") and hasattr(
    caching.CompileResultCacheImpl, "_locator_classes"
)
if _CAN_BE_ASKED:
    _impl: Any = caching.CompileResultCacheImpl
    _impl._locator_classes = [_Place, *_impl._locator_classes]


@contextmanager
def _own_cache(sources: tuple[Path, ...], called: bool = True) -> Iterator[None]:
    """Have numba ask `_Place` while a function is being declared, by one thread at a time.

    A numba that cannot be made to ask keeps the code in the same folder, and shares it with nobody.
    """
    global _declared
    config: Any = numba.config
    with _declaring:
        before = _declared, config.CACHE_DIR
        _declared, config.CACHE_DIR = _Declared(sources, called), str(cache_folder(sources))
        try:
            yield
        finally:
            _declared, config.CACHE_DIR = before


# -- numba's options -------------------------------------------------------------------------------------------------

_UNDOCUMENTED: Final[dict[str, Any]] = {
    "_nrt": False,
    "forceinline": True,
    "no_cfunc_wrapper": True,
    "no_cpython_wrapper": True,
}


@cache
def numba_options() -> frozenset[str]:
    """Which of the undocumented options that gearidae would like this numba takes; tried once, and then known."""
    if os.environ.get(PLAIN):
        return frozenset()
    note = cache_folder() / "numba_options.json"
    with suppress(OSError, ValueError, TypeError):
        return frozenset(json.loads(note.read_text())) & frozenset(_UNDOCUMENTED)
    taken = frozenset(name for name, value in _UNDOCUMENTED.items() if _takes(name, value))
    for name in sorted(frozenset(_UNDOCUMENTED) - taken):
        log.warning(
            "numba %s does not take its option %s: runs or compilation will be slower",
            numba.__version__,
            name,
        )
    if is_cached():
        with suppress(OSError):
            note.write_text(json.dumps(sorted(taken)))
    return taken


def _takes(name: str, value: Any) -> bool:
    """Whether numba takes an option, and compiles a look at part of an array with it."""

    def second(numbers):  # type: ignore[no-untyped-def]
        return numbers[1:][0]

    try:
        options: Any = {name: value}
        numba.njit("float64(float64[::1])", **options)(second)
    except Exception:  # whatever numba says: without the option all is well
        return False
    return True


_named: set[Any] = set()
"""Types that have been given a name, which numba keeps for as long as somebody else does."""


def name_type(value: Any, name: str) -> None:
    """Give numba's type of a value a short name.

    That of a tuple of records lists all fields of all of them, and is part of the symbol of every function that takes
    such a tuple: twelve thousand letters, of which nine tenths of all compiled code would consist.

    Parameters
    ----------
    value : object
        Of the type that is meant.
    name : str
        A digest of numba's own name is added: types that differ are never called the same.
    """
    kind: Any = numba.typeof(value)  # type: ignore[no-untyped-call]
    if kind not in _named:
        _named.add(kind)
        kind.name = f"{name}_{hashlib.sha256(kind.name.encode()).hexdigest()[:12]}"


# -- functions -------------------------------------------------------------------------------------------------------


class Function:
    """A compiled function in two forms: one for compiled callers, and one for Python, each compiled when first called.

    Python's form has to take records and arrays out of Python's objects. Almost all functions are called from compiled
    code alone, and a third of the compilation would go into what nobody uses.
    """

    def __init__(self, function: Callable[..., Any], linked: Any, called: Any) -> None:
        update_wrapper(self, function)
        self.py_func = function
        self._called = called
        self._linked = linked
        self._numba_type_ = linked._numba_type_  # by which numba knows it for a compiled function

    def __call__(self, *arguments: Any) -> Any:
        """Call it from Python."""
        return self._called(*arguments)

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
    # nobody calls these functions as C does but through callbacks
    wanted = {"_nrt": makes_arrays, "forceinline": inline, "no_cfunc_wrapper": True}

    def declare(function: F) -> F:
        options = {name: value for name, value in wanted.items() if name in numba_options()}
        called = _declare(function, sources, options, called=True)
        if not (
            _CAN_BE_ASKED and "no_cpython_wrapper" in numba_options() and hasattr(called, "_numba_type_")
        ):
            return cast("F", called)
        linked = _declare(function, sources, options | {"no_cpython_wrapper": True}, called=False)
        return cast("F", Function(function, linked, called))

    return declare if function is None else declare(function)


def _declare(
    function: Callable[..., Any], sources: tuple[Path, ...], options: dict[str, Any], *, called: bool
) -> Any:
    """Declare one form of a function to numba."""
    with _own_cache(sources, called):
        return numba.njit(cache=is_cached(), nogil=True, error_model="numpy", **options)(function)


def compiled_callback(signature: Any, *, sources: tuple[Path, ...] = ()) -> Callable[[F], Any]:
    """Compile a C callback of this signature at once, or take it from the cache."""

    def decorate(function: F) -> Any:
        with _own_cache(sources):
            return numba.cfunc(signature, cache=is_cached())(function)

    return decorate
