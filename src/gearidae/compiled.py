"""Compile with numba, once per machine, and never run what has gone stale.

Numba's own cache looks at the file of the function it compiles, not at the files of the functions that this one
calls, and not at the SUNDIALS library. So gearidae keeps its compiled code in a folder named after everything
that went into it: its own sources and the versions of Python, numba, llvmlite and scikit-sundae.
"""

from __future__ import annotations

import hashlib
import logging
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar, cast, overload

import numba
from platformdirs import user_cache_path

__all__ = ["cache_folder", "compiled", "compiled_callback", "say_compiling"]

log = logging.getLogger(__name__)

F = TypeVar("F", bound=Callable[..., Any])

COMPILED_PACKAGES = ("contact", "engine", "compiled.py", "records.py")
PLAIN_FOLDERS = {"asperities"}  # whose laws enter compiled code as numbers in tables alone


@cache
def cache_folder(sources: tuple[Path, ...] = ()) -> Path:
    """Where the compiled code of exactly these sources and library versions is kept.

    Under ``NUMBA_CACHE_DIR`` if that is set, else in the user's cache folder.

    Parameters
    ----------
    sources : tuple of Path, optional
        Folders or files besides gearidae's own whose functions are compiled, of a package that builds on it.
    """
    root = Path(__file__).parent
    digest = hashlib.sha256(sys.version.encode())
    for name in ("numba", "llvmlite", "numpy", "scikit-sundae"):
        digest.update(f"{name} {version(name)}".encode())
    for path in (*(root / package for package in COMPILED_PACKAGES), *sources):
        for source in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            if PLAIN_FOLDERS.isdisjoint(source.parts[len(root.parts) :]):
                digest.update(source.read_bytes())
    base = os.environ.get("NUMBA_CACHE_DIR")
    folder = Path(base) / "gearidae" if base else user_cache_path("gearidae")
    return folder / digest.hexdigest()[:16]


_declaring = threading.RLock()
_said: set[str] = set()


def say_compiling(module: str, what: str, how_long: str) -> None:
    """Say that what comes takes a while, and why, if nothing of a module has been compiled on this machine yet."""
    with _declaring:
        if module in _said or any(cache_folder().rglob(f"{module}.*.nbi")):
            return
        _said.add(module)
    log.warning("compiling %s for this machine: once, %s", what, how_long)


@contextmanager
def _own_cache(sources: tuple[Path, ...]) -> Iterator[None]:
    """Let numba choose gearidae's cache folder while a function is being declared, by one thread at a time."""
    config: Any = numba.config
    with _declaring:
        before = config.CACHE_DIR
        config.CACHE_DIR = str(cache_folder(sources))
        try:
            yield
        finally:
            config.CACHE_DIR = before


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
        # numba's stubs do not know them all; nobody calls these functions as C does but through callbacks
        options: Any = {"_nrt": makes_arrays, "forceinline": inline, "no_cfunc_wrapper": True}
        with _own_cache(sources):
            dispatcher: Any = numba.njit(cache=True, nogil=True, error_model="numpy", **options)(function)
        return cast("F", dispatcher)

    return declare if function is None else declare(function)


def compiled_callback(signature: Any, *, sources: tuple[Path, ...] = ()) -> Callable[[F], Any]:
    """Compile a C callback of this signature at once, or take it from the cache."""

    def decorate(function: F) -> Any:
        with _own_cache(sources):
            return numba.cfunc(signature, cache=True)(function)

    return decorate
