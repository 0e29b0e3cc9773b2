"""The nodes of an elastic contact as the rest of the engine calls them: at an address.

What `gearidae.engine.elastic.nodes` and `gearidae.engine.elastic.energy` do is a third of all that there is to
compile, and is
needed by a scene of elastic contacts only. Called as compiled functions call each other, it would be compiled into
every one of its callers besides, for every scene. So it is compiled on its own
(`gearidae.engine.elastic.service`), when
a scene first needs it, and called at the address where this process has it,
which is in the work space and which no file can set. The functions here have the names and
arguments of those that they call.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import Any, Final, NamedTuple

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.extending import intrinsic

from gearidae.compiled import compiled
from gearidae.engine.compiling import compiling
from gearidae.engine.model.state import Floats, Model

__all__ = [
    "FINISH",
    "FOLLOW",
    "FORCE",
    "INIT",
    "JOIN",
    "JOINING_LOSS",
    "LENGTH_FORCE",
    "MATERIAL_ENERGY",
    "MATERIAL_LOSS",
    "NUMBER",
    "PREDICT",
    "QUESTION",
    "RATES",
    "RESIDUAL",
    "SETTLE",
    "STORED",
    "follow_nodes",
    "init_nodes",
    "join_nodes",
    "node_force",
    "node_rates",
    "node_residual",
    "nodes_joining_loss",
    "nodes_length_force",
    "nodes_material_energy",
    "nodes_material_loss",
    "nodes_number",
    "nodes_stored",
    "pair_deflections",
    "service",
    "settle_pair",
]

FORCE: Final = 0  # what is asked for
RESIDUAL: Final = 1
RATES: Final = 2
INIT: Final = 3
FOLLOW: Final = 4
JOIN: Final = 5
STORED: Final = 6
JOINING_LOSS: Final = 7
LENGTH_FORCE: Final = 8
NUMBER: Final = 9
MATERIAL_ENERGY: Final = 10
MATERIAL_LOSS: Final = 11
SETTLE: Final = 12
FINISH: Final = 13
PREDICT: Final = 14


@cache
def service() -> int:
    """Address of the function that answers; compiled on first use, which is said."""
    with compiling("elastic contacts", "some 20 seconds"):
        return int(import_module("gearidae.engine.elastic.service").answer.address)


QUESTION: Final = (*(types.int64,) * 3, *(types.float64,) * 4)
"""Types of a question's numbers."""


class Question(NamedTuple):
    """What the service is asked, and what with."""

    kind: int
    history: int
    known: int
    t: float
    gap: float
    rate: float
    length: float


