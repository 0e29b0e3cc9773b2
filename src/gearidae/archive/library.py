"""netCDF's library: one thread at a time, and no Ctrl-C in the middle."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Final

__all__ = ["LIBRARY", "uninterrupted"]

LIBRARY: Final = threading.RLock()
"""To be held while netCDF's library is used, which may end the program if two threads do so at once."""


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold `LIBRARY`, and put a `KeyboardInterrupt` off until the block is left, or the function that this decorates.

    xarray takes its locks of HDF5 in Python code: an interrupt between taking one and entering what it guards leaves it
    taken, and whoever closes the file then waits for ever. Other threads than the main one are never interrupted.
    """
    usual = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(usual):
        with LIBRARY:
            yield
        return
    came: list[FrameType | None] = []
    signal.signal(signal.SIGINT, lambda _, frame: came.append(frame))
    try:
        with LIBRARY:
            yield
    finally:
        signal.signal(signal.SIGINT, usual)
        if came:
            usual(signal.SIGINT, came[0])
