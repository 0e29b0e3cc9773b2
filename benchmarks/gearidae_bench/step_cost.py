"""What a step costs, by part: cycles of the processor, read at the beginning and the end of each part of a real run.

Before anything is compiled the functions of a step are put behind ones that read the processor's counter before and
after. Reading it takes time itself: how much is measured on a part that does nothing, and taken off. The parts are
kept apart, while otherwise the processor begins one before it has finished the other: what they take is scaled to a
step of a run as it is. A process of its own does this, with compiled code of its own. On x86-64.
"""

from __future__ import annotations

import inspect
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any, Final, NamedTuple

import numpy as np

from gearidae.engine.backend import run_blocks
from gearidae.engine.setup.build import make_problem
from gearidae.records import Block, Statistics
from gearidae.scene import preset

__all__ = ["PARTS", "Cost", "Part", "cost_table", "measure_cost"]


class Part(NamedTuple):
    """A part of a step.

    Attributes
    ----------
    label : str
        For the table.
    where, name : str
        Module below ``gearidae.engine`` that calls the function, and the function's name there.
    inside : str
        Label of the part that this one is part of; empty for the step itself.
    """

    label: str
    where: str
    name: str
    inside: str


_STEP, _NEWTON, _EVENTS = "IDA: attempts, tests, vectors, calls", "Newton's iteration", "epilogue of a step"
PARTS: Final = (
    Part(_STEP, "step", "propose", ""),
    Part(_NEWTON, "callbacks", "iterate", _STEP),
    Part("formula: prediction", "step.adams", "rates_at_end", _NEWTON),
    Part("residual and slopes", "integrate.correction", "motion", _NEWTON),
    Part("formula: error, order, next step", "step", "control_step", _NEWTON),
    Part("formula: differences kept", "step.adams", "store_step", _STEP),
    Part("guard function", "step", "evaluate_guard", ""),
    Part("states at roots", "integrate.roots", "state_at", ""),
    Part("samples", "step", "sample", ""),
    Part(_EVENTS, "step", "finish_step", ""),
    Part("histories", "step", "accept", _EVENTS),
    Part("events", "step", "switch", _EVENTS),
    Part("energy balance: adhesion", "step.adhesion_loss", "step", _EVENTS),
    Part("energy balance: works and losses", "step.balance", "step", _EVENTS),
    Part("extremes", "step.extremes", "step", _EVENTS),
    Part("choice of formulas", "step", "change_wanted", _EVENTS),
)
"""A part comes after the one that it is part of."""


class Cost(NamedTuple):
    """What one part costs.

    Attributes
    ----------
    label : str
    calls : float
        Per step.
    nanoseconds : float
        Per step, without the parts inside it.
    """

    label: str
    calls: float
    nanoseconds: float


def measure_cost(duration: float, rtol: float) -> tuple[list[Cost], float]:
    """Measure the high-speed preset at full coverage, without samples.

    Parameters
    ----------
    duration : float
        Simulated [s].
    rtol : float
        Relative tolerance.

    Returns
    -------
    costs : list of Cost
        Of `PARTS`, and of what is left.
    whole : float
        Processor time of a step of the run as it is [ns].
    """
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"NUMBA_CACHE_DIR": folder}
        program = f"from gearidae_bench.step_cost import _run; _run({duration!r}, {rtol!r})"
        done = subprocess.run(
            [sys.executable, "-c", program], env=environment, check=True, stdout=subprocess.PIPE, text=True
        )
    timing: dict[str, Any] = json.loads(done.stdout)
    whole = 1e9 * _timed_run(duration, rtol)
    return _costs(timing, whole), whole


def _costs(timing: dict[str, Any], whole: float) -> list[Cost]:
    """Net time of each part from the cycles between its readings, and of what is in no part."""
    steps, between, reading = timing["steps"], timing["between"], timing["reading"]
    calls = dict(zip((part.label for part in PARTS), timing["calls"], strict=True))
    gross = dict(zip((part.label for part in PARTS), timing["spent"], strict=True))
    net = {}
    for part in PARTS:
        inside = [other.label for other in PARTS if other.inside == part.label]
        # a part within takes its own time, and that of both readings
        lost = sum(gross[other] + calls[other] * (reading - between) for other in inside)
        net[part.label] = gross[part.label] - calls[part.label] * between - lost
    outer = [part.label for part in PARTS if not part.inside]
    left = timing["cycles"] - sum(gross[label] + calls[label] * (reading - between) for label in outer)
    scale = whole / (sum(net.values()) + left)
    costs = [Cost(part.label, calls[part.label] / steps, scale * net[part.label]) for part in PARTS]
    return [*costs, Cost("loop and root search", 1.0, scale * left)]


def cost_table(costs: list[Cost], whole: float) -> str:
    """Table in Markdown, with the physical limit: one evaluation of the residual in each step, and nothing else."""
    residual = next(cost for cost in costs if cost.label == "residual and slopes")
    rows = ["| part | calls per step | ns per step | share |", "|---|---:|---:|---:|"]
    rows += [
        f"| {cost.label} | {cost.calls:.2f} | {cost.nanoseconds:.0f} | {100 * cost.nanoseconds / whole:.0f} % |"
        for cost in costs
    ]
    limit = residual.nanoseconds / residual.calls
    rows += [
        f"| **a step** | | **{whole:.0f}** | 100 % |",
        f"| limit: one evaluation of the residual | 1 | {limit:.0f} | {100 * limit / whole:.0f} % |",
    ]
    return "\n".join(rows) + "\n"


