"""Ctrl-C where Python drops it: in a destructor or a callback from C, while compiled code is being loaded."""

from __future__ import annotations

import _thread
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

__all__ = ["interrupts_kept"]

_MOMENT: Final = 0.02
"""Seconds."""


@contextmanager
def interrupts_kept() -> Iterator[None]:
    """Raise a `KeyboardInterrupt` again that could not be raised where it came."""
    usual = sys.unraisablehook

    def again(unraisable: UnraisableHookArgs) -> None:
        if isinstance(unraisable.exc_value, KeyboardInterrupt):
            # from another thread and a moment later: raised in here it would be dropped again
            again_soon = threading.Timer(_MOMENT, _thread.interrupt_main)
            again_soon.daemon = True
            again_soon.start()
        else:
            usual(unraisable)

    sys.unraisablehook = again
    try:
        yield
    finally:
        sys.unraisablehook = usual
