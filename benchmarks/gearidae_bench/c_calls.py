"""What the loop in C calls: the engine's own functions as C functions, which need the SUNDIALS library to be loaded.

The loop hands on two addresses and knows nothing of what lies there: words (where the model lies, then SUNDIALS'
handles) and numbers (state, rates, two vectors of work space, and the time reached).
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numba import carray, types  # type: ignore[attr-defined]
from numpy.typing import NDArray

from gearidae.engine import adams
from gearidae.engine.events.events import guard
from gearidae.engine.events.record import EVENT_NUMBERS
from gearidae.engine.events.stops import next_stop
from gearidae.engine.integrate.driver import BLOCK_EVENTS, BLOCK_PASSAGES, Output
from gearidae.engine.integrate.roots import Stepper, state_at, state_for_sample
from gearidae.engine.model.addresses import POINTERS, model_at
from gearidae.engine.motion.observe import observe
from gearidae.engine.observers.passages import PASSAGE_NUMBERS
from gearidae.engine.step import finish_step, has_room, prepare_restart, restart
from gearidae.engine.sundials.ida_memory import HANDLES
from gearidae.engine.sundials.memory import words
from gearidae_bench.compiling import compiled_callback

__all__ = ["VECTORS", "WORDS", "addresses"]

WORDS: Final = POINTERS + HANDLES
VECTORS: Final = 4
"""State, rates and work space; the time follows them."""

_PASSAGES_AT: Final = BLOCK_EVENTS * EVENT_NUMBERS
BLOCK_NUMBERS: Final = _PASSAGES_AT + BLOCK_PASSAGES * PASSAGE_NUMBERS
"""Numbers of the events and the passages of a block."""

_GO_ON, _AFRESH, _DONE, _BROKEN = range(4)  # as in loop.c

_PTR: Any = types.intp
_REALS: Any = types.CPointer(types.float64)  # type: ignore[no-untyped-call]


@compiled_callback(types.int32(_PTR, _REALS, types.int32, _REALS))
def _finish(place, numbers, flag, events):  # type: ignore[no-untyped-def]
    m = model_at(place)
    n, driver = m.scene.states, m.work.driver
    a, block = carray(numbers, (VECTORS * n + 1,)), carray(events, (BLOCK_NUMBERS,))
    room = block[:_PASSAGES_AT].reshape((BLOCK_EVENTS, EVENT_NUMBERS))
    passages = block[_PASSAGES_AT:].reshape((BLOCK_PASSAGES, PASSAGE_NUMBERS))
    driver.time = a[VECTORS * n]
    out = Output(room, room, passages, room)  # no samples are written here, and no scene keeps impacts
    if not has_room(driver.events, driver.passages, 0, out):  # nobody reads them
        driver.events = driver.passages = 0
    between = (a[2 * n : 3 * n], a[3 * n : 4 * n])
    afresh = finish_step(m, driver.time, a[:n], a[n : 2 * n], between, flag, out)
    if driver.error != 0:
        return _BROKEN
    if driver.done != 0:
        return _DONE
    return _AFRESH if afresh else _GO_ON


@compiled_callback(types.void(_PTR, _REALS, types.float64, _REALS))
def _observe(place, numbers, t, row):  # type: ignore[no-untyped-def]
    m = model_at(place)
    n, handles = m.scene.states, words(place, WORDS)[POINTERS:]
    a = carray(numbers, (VECTORS * n + 1,))
    y, yp, dky, spare = a[:n], a[n : 2 * n], a[2 * n : 3 * n], a[3 * n : 4 * n]
    state_for_sample(Stepper(handles, m, y, yp, dky, spare, a[4 * n :]), t)
    observe(m, t, dky, carray(row, (9,)))


@compiled_callback(types.int32(_PTR, _REALS, types.int32))
def _restart(place, numbers, again):  # type: ignore[no-untyped-def]
    m = model_at(place)
    n, handles = m.scene.states, words(place, WORDS)[POINTERS:]
    a = carray(numbers, (VECTORS * n + 1,))
    y, yp, dky, spare = a[:n], a[n : 2 * n], a[2 * n : 3 * n], a[3 * n : 4 * n]
    if again != 0:
        prepare_restart(m, a[4 * n], y, yp)
    else:
        m.work.adams.wanted = m.work.adams.native_newton
    return restart(Stepper(handles, m, y, yp, dky, spare, a[4 * n :]), next_stop(m))


@compiled_callback(types.float64(_PTR, _REALS, types.float64))
def _guard(place, numbers, t):  # type: ignore[no-untyped-def]
    m = model_at(place)
    return guard(m, t, carray(numbers, (m.scene.states,)))


@compiled_callback(types.void(_PTR, _REALS))
def _keep(place, numbers):  # type: ignore[no-untyped-def]
    m = model_at(place)
    n = m.scene.states
    a = carray(numbers, (VECTORS * n + 1,))
    adams.store_step(m.work.adams, a[VECTORS * n], a[n : 2 * n])


@compiled_callback(types.void(_PTR, _REALS, types.float64))
def _state_at(place, numbers, t):  # type: ignore[no-untyped-def]
    m = model_at(place)
    n, handles = m.scene.states, words(place, WORDS)[POINTERS:]
    a = carray(numbers, (VECTORS * n + 1,))
    y, yp, dky, spare = a[:n], a[n : 2 * n], a[2 * n : 3 * n], a[3 * n : 4 * n]
    state_at(Stepper(handles, m, y, yp, dky, spare, a[4 * n :]), t, False)


def addresses() -> NDArray[np.int64]:
    """Addresses in the order that the loop has them in."""
    functions = (_finish, _observe, _restart, _guard, _keep, _state_at)
    return np.array([f.address for f in functions], dtype=np.int64)
