"""Where compiled code is kept: a folder named after everything that went into it.

Within that folder a function has its file by its module in the package, not by the path of its file: environments with
the same sources and versions share it.
"""

from __future__ import annotations

import hashlib
import logging
import os
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final, NamedTuple

from platformdirs import user_cache_path

from gearidae.errors import SceneError

try:
    import numba as numba  # before anything else of this package needs it: it reads the user's settings
    from llvmlite import binding
    from numba.core import caching
except ImportError:
    raise
except Exception as error:
    settings = ", ".join(
        f"{name}={os.environ[name]}" for name in sorted(os.environ) if name.startswith("NUMBA_")
    )
    raise SceneError(
        "environment", settings, f"with these settings numba cannot be loaded: {error}"
    ) from error

log = logging.getLogger(__name__)

COMPILED_PACKAGES: Final = (
    "asperities/ranges.py",
    "compiled",
    "contact",
    "engine",
    "formulas",
    "laws",
    "records",
)
PLAIN: Final = "GEARIDAE_PLAIN_NUMBA"
"""Environment variable that makes gearidae do without numba's undocumented options."""

_ROOT: Final = Path(__file__).parents[1]
_CHECKSUM: Final = hashlib.sha256().digest_size
_OF_NO_EFFECT: Final = ("NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS", "NUMBA_DEBUG_CACHE")  # on what is compiled


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

    Numba would keep it beside the sources instead, where a change of a function that it calls is not noticed.
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
    """What is being declared: what besides gearidae's own sources it is made of, and in which form."""

    sources: tuple[Path, ...]
    form: str


_declaring = threading.RLock()
_declared: _Declared | None = None  # nothing of ours


class CacheLocator(getattr(caching, "_CacheLocator", object)):  # type: ignore[misc]
    """Tells numba where the compiled code of one function is kept.

    Of sources that are named the folder's name says all; a file from elsewhere, an extension, is looked at besides.
    """

    def __init__(self, function: Callable[..., Any], file: str, declared: _Declared) -> None:
        self._py_file = file  # numba names it where it says that a function's code cannot be kept
        self._which, self._stamp = f"{function.__code__.co_firstlineno}-{declared.form}", ""
        name = _folder_of(file, declared.sources)
        if not name:
            path = Path(file).resolve()
            name = hashlib.sha256(str(path.parent).encode()).hexdigest()[:16]
            self._stamp = hashlib.sha256(path.read_bytes()).hexdigest()
        self._folder = cache_folder(declared.sources) / name

    def get_cache_path(self) -> str:
        """Folder of the function's module."""
        return str(self._folder)

    def ensure_cache_path(self) -> None:
        """Make the folder; where that fails, so will saving, which is said there."""
        with suppress(OSError):
            self._folder.mkdir(parents=True, exist_ok=True)

    def get_source_stamp(self) -> str:
        """Stamp of the sources, by which kept code is fresh."""
        return self._stamp

    def get_disambiguator(self) -> str:
        """Part of the file name that differs for functions of one name in one module, and for forms of one function."""
        return self._which

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> CacheLocator | None:
        """Return the locator of a function that is declared here, and of no other."""
        if _declared is None or not Path(file).exists():
            return None
        return cls(function, file, _declared)


@cache
def _folder_of(file: str, sources: tuple[Path, ...]) -> str:
    """Name the folder of a module of the named sources; an empty text for a file from elsewhere."""
    path = Path(file).resolve()
    for root in (folder.resolve() for folder in (_ROOT, *sources)):
        if path.is_relative_to(root):
            inside = path.parent.relative_to(root.parent) if path != root else Path(path.parent.name)
            return "_".join(inside.parts)
    return ""


# numba asks the first of these that answers; its own name folders after the sources' absolute paths
HAS_LOCATOR_HOOK: Final = hasattr(caching, "_CacheLocator") and hasattr(
    caching.CompileResultCacheImpl, "_locator_classes"
)
if HAS_LOCATOR_HOOK:
    _impl: Any = caching.CompileResultCacheImpl
    _impl._locator_classes = [CacheLocator, *_impl._locator_classes]


class CacheFile(getattr(caching, "IndexDataCacheFile", object)):  # type: ignore[misc]
    """Files of one function's compiled code. Where they are damaged or the disk is full, the function is compiled.

    Each ends with a checksum, which numba does not read: it would run damaged code.
    """

    def load(self, key: Any) -> Any:
        """Return the code of a signature; None if there is none that can be read."""
        try:
            return super().load(key)
        except (
            Exception
        ) as error:  # of an index or data cut off by a power failure, unpickling may raise anything
            _say_once("compiled code in %s is damaged and is made anew (%s)", type(error).__name__)
            with suppress(OSError):
                Path(self._index_path).unlink()
            return None

    def save(self, key: Any, data: Any) -> None:
        """Keep the code of a signature, if there is room."""
        try:
            super().save(key, data)
        except OSError as error:
            _say_once("compiled code cannot be kept in %s (%s)", error.strerror or str(error))

    def _load_index(self) -> Any:
        if Path(self._index_path).exists():
            _verify(self._index_path)
        return super()._load_index()

    def _load_data(self, name: str) -> Any:
        _verify(self._data_path(name))
        return super()._load_data(name)

    @contextmanager
    def _open_for_write(self, path: str) -> Iterator[Any]:
        with super()._open_for_write(path) as file:
            yield file
            file.flush()
            file.write(hashlib.sha256(Path(file.name).read_bytes()).digest())


def _verify(path: str) -> None:
    """Raise a ValueError if a file is not as it was written."""
    content = Path(path).read_bytes()
    if hashlib.sha256(content[:-_CHECKSUM]).digest() != content[-_CHECKSUM:]:
        raise ValueError("a checksum is wrong")


@cache
def _say_once(message: str, reason: str) -> None:
    log.warning(message, cache_folder().parent, reason)


@contextmanager
def own_cache(sources: tuple[Path, ...], form: str) -> Iterator[None]:
    """Have numba use `CacheLocator` and `CacheFile` while a function is declared in a form, by one thread at a time.

    A numba without the hook keeps the code in the same folder, and environments do not share it.
    """
    global _declared
    config: Any = numba.config
    numbas: Any = caching
    with _declaring:
        before = _declared, config.CACHE_DIR, getattr(caching, "IndexDataCacheFile", None)
        _declared, config.CACHE_DIR = _Declared(sources, form), str(cache_folder(sources))
        numbas.IndexDataCacheFile = CacheFile
        try:
            yield
        finally:
            _declared, config.CACHE_DIR, numbas.IndexDataCacheFile = before
