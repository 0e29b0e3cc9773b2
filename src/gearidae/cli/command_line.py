"""Runs a command and turns each error into one line and an exit code."""

from __future__ import annotations

import logging
import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from cyclopts import CycloptsError

from gearidae.cli.codes import BAD_INPUT, DONE, INTERRUPTED, UNFINISHED
from gearidae.cli.interrupts import ENDINGS, interrupts_kept, stopped_by
from gearidae.cli.output import print_error
from gearidae.cli.session import app
from gearidae.cli.streams import stop_output
from gearidae.errors import DiskFullError, GearidaeError, SceneError

_TAKES_PAIRS = ("--set", "--over", "--vary", "--seen", "--select", "--line")


def run_command_line(arguments: Sequence[str] | None) -> int:
    """Run a command; arguments and exit code are those of `gearidae.cli.main`."""
    tokens = spread(sys.argv[1:] if arguments is None else arguments)
    # a user's settings of matplotlib may be of another version, and name a backend that is not installed
    os.environ["MPLBACKEND"] = "agg"
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    with interrupts_kept(), _warnings_as_lines():
        return _run(tokens)


def _run(tokens: Sequence[str]) -> int:
    try:
        code = app.meta(tokens, exit_on_error=False, print_error=False, result_action="return_value")
    except CycloptsError as error:
        return _failed(f"{' '.join(str(error).split())} (see gearidae --help)", BAD_INPUT)
    except DiskFullError as error:
        return _failed(str(error), UNFINISHED)
    except SceneError as error:
        return _failed(str(error), BAD_INPUT)
    except GearidaeError as error:
        return _failed(str(error), UNFINISHED)
    except KeyboardInterrupt as interrupt:
        word, code = ENDINGS.get(stopped_by(), ("interrupted", INTERRUPTED))
        return _failed(f"{word}{''.join(f'; {note}' for note in interrupt.args)}", code)
    except BrokenPipeError:
        stop_output()
        return DONE
    except OSError as error:
        # A disk that is full where compiled code is kept, say; of the user's own files the commands say more.
        return _failed(f"the system refuses to go on: {error}", UNFINISHED)
    return code if isinstance(code, int) else DONE


def _failed(message: str, code: int) -> int:
    print_error(message)
    return code


def spread(arguments: Sequence[str]) -> list[str]:
    """Let several pairs follow one ``--set`` or ``--over``: ``--set a=1 b=2`` is ``--set a=1 --set b=2``.

    A pair contains ``=`` and does not begin with a dash, so that a case file may stand after the pairs.

    Parameters
    ----------
    arguments : sequence of str
        The command line.
    """
    spread_out: list[str] = []
    option = ""
    for argument in arguments:
        if argument in _TAKES_PAIRS:
            option = argument
        elif argument.startswith("-") or "=" not in argument:
            option = ""
        elif option and spread_out[-1] != option:
            spread_out.append(option)
        spread_out.append(argument)
    return spread_out


@contextmanager
def _warnings_as_lines() -> Iterator[None]:
    """Print a warning, such as of a damaged run, as a message to the user: without a line of code."""
    with warnings.catch_warnings(action="always", category=UserWarning):
        # numba adds a traceback to its own
        warnings.showwarning = lambda message, *_: print_error(
            str(message).partition("Traceback (most recent")[0].strip(" :\n")
        )
        yield
