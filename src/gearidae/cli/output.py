"""Output of the program: results to standard output, errors to standard error."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from rich.console import Console, RenderableType

__all__ = ["complain", "hushed", "is_quiet", "say", "show"]

_WIDTH_OF_FILES = 120
"""Columns to lay tables out for when the output is not a terminal."""

_quiet: ContextVar[bool] = ContextVar("quiet", default=False)


@contextmanager
def hushed(wanted: bool) -> Iterator[None]:
    """Print no results and no progress inside the block, if wanted."""
    token = _quiet.set(wanted)
    try:
        yield
    finally:
        _quiet.reset(token)


def is_quiet() -> bool:
    """Whether neither results nor progress are to be shown."""
    return _quiet.get()


def say(text: str) -> None:
    """Print a line of results as it is, without wrapping."""
    if is_quiet():
        return
    sys.stdout.write(f"{text}\n")


def show(table: RenderableType) -> None:
    """Print a table."""
    if is_quiet():
        return
    Console(width=None if sys.stdout.isatty() else _WIDTH_OF_FILES, highlight=False).print(table)


def complain(message: str) -> None:
    """Print one line to standard error, under the program's name."""
    sys.stderr.write(f"gearidae: {' '.join(message.split())}\n")
