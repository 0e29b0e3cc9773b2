"""Ctrl-C and other signals to stop: one is enough, and none is lost."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING, Final

from gearidae.cli.codes import HUNG_UP, TERMINATED
from gearidae.errors import STOPS

if TYPE_CHECKING:
    from sys import UnraisableHookArgs
    from types import FrameType

_MOMENT: Final = 0.02
"""Seconds."""
_CLOSING: Final = 3.0
"""After Ctrl-C, for how long another one is ignored: it would cut off that what is computed is put away [s]."""


ENDINGS: Final = {"SIGTERM": ("terminated", TERMINATED), "SIGHUP": ("the terminal has gone", HUNG_UP)}
"""What signals other than that of Ctrl-C are called, and their exit codes."""

_stopped_by = ""


def stopped_by() -> str:
    """Name of the signal that came last."""
    return _stopped_by


@contextmanager
def interrupts_kept() -> Iterator[None]:
    """Raise one `KeyboardInterrupt` for a signal, also where Python drops it: in a destructor or a callback from C."""
    global _stopped_by
    usual, heeded = sys.unraisablehook, -_CLOSING
    _stopped_by = ""

    def interrupt(number: int, _frame: FrameType | None) -> None:
        global _stopped_by
        nonlocal heeded
        if monotonic() - heeded >= _CLOSING:
            heeded, _stopped_by = monotonic(), signal.Signals(number).name
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
    handlers = {number: signal.getsignal(number) for number in STOPS}
    if threading.current_thread() is not threading.main_thread():
        handlers = {}
    sys.unraisablehook = again
    ours = (signal.default_int_handler, signal.SIG_DFL)
    replaced = {number: handler for number, handler in handlers.items() if handler in ours}
    for number in replaced:
        signal.signal(number, interrupt)
    try:
        yield
    finally:
        sys.unraisablehook = usual
        for number, handler in replaced.items():
            signal.signal(number, handler)
