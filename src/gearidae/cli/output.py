"""Output of the program: results to standard output, errors to standard error."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar

from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.segment import Segment
from rich.table import Table
from rich.text import Text

from gearidae.cli.streams import stop_output
from gearidae.printable import printable

_WIDTH_OF_FILES = 120
"""Columns to lay tables out for when the output is not a terminal."""

_quiet: ContextVar[bool] = ContextVar("quiet", default=False)


class Terminal(Console):
    """A console whose reader may close it (a pager, ``head``): what it does not want is dropped."""

    def on_broken_pipe(self) -> None:
        """End the output, and not the program."""
        stop_output()


class _Plain:
    """Something to print, without the escape sequences in texts of files."""

    def __init__(self, content: RenderableType) -> None:
        self._content = content

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        for segment in console.render(self._content, options):
            yield segment if segment.control else Segment(printable(segment.text), segment.style)


@contextmanager
def quieted(wanted: bool) -> Iterator[None]:
    """Print no results and no progress inside the block, if wanted."""
    token = _quiet.set(wanted)
    try:
        yield
    finally:
        _quiet.reset(token)


def is_quiet() -> bool:
    """Whether neither results nor progress are to be shown."""
    return _quiet.get()


def print_line(text: str) -> None:
    """Print a line of results, without wrapping."""
    if not is_quiet():
        _write(f"{printable(text)}\n")


def print_answer(text: str) -> None:
    """Print the whole answer of a command, also where no other results are to be shown."""
    _write(f"{printable(text)}\n")


def show(table: RenderableType) -> None:
    """Print a table."""
    if is_quiet():
        return
    console = Terminal(
        width=None if sys.stdout.isatty() else _WIDTH_OF_FILES, highlight=False, markup=False, emoji=False
    )
    with console.capture() as drawn:
        console.print(_Plain(table))
    _write(drawn.get())


def show_rows(rows: Iterable[tuple[str, str, str]]) -> None:
    """Print names, values and remarks in three columns.

    Parameters
    ----------
    rows : iterable of (str, str, str)
        A row without a value is a heading.
    """
    table = Table(box=None, show_header=False, pad_edge=False, padding=(0, 2, 0, 0))
    for name, value, remark in rows:
        table.add_row(Text(f"  {name}") if value else Text(name, style="bold"), Text(value), Text(remark))
    show(table)


def print_error(message: str) -> None:
    """Print one line to standard error, under the program's name."""
    with suppress(OSError):  # standard error is closed too
        sys.stderr.write(f"gearidae: {printable(' '.join(message.split()))}\n")


def _write(text: str) -> None:
    """Print to standard output; a reader that has closed it wants no more."""
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        stop_output()
    except OSError:  # a full disk
        stop_output()
        raise
