"""Functions that are compiled once wait here until a part of the program that calls them is about to run."""

from __future__ import annotations

import threading
from typing import Final, Protocol

SOLVER: Final = "the solver"
ELASTIC: Final = "elastic contacts"
EXPOSURES: Final = "exposures"
POPULATION: Final = "populations of asperities"
FRICTION: Final = "friction"
IMPACTS: Final = "impacts"
TRAIN: Final = "trains"
"""Parts of the program, each compiled with the first scene that needs it."""


class Waiting(Protocol):
    """A function that has been declared and not yet compiled."""

    def make_ready(self) -> None:
        """Compile it, or take it from the cache, and say to its callers where it lies."""


_waiting: Final[dict[str, list[Waiting]]] = {}
_one_at_a_time = threading.RLock()


def wait(part: str, function: Waiting) -> None:
    """Have a function wait until its part is made ready."""
    _waiting.setdefault(part, []).append(function)


def is_ready(part: str) -> bool:
    """Whether nothing waits for a part of the program."""
    return not _waiting.get(part)


def make_ready(part: str) -> None:
    """Compile what waits for a part of the program, or take it from the cache; nothing if it has been done.

    Parameters
    ----------
    part : str
        As said where the functions were declared.
    """
    waiting = _waiting.get(part)
    if waiting:
        with _one_at_a_time:
            while waiting:
                function = waiting[-1]
                function.make_ready()
                waiting.remove(function)  # others may have come meanwhile
