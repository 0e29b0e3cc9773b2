"""Options of numba's that are not documented and could be gone in its next version.

They are tried once, and done without where they are not taken.
"""

from __future__ import annotations

import json
import logging
import os
from contextlib import suppress
from functools import cache
from typing import Any, Final

from gearidae.compiled.cache import PLAIN, cache_folder, is_cached, numba

log = logging.getLogger(__name__)

_UNDOCUMENTED: Final[dict[str, Any]] = {
    "_nrt": False,
    "forceinline": True,
    "no_cfunc_wrapper": True,
    "no_cpython_wrapper": True,
}


def compiles() -> bool:
    """Whether numba compiles, which ``NUMBA_DISABLE_JIT`` keeps it from."""
    config: Any = numba.config
    return not config.DISABLE_JIT


@cache
def numba_options() -> frozenset[str]:
    """Which of the undocumented options that gearidae would like this numba takes; tried once, and then known."""
    if os.environ.get(PLAIN):
        return frozenset()
    note = cache_folder() / "numba_options.json"
    with suppress(OSError, ValueError, TypeError):
        return frozenset(json.loads(note.read_text())) & frozenset(_UNDOCUMENTED)
    taken = frozenset(name for name, value in _UNDOCUMENTED.items() if _takes(name, value))
    for name in sorted(frozenset(_UNDOCUMENTED) - taken):
        log.warning(
            "numba %s does not take its option %s: runs or compilation will be slower",
            numba.__version__,
            name,
        )
    if is_cached():
        with suppress(OSError):
            note.write_text(json.dumps(sorted(taken)))
    return taken


def _takes(name: str, value: Any) -> bool:
    """Whether numba takes an option, and compiles a look at part of an array with it."""

    def second(numbers):  # type: ignore[no-untyped-def]
        return numbers[1:][0]

    try:
        options: Any = {name: value}
        numba.njit("float64(float64[::1])", **options)(second)
    except Exception:  # whatever numba says: without the option all is well
        return False
    return True
