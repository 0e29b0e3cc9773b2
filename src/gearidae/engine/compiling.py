"""Say that something is being compiled, while it is: the first run on a machine takes a while."""

from __future__ import annotations

import logging
import math
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from time import monotonic
from typing import Any, Final

from numba.core import event

from gearidae.compiled import is_ready, make_ready
from gearidae.compiled.ready import ELASTIC as ELASTIC
from gearidae.compiled.ready import EXPOSURES as EXPOSURES
from gearidae.compiled.ready import FRICTION as FRICTION
from gearidae.compiled.ready import IMPACTS as IMPACTS
from gearidae.compiled.ready import POPULATION as POPULATION
from gearidae.compiled.ready import SOLVER as SOLVER
from gearidae.compiled.ready import TRAIN as TRAIN

log = logging.getLogger(__name__)

HOW_LONG: Final = {
    SOLVER: "about a minute",
    ELASTIC: "some ten seconds",
    EXPOSURES: "some ten seconds",
    POPULATION: "some ten seconds",
    FRICTION: "some ten seconds",
    IMPACTS: "some seconds",
    TRAIN: "some twenty seconds",
}
"""How long that takes."""
FUNCTIONS: Final = {
    SOLVER: 370,
    ELASTIC: 79,
    POPULATION: 32,
}
"""How many functions that are, counted with an empty cache; the other parts are too short to ask. The number of the
solver is that of a process with another one beside it; alone, a process compiles nearly twice as many."""
_QUARTERS: Final = (0.25, 0.5, 0.75)
"""Shares of the functions after which a line says how far it is, where no line can be rewritten."""

_one_at_a_time = threading.RLock()
_depth = 0


@contextmanager
def compiling(what: str, how_long: str, functions: int = 0) -> Iterator[None]:
    """Say that something is compiled, if it is and when it is: code that is read from disk needs no words.

    On a terminal a line counts the functions; without one a line before and one after say it, and three between them
    how far it is.

    Parameters
    ----------
    what : str
        What is compiled here, for instance "the solver".
    how_long : str
        How long that takes at most, in words.
    functions : int, optional
        How many functions that are, about; 0 if nobody knows.
    """
    global _depth
    with _one_at_a_time, ExitStack() as stack:
        _depth += 1
        stack.callback(_leave)
        if _depth > 1:  # the outer one says it
            yield
            return
        listener = CompileListener(what, how_long, functions)
        stack.callback(listener.end)
        stack.enter_context(event.install_listener("numba:compile", listener))
        yield


def make_part_ready(part: str) -> None:
    """Compile a part of the engine, or take it from the cache, before the first scene that needs it is run."""
    if not is_ready(part):
        with compiling(part, HOW_LONG[part], FUNCTIONS.get(part, 0)):
            make_ready(part)


def _leave() -> None:
    global _depth
    _depth -= 1


class CompileListener(event.Listener):
    """Counts and shows the functions that numba compiles because it has not found them on disk."""

    def __init__(self, what: str, how_long: str, functions: int) -> None:
        self._what, self._how_long, self._functions = what, how_long, functions
        self._quarters = [math.ceil(share * functions) for share in _QUARTERS] if functions else []
        self._began: float | None = None
        self._count, self._line = 0, ExitStack()
        self._status: Any = None

    def on_start(self, begun: Any) -> None:
        """Take note of a function that is begun."""
        if self._began is None:
            self._began = monotonic()
            self._begin()

    def on_end(self, done: Any) -> None:
        """Take note of a function that is done."""
        self._count += 1
        of = f" of about {self._functions}" if self._count < self._functions else ""
        if self._status is not None:
            self._status.update(f"{self._sentence()}: {self._count}{of} functions")
        elif self._count in self._quarters and self._began is not None:
            seconds = monotonic() - self._began
            log.warning("%s: %d%s functions after %.0f s", self._what, self._count, of, seconds)

    def end(self) -> None:
        """Say that it is over."""
        self._line.close()
        if self._began is not None:
            seconds = monotonic() - self._began
            log.warning("%s: %d functions compiled in %.0f s", self._what, self._count, seconds)

    def _sentence(self) -> str:
        return f"compiling {self._what} for this machine: once, {self._how_long}"

    def _begin(self) -> None:
        if log.isEnabledFor(logging.WARNING) and sys.stderr.isatty():
            from rich.console import Console
            from rich.errors import LiveError

            try:
                status = Console(stderr=True).status(self._sentence())
                self._status = self._line.enter_context(status)
            except LiveError:  # something else is being shown already
                self._status = None
        if self._status is None:
            log.warning("%s", self._sentence())
