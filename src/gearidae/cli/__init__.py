"""The command line; everything heavier than reading its arguments is loaded by the command that needs it."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from gearidae.cli.codes import INTERRUPTED
from gearidae.cli.streams import mend_streams

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        Arguments after the program's name; by default those of the process.

    Returns
    -------
    int
        0 done, 2 bad input, 3 solver failure, 130 interrupted.
    """
    mend_streams()
    try:
        from gearidae.cli.command_line import run_command_line
    except KeyboardInterrupt:  # loading it takes a third of a second
        sys.stderr.write("gearidae: interrupted\n")
        return INTERRUPTED
    return run_command_line(arguments)
