"""Ctrl-C while a file is opened or written: put off until that is done."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

__all__ = ["uninterrupted"]


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Put a `KeyboardInterrupt` off until the block is left, or the function that this decorates.

    xarray takes its locks of HDF5 in Python code: an interrupt between taking one and entering what it guards leaves it
    taken, and whoever closes the file then waits for ever. Other threads than the main one are never interrupted.
    """
    usual = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(usual):
        yield
        return
    came: list[FrameType | None] = []
    signal.signal(signal.SIGINT, lambda _, frame: came.append(frame))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
        if came:
            usual(signal.SIGINT, came[0])
