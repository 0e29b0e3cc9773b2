"""Exit codes of the program."""

from __future__ import annotations

DONE = 0
BAD_INPUT = 2
"""The command line, a case file or an archive is wrong; nothing was written."""
UNFINISHED = 3
"""The solver failed, or the disk is full; the results up to then are kept."""
INTERRUPTED = 130
"""Ctrl-C; the results up to then are kept."""
TERMINATED = 143
"""SIGTERM, as from a batch system whose time is over; the results up to then are kept."""
HUNG_UP = 129
"""SIGHUP, from a terminal that closes; the results up to then are kept."""
