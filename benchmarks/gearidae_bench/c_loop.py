"""The native driver's loop in C, to learn what the loop in compiled Python costs.

It is built in a temporary folder when a compiler is present, and linked to the very SUNDIALS libraries of the
scikit-sundae wheel. The solver is opened by the engine's own `open_solver`, so that only the loop differs.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearidae.engine.integrate.driver import CONVERGENCE_FAILURES_HIGH
from gearidae.engine.integrate.roots import SHARPNESS
from gearidae.engine.model.addresses import POINTERS, note_addresses
from gearidae.engine.motion.observe import observe
from gearidae.engine.setup.problem import Problem
from gearidae.engine.sundials.names import linear_solver_offsets, newton_offsets
from gearidae_bench.contender import BROKEN, Contender, Outcome
from gearidae_bench.reference import end_of

__all__ = ["c_contenders"]

Floats = NDArray[np.float64]


def _libraries() -> list[Path]:
    """SUNDIALS' shared libraries that the loop calls, as the wheel of scikit-sundae brings them."""
    import sksundae

    site = Path(sksundae.__file__).parents[1]
    return [p for name in ("ida", "core") for p in site.glob(f"scikit_sundae.libs/libsundials_{name}-*.so*")]


def _compiler() -> str | None:
    return next((path for name in ("cc", "gcc", "clang") if (path := shutil.which(name))), None)


def _unavailable() -> str:
    from gearidae.engine.sundials.names import unavailable

    if reason := unavailable():
        return reason
    if _compiler() is None:
        return "no C compiler found"
    if len(_libraries()) != 2:
        return "the SUNDIALS libraries of scikit-sundae were not found as separate files"
    try:
        _library()
    except (subprocess.CalledProcessError, OSError) as error:
        return f"the C loop could not be built ({error})"
    return ""


@cache
def _library() -> ctypes.CDLL:
    """Build and load the C loop."""
    compiler = _compiler()
    assert compiler is not None
    libraries = _libraries()
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "loop.so"
        command = [compiler, "-O3", "-march=native", "-shared", "-fPIC", "-o", str(target)]
        command += [str(Path(__file__).with_name("loop.c")), *map(str, libraries)]
        command += [f"-Wl,-rpath,{libraries[0].parent}"]
        subprocess.run(command, check=True, capture_output=True)
        library = ctypes.CDLL(str(target))
    library.gearidae_loop.restype = ctypes.c_int
    return library


def _pointer(array: NDArray[Any]) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def _run(problem: Problem, tolerance: float, times: Floats) -> Outcome:
    from gearidae.engine.callbacks import callbacks
    from gearidae.engine.sundials import ida_memory as opened
    from gearidae_bench.c_calls import BLOCK_NUMBERS, VECTORS, WORDS, addresses

    m, n = problem.prepare(tolerance, times.size), problem.start.size
    words, numbers = np.zeros(WORDS, np.int64), np.zeros(VECTORS * n + 1)
    pointers, handles = words[:POINTERS], words[POINTERS:]
    y, yp, dky = (numbers[k * n : (k + 1) * n] for k in range(3))
    y[:] = problem.start
    note_addresses(m, pointers)
    rows = np.zeros((times.size, max(len(problem.columns), 9)))
    events, steps, calls = np.empty(BLOCK_NUMBERS), np.zeros(1, np.int64), addresses()
    m.work.search.sharpness = SHARPNESS * tolerance
    observe(m, 0.0, y, rows[0])
    where = opened.FunctionOffsets(linear_solver_offsets(), newton_offsets())
    try:
        of_ours = problem.addresses.base, callbacks(n, False), where, (y, yp, dky)
        if opened.open_solver(handles, *of_ours, CONVERGENCE_FAILURES_HIGH) != 0:
            return BROKEN
        flag = _library().gearidae_loop(
            *(_pointer(a) for a in (calls, words, numbers, numbers[VECTORS * n :])),
            *(ctypes.c_void_p(int(handles[k])) for k in (opened.IDA, opened.Y, opened.YP)),
            ctypes.c_double(SHARPNESS * tolerance),
            ctypes.c_double(end_of(problem)),
            ctypes.c_int64(times.size),
            ctypes.c_int64(rows.shape[1]),
            *(_pointer(a) for a in (rows, events, steps)),
        )
    finally:
        opened.close_solver(handles)
    if flag != 0:
        return BROKEN
    names = ("speed", "height") if "height" in problem.columns else ("gear_speed", "transmission_error")
    speed, position = (rows[:, problem.columns.index(name)] for name in names)
    return Outcome(speed, position, int(steps[0]), int(m.work.adams.evaluations))


def c_contenders() -> tuple[Contender, ...]:
    """The native loop in C."""
    return (Contender("c_loop", "the native loop in C", _run, "compiled", unavailable=_unavailable),)
