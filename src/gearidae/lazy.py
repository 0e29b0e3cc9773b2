"""Public names that are loaded on first use (PEP 562), so that importing a package costs next to nothing.

Likewise what is to be done once another package has been imported, without importing it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType
from typing import Any

__all__ = ["lazy_names", "when_imported"]


class _Door(ModuleType):
    """A package in which a function may be called like the module that it lives in: the function is what is public."""

    def __setattr__(self, name: str, value: object) -> None:
        if isinstance(value, ModuleType) and name in self.__dict__.get("__functions__", ()):
            return  # Python puts every module that is imported into its package, whoever asked for it
        super().__setattr__(name, value)

    def __reduce__(self) -> tuple[Callable[[str], ModuleType], tuple[str]]:
        """Let functions that use the package be sent to other processes, as Dask does; modules are sent by name."""
        return import_module, (self.__name__,)


def lazy_names(
    namespace: dict[str, Any], home: Mapping[str, str | None]
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Make a package's ``__getattr__`` and ``__dir__``.

    Parameters
    ----------
    namespace : dict
        The package's ``globals()``, in which a name is kept once it has been loaded.
    home : mapping of str to str or None
        The module within the package where each public name lives, or its full name if it lives in another room; None
        for a name that is such a module itself.
    """
    package = namespace["__name__"]
    namespace["__functions__"] = frozenset(name for name, place in home.items() if name == place)
    sys.modules[package].__class__ = _Door

    def load(name: str) -> Any:
        if name not in home:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        place = home[name]
        inside = name if place is None else place
        module = import_module(inside if inside.startswith("gearidae.") else f"{package}.{inside}")
        namespace[name] = module if place is None else getattr(module, name)
        return namespace[name]

    def names() -> list[str]:
        return sorted({*namespace, *home})

    return load, names


def when_imported(name: str, call: Callable[[], None]) -> None:
    """Call a function as soon as a package has been imported; now if it has been.

    Parameters
    ----------
    name : str
        Of the package.
    call : callable
        May import the package.
    """
    if name in sys.modules:
        call()
    else:
        sys.meta_path.insert(0, _Waiting(name, call))


class _Waiting(MetaPathFinder):
    """Finds nothing by itself; lets the import of one package be followed by a call, and steps aside."""

    def __init__(self, name: str, call: Callable[[], None]) -> None:
        self._name, self._call = name, call

    def find_spec(self, fullname: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        """Return what the other finders find, with a loader that calls afterwards."""
        if fullname != self._name:
            return None
        sys.meta_path.remove(self)
        spec = find_spec(fullname)
        if spec is None or spec.loader is None:
            return spec
        execute, call = spec.loader.exec_module, self._call

        def exec_module(module: ModuleType) -> None:
            execute(module)
            call()

        # the loader itself stays what it is: it also finds the files that belong to the package
        spec.loader.exec_module = exec_module  # type: ignore[method-assign]
        return spec
