"""One C function for all that the engine asks of the nodes of an elastic contact, see `calls`."""

from __future__ import annotations

from numba import carray, types  # type: ignore[attr-defined]

from gearidae.compiled import compiled_callback
from gearidae.engine.elastic import calls as calls
from gearidae.engine.elastic import nodes
from gearidae.engine.elastic.energy import nodes_joining_loss, nodes_length_force, nodes_stored
from gearidae.engine.sundials.memory import MANY

__all__ = ["answer"]

_INT, _REAL = types.int64, types.float64
_REALS = types.CPointer(types.float64)  # type: ignore[no-untyped-call]


@compiled_callback(types.void(_INT, _REALS, _INT, _INT, _REAL, _REALS, _REAL, _REAL, _REAL, _REALS, _REALS))
def answer(question, scene, slot, known, t, state, gap, rate, length, filled, answers):  # type: ignore[no-untyped-def]
    """Answer one of the questions of `node_calls`, in two numbers or in the vector to be filled."""
    d, y, out = carray(scene, (MANY,)), carray(state, (MANY,)), carray(filled, (MANY,))
    two = carray(answers, (2,))
    two[0] = two[1] = 0.0
    if question == calls.FORCE:
        two[0], two[1] = nodes.node_force(d, slot, known != 0, t, y, gap, rate, length)
    elif question == calls.RESIDUAL:
        nodes.node_residual(d, y, out)
    elif question == calls.RATES:
        nodes.node_rates(d, out)
    elif question == calls.MEET:
        nodes.meet_nodes(d, slot, y, gap)
    elif question == calls.FOLLOW:
        nodes.follow_nodes(d, slot, y, gap)
    elif question == calls.JOIN:
        nodes.join_nodes(d, slot, y, gap)
    elif question == calls.STORED:
        two[0] = nodes_stored(d, slot, t, y, gap, rate, length)
    elif question == calls.JOINING_LOSS:
        two[0] = nodes_joining_loss(d, slot, y, gap)
    else:
        two[0], two[1] = nodes_length_force(d, slot, t, y, gap, rate, length)
