"""Public names that are loaded on first use (PEP 562), so that importing a package costs next to nothing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

__all__ = ["lazy_names"]


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
