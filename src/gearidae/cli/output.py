"""Where the program's words go: results to standard output, complaints to standard error."""

from __future__ import annotations

import sys

from rich.console import Console, RenderableType

__all__ = ["complain", "say", "show"]

_WIDTH_OF_FILES = 120
"""Columns to lay tables out for when the output is not a terminal."""


def say(text: str) -> None:
    """Print a line of results as it is, without wrapping."""
    sys.stdout.write(f"{text}\n")


def show(table: RenderableType) -> None:
    """Print a table."""
    Console(width=None if sys.stdout.isatty() else _WIDTH_OF_FILES, highlight=False).print(table)


def complain(message: str) -> None:
    """Print one line to standard error, under the program's name."""
    sys.stderr.write(f"gearidae: {' '.join(message.split())}\n")
