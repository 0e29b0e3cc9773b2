"""The command line; everything heavier than reading its arguments is loaded by the command that needs it."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from typing import Final

from gearidae.cli.codes import INTERRUPTED, UNFINISHED
from gearidae.cli.streams import mend_streams

__all__ = ["main"]

_LACKS_MEMORY: Final = re.compile("failed to map segment|[Cc]annot allocate memory")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        Arguments after the program's name; by default those of the process.

    Returns
    -------
    int
        0 done, 2 bad input, 3 solver failure, 130 interrupted, 143 terminated, 129 left by its terminal.
    """
    mend_streams()
    try:
        from gearidae.cli.command_line import run_command_line

        return run_command_line(arguments)
    except KeyboardInterrupt:  # loading it takes a third of a second
        sys.stderr.write("gearidae: interrupted\n")
        return INTERRUPTED
    except (MemoryError, ImportError) as error:  # libraries are loaded into memory too
        if isinstance(error, ImportError) and not _LACKS_MEMORY.search(str(error)):
            raise
    sys.stderr.write("gearidae: there is not enough memory for this (ulimit -v limits it)\n")
    return UNFINISHED
