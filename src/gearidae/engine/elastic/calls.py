"""The nodes of an elastic contact as the rest of the engine calls them: at an address.

What `gearidae.engine.elastic.nodes` and `gearidae.engine.elastic.energy` do is a third of all that there is to
compile, and is
needed by a scene of elastic contacts only. Called as compiled functions call each other, it would be compiled into
every one of its callers besides, for every scene. So it is compiled on its own
(`gearidae.engine.elastic.service`), when
a scene first needs it, and called where the scene's numbers say that it lies. The functions here have the names and
arguments of those that they call.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import Any, Final

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.extending import intrinsic
from numpy.typing import NDArray

from gearidae.compiled import compiled, say_compiling
from gearidae.engine.model import layout as at

__all__ = [
    "FOLLOW",
    "FORCE",
    "JOIN",
    "JOINING_LOSS",
    "LENGTH_FORCE",
    "MEET",
    "RATES",
    "RESIDUAL",
    "STORED",
    "follow_nodes",
    "join_nodes",
    "meet_nodes",
    "node_force",
    "node_rates",
    "node_residual",
    "nodes_joining_loss",
    "nodes_length_force",
    "nodes_stored",
    "service",
]

Floats = NDArray[np.float64]

FORCE: Final = 0  # what is asked for
RESIDUAL: Final = 1
RATES: Final = 2
MEET: Final = 3
FOLLOW: Final = 4
JOIN: Final = 5
STORED: Final = 6
JOINING_LOSS: Final = 7
LENGTH_FORCE: Final = 8


@cache
def service() -> int:
    """Address of the function that answers; compiled on first use, which is said."""
    say_compiling("service", "elastic contacts", "some 20 seconds")
    return int(import_module("gearidae.engine.elastic.service").answer.address)


_KINDS: Final = "iiaiidaddda"
"""What the service is asked with, see `_typed`: integers, arrays and real numbers."""


def _typed(
    typing: Any,
    address: Any,
    question: Any,
    d: Any,
    slot: Any,
    known: Any,
    t: Any,
    y: Any,
    gap: Any,
    rate: Any,
    length: Any,
    out: Any,
) -> Any:
    """Type of a question to the service, and the code that asks it: what it answers are two numbers."""
    for array in (d, y, out):
        if array.layout != "C":  # only its first number's address is handed over
            raise TypingError(f"the arrays must be contiguous, and {array} may not be")
    arguments = [
        {"i": types.int64, "d": types.float64, "a": given}[kind]
        for kind, given in zip(
            _KINDS, (address, question, d, slot, known, t, y, gap, rate, length, out), strict=True
        )
    ]

    def ask(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        real = ir.DoubleType()
        answers = cgutils.alloca_once(builder, ir.ArrayType(real, 2))  # type: ignore[no-untyped-call]
        handed = [
            context.make_array(given)(context, builder, value).data if kind == "a" else value
            for kind, given, value in zip(_KINDS, signature.args, values, strict=True)
        ]
        kind = ir.FunctionType(ir.VoidType(), [value.type for value in [*handed[1:], answers]])
        builder.call(builder.inttoptr(handed[0], kind.as_pointer()), [*handed[1:], answers])
        both = builder.load(answers)
        pair = [builder.extract_value(both, k) for k in range(2)]
        return context.make_tuple(builder, signature.return_type, pair)

    return types.UniTuple(types.float64, 2)(*arguments), ask  # type: ignore[no-untyped-call]


_ask: Any = intrinsic(_typed)


@compiled
def _address(d: Floats) -> int:
    """Where the service lies: behind the weights, which no checkpoint holds."""
    return int(d[int(d[at.WEIGHTS_AT]) + int(d[at.STATES])])


@compiled
def _of_pair(d: Floats, question: int, slot: int, y: Floats, gap: float) -> float:
    """Ask what goes with a pair's gap and deflections alone."""
    return _ask(_address(d), question, d, slot, 1, 0.0, y, gap, 0.0, 0.0, y)[0]


@compiled
def node_force(
    d: Floats, slot: int, known: bool, t: float, y: Floats, gap: float, rate: float, length: float
) -> tuple[float, float]:
    """See `gearidae.engine.elastic.nodes.node_force`."""
    return _ask(_address(d), FORCE, d, slot, known, t, y, gap, rate, length, y)


@compiled
def node_residual(d: Floats, y: Floats, out: Floats) -> None:
    """See `gearidae.engine.elastic.nodes.node_residual`."""
    _ask(_address(d), RESIDUAL, d, 0, 1, 0.0, y, 0.0, 0.0, 0.0, out)


@compiled
def node_rates(d: Floats, yp: Floats) -> None:
    """See `gearidae.engine.elastic.nodes.node_rates`."""
    _ask(_address(d), RATES, d, 0, 1, 0.0, yp, 0.0, 0.0, 0.0, yp)


@compiled
def meet_nodes(d: Floats, slot: int, y: Floats, gap: float) -> None:
    """See `gearidae.engine.elastic.nodes.meet_nodes`."""
    _of_pair(d, MEET, slot, y, gap)


@compiled
def follow_nodes(d: Floats, slot: int, y: Floats, gap: float) -> None:
    """See `gearidae.engine.elastic.nodes.follow_nodes`."""
    _of_pair(d, FOLLOW, slot, y, gap)


@compiled
def join_nodes(d: Floats, slot: int, y: Floats, gap: float) -> None:
    """See `gearidae.engine.elastic.nodes.join_nodes`."""
    _of_pair(d, JOIN, slot, y, gap)


@compiled
def nodes_stored(d: Floats, slot: int, t: float, y: Floats, gap: float, rate: float, length: float) -> float:
    """See `gearidae.engine.elastic.energy.nodes_stored`."""
    return _ask(_address(d), STORED, d, slot, 1, t, y, gap, rate, length, y)[0]


@compiled
def nodes_joining_loss(d: Floats, slot: int, y: Floats, gap: float) -> float:
    """See `gearidae.engine.elastic.energy.nodes_joining_loss`."""
    return _of_pair(d, JOINING_LOSS, slot, y, gap)


@compiled
def nodes_length_force(
    d: Floats, slot: int, t: float, y: Floats, gap: float, rate: float, length: float
) -> tuple[float, float]:
    """See `gearidae.engine.elastic.energy.nodes_length_force`."""
    return _ask(_address(d), LENGTH_FORCE, d, slot, 1, t, y, gap, rate, length, y)