def _timed_run(duration: float, rtol: float) -> float:
    """Processor time of a step [s], the least of three runs."""
    list(_blocks(0.1 * duration, rtol))  # all is loaded
    best = math.inf
    for _ in range(3):
        statistics = Statistics()
        started = time.process_time()
        list(_blocks(duration, rtol, statistics))
        best = min(best, (time.process_time() - started) / statistics.steps)
    return best


def _blocks(duration: float, rtol: float, statistics: Statistics | None = None) -> Iterator[Block]:
    """Run the scene of the table."""
    changes = {"run.duration": duration, "run.samples": "off", "contact.bodies": "rigid"}
    problem = make_problem(preset("teodorescu2009").replace(changes))
    return run_blocks(problem, rtol, 0, "native", statistics or Statistics())


# -- in a process of its own -----------------------------------------------------------------------------------------


def _run(duration: float, rtol: float) -> None:
    """Measure with the counters in place, and print what they show."""
    cells = np.zeros(2 * (len(PARTS) + 1), np.int64)
    read, add = _counter()
    for k, part in enumerate(PARTS):
        _put_behind(part, cells[2 * k :], read, add)
    blocks = _blocks(0.1 * duration, rtol)
    list(blocks)  # all is compiled
    cells[:] = 0
    statistics = Statistics()
    blocks, now = _blocks(duration, rtol, statistics), _compiled(_reader(read))
    start = now()
    list(blocks)
    cycles = now() - start
    between, reading = _overhead(cells[2 * len(PARTS) :], read, add)
    spent, calls = cells[: 2 * len(PARTS) : 2], cells[1 : 2 * len(PARTS) : 2]
    timing = {
        "steps": statistics.steps,
        "cycles": int(cycles),
        "between": between,
        "reading": reading,
        "spent": spent.tolist(),
        "calls": calls.tolist(),
    }
    sys.stdout.write(json.dumps(timing))


def _counter() -> tuple[Any, Any]:
    """Functions that read the processor's counter, and add what has passed since to the numbers at an address.

    All that has been begun is finished before the counter is read, and nothing is begun until it has been.
    """
    from llvmlite import ir
    from numba import types
    from numba.core.cgutils import get_or_insert_function
    from numba.extending import intrinsic

    word = ir.IntType(64)

    def cycles(builder: Any) -> Any:
        kind = ir.FunctionType(ir.VoidType(), [])
        fence = get_or_insert_function(builder.module, kind, "llvm.x86.sse2.lfence")  # type: ignore[no-untyped-call]
        counter = builder.module.declare_intrinsic("llvm.readcyclecounter", [], ir.FunctionType(word, []))
        builder.call(fence, [])
        now = builder.call(counter, [])
        builder.call(fence, [])
        return now

    def read(typing: Any) -> Any:
        def ask(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            return cycles(builder)

        return types.int64(), ask

    def add(typing: Any, address: Any, since: Any) -> Any:
        def ask(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            passed = builder.sub(cycles(builder), values[1])
            place = builder.inttoptr(values[0], word.as_pointer())
            for k, number in ((0, passed), (1, ir.Constant(word, 1))):
                cell = builder.gep(place, [ir.Constant(word, k)])
                builder.store(builder.add(builder.load(cell), number), cell)
            return values[0]

        return types.int64(types.int64, types.int64), ask

    return intrinsic(read), intrinsic(add)


def _behind(function: Any, names: list[str], place: int, read: Any, add: Any) -> Any:
    """Put a compiled function behind one that counts its cycles at an address."""
    arguments = ", ".join(names)
    source = (
        f"def counted({arguments}):\n    _since = _read()\n    _result = _function({arguments})\n"
        f"    _add({place}, _since)\n    return _result\n"
    )
    known: dict[str, Any] = {"_read": read, "_add": add, "_function": function}
    exec(source, known)
    return _compiled(known["counted"])


def _compiled(function: Callable[..., Any]) -> Any:
    """Compile a function as the engine's are, for this process alone, and put it into what calls it."""
    import numba

    from gearidae.compiled import numba_options

    options = {"_nrt": False, "forceinline": True}
    taken: dict[str, Any] = {name: value for name, value in options.items() if name in numba_options()}
    return numba.njit(nogil=True, error_model="numpy", **taken)(function)


def _put_behind(part: Part, cells: Any, read: Any, add: Any) -> None:
    *path, last = part.where.split(".")
    module: Any = import_module(".".join(["gearidae.engine", *path]))
    holder = getattr(module, last) if hasattr(module, last) else import_module(f"{module.__name__}.{last}")
    function = getattr(holder, part.name)
    names = list(inspect.signature(function.py_func).parameters)
    setattr(holder, part.name, _behind(function, names, int(cells.ctypes.data), read, add))


def _reader(read: Any) -> Any:
    def now():  # type: ignore[no-untyped-def]
        return read()

    return now


def _overhead(cells: Any, read: Any, add: Any) -> tuple[float, float]:
    """Cycles between two readings with nothing between them, and all that both readings take."""

    def nothing(x):  # type: ignore[no-untyped-def]
        return x + 1.0

    counted = _behind(_compiled(nothing), ["x"], int(cells.ctypes.data), read, add)

    def many(n):  # type: ignore[no-untyped-def]
        x, start = 0.0, read()
        for _ in range(n):
            x = counted(x)
        return read() - start, x

    count = 1_000_000
    total, _ = _compiled(many)(count)
    return float(cells[0]) / count, float(total) / count


def main() -> None:
    """Print the table for a hundredth of a second at high speed."""
    costs, whole = measure_cost(0.01, 1e-6)
    sys.stdout.write(cost_table(costs, whole))


if __name__ == "__main__":
    main()
