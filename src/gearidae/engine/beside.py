"""Parts of the engine compiled in as many processes as there are cores, the first time on a machine.

Numba compiles in one thread. Each process keeps what it has compiled on disk, where the others find it: what this one
needs of a part after that is read.
"""

from __future__ import annotations

import json
import logging
import os
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from typing import Final

from gearidae.compiled import cache_folder, is_cached, make_ready

log = logging.getLogger(__name__)

LOOP: Final = "the loop over steps"
"""A part beside those of `gearidae.compiled.ready`: what the native driver runs."""
_NOTE: Final = "parts.json"
_COMPILE: Final = "import sys; from gearidae.engine.beside import compile_here; compile_here(sys.argv[1:])"


def compile_side_by_side(parts: Sequence[str]) -> None:
    """Compile parts that have not been compiled on this machine; without a second core nothing is done ahead.

    Parameters
    ----------
    parts : sequence of str
        Of `gearidae.engine.compiling`, and `LOOP`; the longest first. The first is compiled by this process.
    """
    known = _compiled_before()
    missing = [part for part in parts if part not in known]
    processes = min(_cores(), len(missing))
    if processes < 2 or not is_cached():
        return
    others = [(share, _begin(share)) for share in (missing[k::processes] for k in range(1, processes))]
    try:
        compile_here(missing[::processes])
        done = missing[::processes]
        for share, process in others:
            if process is not None and process.wait() == 0:
                done += share
            else:  # what is missing is compiled where it is needed
                log.info("no process of its own has compiled %s", ", ".join(share))
    finally:
        for _, process in others:
            if process is not None:
                process.kill()
                process.wait()
    with suppress(OSError):
        (cache_folder() / _NOTE).write_text(json.dumps(sorted({*known, *done})))


def compile_here(parts: Sequence[str]) -> None:
    """Compile parts in this process, or take them from the cache."""
    import_module("gearidae.engine.backend")  # with all that declares functions of the parts
    native = import_module("gearidae.engine.native")
    for part in parts:
        if part == LOOP:
            native.prepare_loop()
        else:
            make_ready(part)


def _begin(parts: Sequence[str]) -> subprocess.Popen[bytes] | None:
    """Have a process of its own compile parts; None where none can be had."""
    with suppress(OSError, ValueError):
        return subprocess.Popen(
            [sys.executable, "-c", _COMPILE, *parts],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    return None


def _cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _compiled_before() -> set[str]:
    """Parts that have been compiled on this machine, as the note beside their code says."""
    with suppress(OSError, ValueError, TypeError):
        return set(json.loads((cache_folder() / _NOTE).read_text()))
    return set()
