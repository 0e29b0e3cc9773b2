"""Ctrl-C for runs in threads: it reaches the main thread alone, and a thread's run can end from inside only."""

from __future__ import annotations

import threading

_of_this_thread = threading.local()


def heed(halted: threading.Event) -> None:
    """Let the runs of this thread end as soon as an event is set."""
    _of_this_thread.halted = halted


def is_halted() -> bool:
    """Whether the runs of this thread are to end."""
    halted = getattr(_of_this_thread, "halted", None)
    return halted is not None and halted.is_set()
