"""Public names that are loaded on first use (PEP 562), so that importing a package takes next to no time.

And a call as soon as another package has been imported, without importing it.
"""

from __future__ import annotations

import ast
import pkgutil
import sys
from collections.abc import Callable
from importlib import import_module
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import find_spec
from types import ModuleType
from typing import Any


def lazy_names(
    package: str, files_of: str = ""
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Make ``__getattr__``, ``__dir__`` and ``__all__`` of a package from its re-exports.

    Re-exports, ``from module import name as name``, are the only list of its public names, for type checkers too.
    Those under ``if TYPE_CHECKING`` are imported on first use. A module must not have the name of a function that
    its package re-exports, because Python sets a package's attribute when it imports a module.

    Parameters
    ----------
    package : str
        Its ``__name__``.
    files_of : str, optional
        A package within it. Each of its files has a function of its own name that is public too, unless the re-exports
        take another one from that file.
    """
    here = sys.modules[package]
    assert here.__spec__ is not None
    assert isinstance(here.__spec__.loader, SourceFileLoader)
    home = {
        alias.name: str(node.module)
        for node in ast.walk(ast.parse(here.__spec__.loader.get_data(str(here.__file__))))
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
        if alias.name == alias.asname
    }
    for file in pkgutil.iter_modules(import_module(files_of).__path__) if files_of else ():
        if (module := f"{files_of}.{file.name}") not in home.values():
            home.setdefault(file.name, module)

    def load(name: str) -> Any:
        if name not in home:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        module = home[name]
        value = (
            import_module(f"{module}.{name}") if module == package else getattr(import_module(module), name)
        )
        setattr(here, name, value)
        return value

    def names() -> list[str]:
        return sorted({*vars(here), *home})

    return load, names, sorted(home)


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
