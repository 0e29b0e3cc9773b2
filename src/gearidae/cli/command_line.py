"""Runs a command and turns each error into one line and an exit code."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from cyclopts import CycloptsError

from gearidae.cli.codes import BAD_INPUT, DONE, INTERRUPTED, UNFINISHED
from gearidae.cli.interrupts import interrupts_kept
from gearidae.cli.session import app
from gearidae.cli.values import spread
from gearidae.errors import GearidaeError, SceneError

__all__ = ["run_command_line"]


def run_command_line(arguments: Sequence[str] | None) -> int:
    """Run a command; arguments and exit code are those of `gearidae.cli.main`."""
    tokens = spread(sys.argv[1:] if arguments is None else arguments)
    try:
        with interrupts_kept():
            code = app.meta(tokens, exit_on_error=False, print_error=False, result_action="return_value")
    except CycloptsError as error:
        return _complain(f"{' '.join(str(error).split())} (see gearidae --help)", BAD_INPUT)
    except SceneError as error:
        return _complain(str(error), BAD_INPUT)
    except GearidaeError as error:
        return _complain(str(error), UNFINISHED)
    except KeyboardInterrupt as interrupt:
        return _complain(f"interrupted{''.join(f'; {note}' for note in interrupt.args)}", INTERRUPTED)
    except BrokenPipeError:
        # The reader of the output has closed (a pager, head); without this, Python prints an error at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except OSError as error:
        # A disk that is full where compiled code is kept, say; of the user's own files the commands say more.
        return _complain(f"the system refuses to go on: {error}", UNFINISHED)
    return code if isinstance(code, int) else DONE


def _complain(message: str, code: int) -> int:
    sys.stderr.write(f"gearidae: {' '.join(message.split())}\n")
    return code
