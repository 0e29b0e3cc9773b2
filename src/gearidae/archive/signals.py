"""Signals to stop, put off while a file is between two states."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from gearidae.errors import STOPS


@contextmanager
def signals_put_off() -> Iterator[None]:
    """Put what a signal raises off until the block is left; other threads than the main one are never interrupted."""
    handlers = {number: usual for number in STOPS if callable(usual := signal.getsignal(number))}
    if threading.current_thread() is not threading.main_thread():
        handlers = {}
    came: list[tuple[int, FrameType | None]] = []
    for number in handlers:
        signal.signal(number, lambda *signalled: came.append(signalled))
    try:
        yield
    finally:
        for number, usual in handlers.items():
            signal.signal(number, usual)
        if came:
            handlers[signal.Signals(came[0][0])](*came[0])
