"""Options of every command: verbosity and log file."""

from __future__ import annotations

import logging
import platform
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Annotated

from cyclopts import CycloptsError, Parameter

import gearidae
from gearidae.archive.target import is_input, keeps_inputs
from gearidae.cli.app import app
from gearidae.cli.examples import EXAMPLES, epilogue
from gearidae.cli.output import print_error, quieted
from gearidae.errors import GearidaeError, SceneError
from gearidae.printable import printable
from gearidae.studies.declared import command_help

__all__ = ["app", "session"]

_WRITERS = {"explore", "init", "plot", "report", "run", "sweep", *command_help()}
"""Commands that write a file. The output of the other commands is their result and is not suppressed."""

_WRITTEN = ("-o", "--output", "--picture", "--asperities", "init")
"""What stands before a file to write: options, and the command that takes the file's name."""

log = logging.getLogger("gearidae")

app.meta.suppress_keyboard_interrupt = False  # as in the app itself: `main` says what is kept
app.register_install_completion_command()
for _name, _lines in EXAMPLES.items():
    app[_name].help_epilogue = epilogue(_lines)
for _name, _words in command_help().items():
    app.command(f"gearidae.cli.study_commands:{_name.replace('-', '_')}", name=_name, help=_words)


@app.meta.default
def session(
    *tokens: Annotated[str, Parameter(show=False, allow_leading_hyphen=True)],
    quiet: Annotated[
        bool, Parameter(name=["--quiet", "-q"], help="Print errors only, no summary and no progress.")
    ] = False,
    verbose: Annotated[
        bool, Parameter(name=["--verbose", "-v"], help="Log each step to standard error.")
    ] = False,
    log_file: Annotated[
        Path | None, Parameter(name="--log", help="Append the full log, with times, to this file.")
    ] = None,
) -> object:
    """Run one command under these options.

    Parameters
    ----------
    *tokens : str
        The command and its own arguments.
    quiet, verbose : bool
        Verbosity.
    log_file : Path, optional
        File to append the log to.

    Returns
    -------
    object
        What the command returns: its exit code, or nothing.

    Raises
    ------
    SceneError
        If both `quiet` and `verbose` are given, or the log cannot be written.
    """
    if quiet and verbose:
        raise SceneError("--quiet", "--verbose", "choose one of the two")
    level = logging.ERROR if quiet else logging.INFO if verbose else logging.WARNING
    with (
        keeps_inputs(_read(tokens)),
        _logging(level, log_file),
        quieted(quiet and bool(tokens) and tokens[0] in _WRITERS),
    ):
        return _run(tokens)


def _read(tokens: tuple[str, ...]) -> Iterator[str]:
    """Yield what may be files that a command reads: all that does not follow one of `_WRITTEN`."""
    for before, token in pairwise(("", *tokens)):
        option, _, value = token.partition("=")
        if before not in _WRITTEN and option not in _WRITTEN:
            yield value if option.startswith("--") else token


def _run(tokens: tuple[str, ...]) -> object:
    log.info(
        "gearidae %s, Python %s, %s: %s",
        gearidae.__version__, platform.python_version(), platform.platform(), " ".join(tokens),
    )  # fmt: skip
    began = time.perf_counter()
    try:
        code: object = app(tokens, exit_on_error=False, print_error=False, result_action="return_value")
    except (CycloptsError, GearidaeError, KeyboardInterrupt) as error:
        log.debug("%s: %s", type(error).__name__, error)  # for the file; on the terminal it is said anyway
        raise
    log.info("done in %.2f s, exit code %s", time.perf_counter() - began, code if code is not None else 0)
    return code


class _Plain(logging.Formatter):
    """Writes records without the escape sequences in texts of files."""

    def format(self, record: logging.LogRecord) -> str:
        """Write a record as text."""
        return printable(super().format(record))


class _LogFile(logging.FileHandler):
    """A log file whose disk may be full: that is said once, and the command goes on."""

    _lost = False

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802
        """Say that the log ends here."""
        if not self._lost:
            self._lost = True
            print_error(f"the log {self.baseFilename} cannot be written: {sys.exc_info()[1]}")

    def close(self) -> None:
        """Close the file; what is left to be written may not fit either."""
        try:
            super().close()
        except OSError:
            self.handleError(logging.makeLogRecord({}))


@contextmanager
def _logging(level: int, path: Path | None) -> Iterator[None]:
    """Send the package's log to standard error and, in full, to a file, for as long as a command runs."""
    terminal = logging.StreamHandler()
    terminal.setLevel(level)
    terminal.setFormatter(_Plain("%(message)s"))
    handlers: list[logging.Handler] = [terminal]
    if path is not None:
        if is_input(path):
            raise SceneError("--log", path, "is an input of this command: name another")
        try:
            file = _LogFile(path, encoding="utf-8")
        except OSError as error:
            raise SceneError("--log", path, f"cannot be written ({error.strerror})") from error
        file.setFormatter(_Plain("%(asctime)s %(levelname)s %(name)s: %(message)s"))
        handlers.append(file)
    before = log.level
    log.setLevel(logging.DEBUG if path is not None else level)
    for handler in handlers:
        log.addHandler(handler)
    try:
        yield
    finally:
        for handler in handlers:
            log.removeHandler(handler)
            handler.close()
        log.setLevel(before)
