"""Ctrl-C: one is enough, and none is lost."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from sys import UnraisableHookArgs
    from types import FrameType

_MOMENT: Final = 0.02
"""Seconds."""
_CLOSING: Final = 3.0
"""After Ctrl-C, for how long another one is ignored: it would cut off that what is computed is put away [s]."""


@contextmanager
def interrupts_kept() -> Iterator[None]:
    """Raise one `KeyboardInterrupt` for Ctrl-C, also where Python drops it: in a destructor or a callback from C."""
    usual, heeded = sys.unraisablehook, -_CLOSING

    def interrupt(_number: int, _frame: FrameType | None) -> None:
        nonlocal heeded
        if monotonic() - heeded >= _CLOSING:
            heeded = monotonic()
            raise KeyboardInterrupt

    def again(unraisable: UnraisableHookArgs) -> None:
        nonlocal heeded
        if isinstance(unraisable.exc_value, KeyboardInterrupt):
            heeded = monotonic() - _CLOSING
            # from another thread and a moment later: raised in here it would be dropped again
            again_soon = threading.Timer(_MOMENT, _thread.interrupt_main)
            again_soon.daemon = True
            again_soon.start()
        else:
            usual(unraisable)

    # a shell's background jobs ignore Ctrl-C, and other threads cannot have a handler: both as they are
    ours = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    ours = ours and threading.current_thread() is threading.main_thread()
    sys.unraisablehook = again
    if ours:
        signal.signal(signal.SIGINT, interrupt)
    try:
        yield
    finally:
        sys.unraisablehook = usual
        if ours:
            signal.signal(signal.SIGINT, signal.default_int_handler)
