"""What the loop in C calls: the engine's own functions as C functions, which need the SUNDIALS library to be loaded."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import carray, types  # type: ignore[attr-defined]
from numpy.typing import NDArray

from gearidae.engine.events.events import accept, guard, handle
from gearidae.engine.integrate import adams
from gearidae.engine.integrate.driver import BLOCK_EVENTS
from gearidae.engine.integrate.native import book, restart, state_for_sample
from gearidae.engine.integrate.root_finding import state_at
from gearidae.engine.integrate.step_control import change_wanted
from gearidae.engine.model import layout as at
from gearidae.engine.model.observe import observe
from gearidae.engine.sundials import ida_memory as opened
from gearidae.engine.sundials.memory import MANY
from gearidae_bench.compiling import compiled_callback

__all__ = ["addresses"]


_REALS: Any = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_WORDS: Any = types.CPointer(types.int64)  # type: ignore[no-untyped-call]


@compiled_callback(types.int32(_REALS, _REALS, types.float64, _REALS, _REALS, _REALS, _REALS, types.int32))
def _accept(data, desk, t, y, yp, dky, spare, flag):  # type: ignore[no-untyped-def]
    d, known = carray(data, (MANY,)), carray(desk, (adams.DESK,))
    n = int(d[at.STATES])
    state, rates = carray(y, (n,)), carray(yp, (n,))
    accept(d, t, state)
    book(known, d, t, state, rates, carray(dky, (n,)), carray(spare, (n,)), flag)
    return change_wanted(known, d, state, rates)


@compiled_callback(types.int32(_REALS, types.float64, _REALS, _REALS, _WORDS))
def _handle(data, t, y, events, count):  # type: ignore[no-untyped-def]
    number = carray(count, (1,))
    number[0], action = handle(
        carray(data, (MANY,)), t, carray(y, (4,)), carray(events, (BLOCK_EVENTS, 5)), number[0]
    )
    return action


@compiled_callback(types.void(_REALS, _WORDS, _REALS, types.float64, _REALS, _REALS, _REALS))
def _observe(data, handles, desk, t, y, yp, row):  # type: ignore[no-untyped-def]
    d = carray(data, (MANY,))
    n = int(d[at.STATES])
    state, rates = carray(y, (n,)), carray(yp, (n,))
    state_for_sample(carray(handles, (opened.HANDLES,)), carray(desk, (adams.DESK,)), t, state, rates)
    observe(d, t, state, carray(row, (9,)))


@compiled_callback(
    types.int32(_REALS, _WORDS, _REALS, types.float64, _REALS, _REALS, _REALS, types.float64, types.float64)
)
def _restart(data, handles, desk, t, y, yp, scale, rtol, stop):  # type: ignore[no-untyped-def]
    d = carray(data, (MANY,))
    n = int(d[at.STATES])
    known = carray(handles, (opened.HANDLES,))
    states, rates, scales = carray(y, (n,)), carray(yp, (n,)), carray(scale, (n,))
    return restart(known, carray(desk, (adams.DESK,)), d, t, states, rates, scales, rtol, stop)


@compiled_callback(types.float64(_REALS, types.float64, _REALS))
def _guard(data, t, y):  # type: ignore[no-untyped-def]
    return guard(carray(data, (MANY,)), t, carray(y, (4,)))


@compiled_callback(types.void(_REALS, _REALS, types.float64, _REALS))
def _keep(data, desk, t, yp):  # type: ignore[no-untyped-def]
    adams.keep(carray(desk, (adams.DESK,)), t, carray(yp, (int(carray(data, (MANY,))[at.STATES]),)))


@compiled_callback(types.void(_REALS, _WORDS, _REALS, types.float64, _REALS, _REALS))
def _state_at(data, handles, desk, t, y, yp):  # type: ignore[no-untyped-def]
    n = int(carray(data, (MANY,))[at.STATES])
    known = carray(handles, (opened.HANDLES,))
    vectors = known[opened.Y : opened.YP + 1]
    state_at(known[opened.SOLVER], vectors, carray(desk, (adams.DESK,)), t, carray(y, (n,)), carray(yp, (n,)))


def addresses() -> NDArray[np.int64]:
    """Addresses in the order that the loop has them in."""
    functions = (_accept, _handle, _observe, _restart, _guard, _keep, _state_at)
    return np.array([f.address for f in functions], dtype=np.int64)
