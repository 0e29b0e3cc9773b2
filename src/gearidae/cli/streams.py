"""Standard streams on which nothing that is printed can fail: closed ones, and characters that they cannot encode."""

from __future__ import annotations

import io
import os
import shutil
import sys
from pathlib import Path
from typing import Final

_WIDTHS: Final = (40, 1000)
"""Columns that tables can be laid out in: with fewer, or with a hundred million, that takes for ever."""


def mend_streams() -> None:
    """Open closed standard streams on nothing, let the others replace what they cannot encode, and bound the width.

    A closed one would leave its number to the next file that is opened: an archive, into which libraries would then
    print their messages.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    columns = shutil.get_terminal_size().columns
    if not _WIDTHS[0] <= columns <= _WIDTHS[1]:
        os.environ["COLUMNS"] = str(min(max(columns, _WIDTHS[0]), _WIDTHS[1]))


def stop_output() -> None:
    """Send the rest of standard output nowhere: its reader has closed it, or its disk is full."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)
