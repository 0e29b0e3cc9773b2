"""The native driver's loop in C, to learn what the loop in compiled Python costs.

It is built in a temporary folder when a compiler is present, and linked to the very SUNDIALS libraries of the
scikit-sundae wheel. The solver is opened by the engine's own `open_solver`, so that only the loop differs; IDA finds
the roots, as it would for anybody who writes such a loop.
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
from numba import carray, types  # type: ignore[attr-defined]
from numpy.typing import NDArray

from gearidae.bench.contender import BROKEN, Contender, Outcome
from gearidae.compiled import compiled_callback
from gearidae.engine import layout as at
from gearidae.engine.events import EVENTS_AT_ONCE, accept, guard, handle
from gearidae.engine.ledger import enter, follow
from gearidae.engine.newton import DESK, EVALUATIONS
from gearidae.engine.observe import observe
from gearidae.engine.pointers import MANY, numbers
from gearidae.engine.problem import Problem
from gearidae.engine.run import BLOCK_EVENTS
from gearidae.engine.start import first_step, set_rates
from gearidae.engine.sundials import newton_places, places

__all__ = ["c_contenders"]

Floats = NDArray[np.float64]

_REALS: Any = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_COUNT: Any = types.CPointer(types.int64)  # type: ignore[no-untyped-call]


@compiled_callback(types.void(_REALS, types.float64, _REALS, _REALS, types.int32))
def _accept(data, t, y, yp, flag):  # type: ignore[no-untyped-def]
    d = carray(data, (MANY,))
    accept(d, t, carray(y, (4,)))
    follow(d, t, carray(y, (4,)), carray(yp, (4,)), flag != 0)


@compiled_callback(types.int32(_REALS, types.float64, _REALS, _REALS, _COUNT))
def _handle(data, t, y, events, count):  # type: ignore[no-untyped-def]
    number = carray(count, (1,))
    number[0], action = handle(
        carray(data, (MANY,)), t, carray(y, (4,)), carray(events, (BLOCK_EVENTS, 5)), number[0]
    )
    return action


@compiled_callback(types.void(_REALS, types.float64, _REALS, _REALS))
def _observe(data, t, y, row):  # type: ignore[no-untyped-def]
    observe(carray(data, (MANY,)), t, carray(y, (4,)), carray(row, (9,)))


@compiled_callback(types.float64(_REALS, types.float64, _REALS, _REALS, _REALS, types.float64, types.float64))
def _start(data, t, y, yp, scale, rtol, longest):  # type: ignore[no-untyped-def]
    d = carray(data, (MANY,))
    n = 2 if d[at.KIND] == at.ROLLER else 4
    states, rates = carray(y, (n,)), carray(yp, (n,))
    set_rates(d, t, states, rates)
    enter(d, t, states, rates)
    return first_step(d, t, states, rates, carray(scale, (n,)), rtol, longest)


@compiled_callback(types.int32(types.float64, types.intp, types.intp, _REALS, _REALS))
def _guard(t, yy, yp, out, data):  # type: ignore[no-untyped-def]
    carray(out, (1,))[0] = guard(carray(data, (MANY,)), t, numbers(yy))
    return 0


def _libraries() -> list[Path]:
    """SUNDIALS' shared libraries that the loop calls, as the wheel of scikit-sundae brings them."""
    import sksundae

    site = Path(sksundae.__file__).parents[1]
    return [p for name in ("ida", "core") for p in site.glob(f"scikit_sundae.libs/libsundials_{name}-*.so*")]


def _compiler() -> str | None:
    return next((path for name in ("cc", "gcc", "clang") if (path := shutil.which(name))), None)


def _unavailable() -> str:
    from gearidae.engine.sundials import unavailable

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
    from gearidae.engine import native, opened

    d, y = problem.data, problem.start
    yp, dky = np.zeros_like(y), np.zeros_like(y)
    problem.set_tolerance(tolerance)
    known = native.callbacks(y.size, False)
    rows = np.zeros((times.size, max(len(problem.columns), 9)))
    events, counts = np.empty((BLOCK_EVENTS, 5)), np.zeros(2, np.int64)
    handles = np.zeros(opened.HANDLES, np.int64)
    desk = np.zeros(DESK, np.int64)
    calls = np.array([f.address for f in (_accept, _handle, _observe, _start, _guard)], dtype=np.int64)
    where = places(), newton_places()
    observe(d, 0.0, y, rows[0])
    try:
        own = known.model, known.steps, known.newton
        if opened.open_solver(handles, *own, *where, desk, d, y, yp, dky) != 0:
            return BROKEN
        flag = _library().gearidae_loop(
            _pointer(calls),
            *(ctypes.c_void_p(int(handles[k])) for k in (opened.SOLVER, opened.Y, opened.YP, opened.DKY)),
            *(_pointer(a) for a in (d, y, yp, dky, problem.tolerance_scale)),
            ctypes.c_double(tolerance),
            ctypes.c_double(problem.end),
            ctypes.c_int64(times.size),
            ctypes.c_int64(rows.shape[1]),
            _pointer(rows),
            _pointer(events),
            ctypes.c_int64(BLOCK_EVENTS - EVENTS_AT_ONCE),
            _pointer(counts),
        )
    finally:
        opened.close(handles)
    if flag != 0:
        return BROKEN
    names = ("speed", "height") if "height" in problem.columns else ("gear_speed", "transmission_error")
    speed, position = (rows[:, problem.columns.index(name)] for name in names)
    return Outcome(speed, position, int(counts[0]), int(counts[1] + desk[EVALUATIONS]))


def c_contenders() -> tuple[Contender, ...]:
    """The native loop in C."""
    return (Contender("c_loop", "the native loop in C", _run, "compiled", unavailable=_unavailable),)