def _typed(typing: Any, address: Any, m: Any, question: Any, y: Any, out: Any) -> Any:
    """Type of a question to the service, and the code that asks it: what it answers are two numbers.

    Handed over are the records of the model, its arrays with their lengths, the question's numbers, and the state and
    the vector to be filled with their lengths.
    """
    arrays = (*m.types[3:], y, out)
    for array in arrays:
        if array.layout != "C":  # only its first number's address is handed over
            raise TypingError(f"the arrays must be contiguous, and {array} may not be")

    def ask(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        real = ir.DoubleType()
        answers = cgutils.alloca_once(builder, ir.ArrayType(real, 2))  # type: ignore[no-untyped-call]
        parts = [builder.extract_value(values[1], k) for k in range(5)]
        handed = parts[:3]
        for kind, value in zip(arrays, [*parts[3:], *values[3:]], strict=True):
            array = context.make_array(kind)(context, builder, value)
            handed += [array.data, array.nitems]
        handed += [
            context.cast(builder, builder.extract_value(values[2], k), given, wanted)
            for k, (given, wanted) in enumerate(zip(signature.args[2].types, QUESTION, strict=True))
        ]
        kind = ir.FunctionType(ir.VoidType(), [value.type for value in [*handed, answers]])
        builder.call(builder.inttoptr(values[0], kind.as_pointer()), [*handed, answers])
        both = builder.load(answers)
        pair = [builder.extract_value(both, k) for k in range(2)]
        return context.make_tuple(builder, signature.return_type, pair)

    return types.UniTuple(types.float64, 2)(types.int64, m, question, y, out), ask  # type: ignore[no-untyped-call]


_ask: Any = intrinsic(_typed)


@compiled
def _of_pair(m: Model, kind: int, k: int, y: Floats, gap: float) -> float:
    """Ask what goes with a pair's gap and deflections alone."""
    return _ask(m.work.elastic_service, m, Question(kind, k, 1, 0.0, gap, 0.0, 0.0), y, y)[0]


@compiled
def node_force(
    m: Model, k: int, known: bool, t: float, y: Floats, gap: float, rate: float, length: float
) -> tuple[float, float]:
    """See `gearidae.engine.elastic.nodes.node_force`."""
    question = Question(FORCE, k, int(known), t, gap, rate, length)
    return _ask(m.work.elastic_service, m, question, y, y)


@compiled
def settle_pair(
    m: Model, k: int, known: bool, t: float, y: Floats, gap: float, rate: float, length: float
) -> tuple[float, float]:
    """See `gearidae.engine.elastic.elimination.settle_pair`."""
    question = Question(SETTLE, k, int(known), t, gap, rate, length)
    return _ask(m.work.elastic_service, m, question, y, y)


@compiled
def pair_deflections(
    m: Model, kind: int, k: int, known: bool, t: float, y: Floats, gap: float, rate: float
) -> None:
    """Do what `kind` says with a pair's deflections, at the contact length that its history has.

    `SETTLE`, `PREDICT` or `FINISH`; see `gearidae.engine.elastic.elimination`.
    """
    length = m.state.history[k].length
    _ask(m.work.elastic_service, m, Question(kind, k, int(known), t, gap, rate, length), y, y)


@compiled
def node_residual(m: Model, y: Floats, out: Floats) -> None:
    """See `gearidae.engine.elastic.nodes.node_residual`."""
    _ask(m.work.elastic_service, m, Question(RESIDUAL, 0, 1, 0.0, 0.0, 0.0, 0.0), y, out)


@compiled
def node_rates(m: Model, yp: Floats) -> None:
    """See `gearidae.engine.elastic.nodes.node_rates`."""
    _ask(m.work.elastic_service, m, Question(RATES, 0, 1, 0.0, 0.0, 0.0, 0.0), yp, yp)


@compiled
def init_nodes(m: Model, k: int, y: Floats, gap: float) -> None:
    """See `gearidae.engine.elastic.histories.init_nodes`."""
    _of_pair(m, INIT, k, y, gap)


@compiled
def follow_nodes(m: Model, k: int, y: Floats, gap: float) -> None:
    """See `gearidae.engine.elastic.histories.follow_nodes`."""
    _of_pair(m, FOLLOW, k, y, gap)


@compiled
def join_nodes(m: Model, k: int, y: Floats, gap: float) -> None:
    """See `gearidae.engine.elastic.histories.join_nodes`."""
    _of_pair(m, JOIN, k, y, gap)


@compiled
def nodes_stored(m: Model, k: int, t: float, y: Floats, gap: float, rate: float, length: float) -> float:
    """See `gearidae.engine.elastic.energy.nodes_stored`."""
    return _ask(m.work.elastic_service, m, Question(STORED, k, 1, t, gap, rate, length), y, y)[0]


@compiled
def nodes_joining_loss(m: Model, k: int, y: Floats, gap: float) -> float:
    """See `gearidae.engine.elastic.energy.nodes_joining_loss`."""
    return _of_pair(m, JOINING_LOSS, k, y, gap)


@compiled
def nodes_length_force(
    m: Model, k: int, t: float, y: Floats, gap: float, rate: float, length: float
) -> tuple[float, float]:
    """See `gearidae.engine.elastic.energy.nodes_length_force`."""
    return _ask(m.work.elastic_service, m, Question(LENGTH_FORCE, k, 1, t, gap, rate, length), y, y)


@compiled
def nodes_number(m: Model, k: int, y: Floats, gap: float, material: int) -> float:
    """See `gearidae.engine.elastic.energy.nodes_number`; the material is asked for in the place of a flag."""
    return _ask(m.work.elastic_service, m, Question(NUMBER, k, material, 0.0, gap, 0.0, 0.0), y, y)[0]


@compiled
def nodes_material_energy(
    m: Model, k: int, y: Floats, gap: float, rate: float, material: int
) -> tuple[float, float]:
    """See `gearidae.engine.elastic.energy.nodes_material_energy`; the material is asked for as above."""
    question = Question(MATERIAL_ENERGY, k, material, 0.0, gap, rate, 0.0)
    return _ask(m.work.elastic_service, m, question, y, y)


@compiled
def nodes_material_loss(m: Model, k: int, y: Floats, gap: float, material: int) -> float:
    """See `gearidae.engine.elastic.energy.nodes_material_loss`; the material is asked for as above."""
    return _ask(m.work.elastic_service, m, Question(MATERIAL_LOSS, k, material, 0.0, gap, 0.0, 0.0), y, y)[0]
