"""Laws by their names: what a scene or a study may call, one file a law in a folder of its own.

Asperity laws, torque laws and loss laws each have such a registry. Every file of the folder that registers a law is
found by itself; a law from elsewhere is registered in each process that uses it.
"""

from __future__ import annotations

import pkgutil
from importlib import import_module
from typing import Generic, TypeVar

from gearidae.errors import SceneError

Law = TypeVar("Law")


class Registry(Generic[Law]):
    """The laws of one kind.

    Parameters
    ----------
    package : str
        Dotted name of the folder whose files register the laws.
    key : str
        What errors name: the key that calls these laws.
    kind : str
        What such a law is called in errors, such as ``asperity law``.
    """

    def __init__(self, package: str, key: str, kind: str) -> None:
        self._package, self._key, self._kind = package, key, kind
        self._laws: dict[str, Law] = {}
        self._searched = False

    def add(self, name: str, law: Law) -> None:
        """Make a law known by its name.

        Raises
        ------
        SceneError
            If another law has this name already.
        """
        if name in self._laws:
            raise SceneError(self._key, name, f"is the name of another {self._kind} already")
        self._laws[name] = law

    def remove(self, name: str) -> None:
        """Take a law out again.

        Raises
        ------
        SceneError
            If there is no such law.
        """
        self.find(name)
        del self._laws[name]

    def names(self) -> tuple[str, ...]:
        """Return the names of all laws, in the order of the alphabet."""
        self._search()
        return tuple(sorted(self._laws))

    def find(self, name: str) -> Law:
        """Look a law up.

        Raises
        ------
        SceneError
            If there is no such law.
        """
        self._search()
        law = self._laws.get(name) if isinstance(name, str) else None
        if law is None:
            raise SceneError(self._key, name, "must be one of " + ", ".join(self.names()))
        return law

    def _search(self) -> None:
        """Import the files of the folder, which register what they hold."""
        if self._searched:
            return
        self._searched = True
        for module in pkgutil.iter_modules(import_module(self._package).__path__):
            import_module(f"{self._package}.{module.name}")
