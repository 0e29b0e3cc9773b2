"""One C function for all that the engine asks of the nodes of an elastic contact, see `calls`."""

from __future__ import annotations

from typing import Any

from numba import carray, types  # type: ignore[attr-defined]
from numba.np.numpy_support import from_dtype

from gearidae.compiled import compiled_callback
from gearidae.engine.elastic import calls, elimination, histories, nodes
from gearidae.engine.elastic.energy import (
    nodes_joining_loss,
    nodes_length_force,
    nodes_material_energy,
    nodes_material_loss,
    nodes_number,
    nodes_stored,
)
from gearidae.engine.model.state import SCENE, STATE, WORK, Model

__all__ = ["answer"]

_INT = types.int64
_REALS: Any = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_RECORDS = [types.CPointer(from_dtype(dtype)) for dtype in (SCENE, STATE, WORK)]  # type: ignore[no-untyped-call]
_ARRAYS = [_REALS, _INT] * 4


@compiled_callback(types.void(*_RECORDS, *_ARRAYS, *calls.QUESTION, _REALS))
def answer(  # type: ignore[no-untyped-def]
    scene, state, work, tables, n_tables, rows, n_rows, motion, n_motion, filled, n_filled,
    kind, k, known, t, gap, rate, length, answers,
):  # fmt: skip
    """Answer one of the questions of `calls`, in two numbers or in the vector to be filled."""
    m = Model(
        carray(scene, (1,))[0],
        carray(state, (1,))[0],
        carray(work, (1,))[0],
        carray(tables, (n_tables,)),
        carray(rows, (n_rows,)),
    )
    y, out = carray(motion, (n_motion,)), carray(filled, (n_filled,))
    two = carray(answers, (2,))
    two[0] = two[1] = 0.0
    if kind == calls.FORCE:
        two[0], two[1] = nodes.node_force(m, k, known != 0, t, y, gap, rate, length)
    elif kind == calls.SETTLE:
        two[0], two[1] = elimination.settle_pair(m, k, known != 0, t, y, gap, rate, length)
    elif kind == calls.PREDICT:
        elimination.predict(m, k, known != 0, t, y, gap, rate)
    elif kind == calls.FINISH:
        elimination.finish_pair(m, k, known != 0, t, y, gap, rate, length)
    elif kind == calls.RESIDUAL:
        nodes.node_residual(m, y, out)
    elif kind == calls.RATES:
        nodes.node_rates(m, out)
    elif kind == calls.INIT:
        histories.init_nodes(m, k, y, gap)
    elif kind == calls.FOLLOW:
        histories.follow_nodes(m, k, y, gap)
    elif kind == calls.JOIN:
        histories.join_nodes(m, k, y, gap)
    elif kind == calls.STORED:
        two[0] = nodes_stored(m, k, t, y, gap, rate, length)
    elif kind == calls.JOINING_LOSS:
        two[0] = nodes_joining_loss(m, k, y, gap)
    elif kind == calls.NUMBER:
        two[0] = nodes_number(m, k, y, gap, known)
    elif kind == calls.MATERIAL_ENERGY:
        two[0], two[1] = nodes_material_energy(m, k, y, gap, rate, known)
    elif kind == calls.MATERIAL_LOSS:
        two[0] = nodes_material_loss(m, k, y, gap, known)
    else:
        two[0], two[1] = nodes_length_force(m, k, t, y, gap, rate, length)
