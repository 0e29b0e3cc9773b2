"""The drivers, each ready to run: loaded, compiled, and with the formulas that have passed the self-test here."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from functools import cache, partial
from importlib import import_module
from itertools import islice
from types import ModuleType

from gearidae.engine.beside import LOOP, compile_side_by_side
from gearidae.engine.compiling import FUNCTIONS, HOW_LONG, SOLVER, compiling, make_part_ready
from gearidae.engine.integrate.driver import Block
from gearidae.engine.setup.problem import Problem
from gearidae.records import Statistics

log = logging.getLogger(__name__)

ADAMS, BDF = "adams", "bdf"
"""Formulas: those of Adams, with IDA's own where they are better; IDA's own, iteration and root search throughout."""

COMPILING_TIME = 1e-3  # of the unit of time: how long a run is that is made to have everything compiled
COMPILING_BLOCKS = 3
"""Blocks after which that run is left, though asperities by the million may make it a long one."""

_solver_compiling = partial(compiling, SOLVER, HOW_LONG[SOLVER], FUNCTIONS[SOLVER])
"""Says so while the solver is compiled."""


@cache
def load_driver(backend: str) -> ModuleType:
    """Import a driver; late, as the native one compiles its callbacks when it is imported."""
    with _solver_compiling():
        driver = import_module(f"gearidae.engine.{'native' if backend == 'native' else 'portable'}")
        make_part_ready(SOLVER)  # what only drivers call has been declared now
        return driver


@cache
def native_formulas(method: str) -> str:
    """Formulas with which the native driver has passed the self-test; an empty string if there are none.

    What has failed is named in the log, once.

    Parameters
    ----------
    method : {"auto", "bdf"}
        ``run.method`` of the scene.
    """
    from gearidae.engine.self_test import (
        failure,
    )  # which runs the driver, and so cannot be loaded before it

    for way in (ADAMS, BDF) if method == "auto" else (BDF,):
        with _solver_compiling():
            compile_side_by_side((SOLVER, LOOP))
            failed = failure(way)
        if not failed:
            return way
        log.warning("the native driver fails its self-test with %s: %s", _NAMES[way], failed)
    return ""


_NAMES = {ADAMS: "Adams' formulas", BDF: "IDA's own formulas"}


def formulas(problem: Problem, backend: str) -> str:
    """Name the formulas that a run of this problem begins with, `ADAMS` or `BDF`.

    The portable driver leaves everything to IDA's own.
    """
    if backend != "native":
        return BDF
    return native_formulas(problem.method) or BDF


_ready: set[tuple[str, bool, bool]] = set()


def ready_driver(backend: str, problem: Problem) -> Callable[..., Iterator[Block]]:
    """Load a driver and have all that it needs for this kind of problem compiled, or read from disk, by a tiny run.

    Returns
    -------
    callable
        The driver's ``run``, see `gearidae.engine.native.run`.
    """
    run: Callable[..., Iterator[Block]] = load_driver(backend).run
    as_ida = backend == "native" and native_formulas(problem.method) != ADAMS
    if as_ida:
        run = partial(run, as_ida=True)
    kind = (backend, as_ida, bool(problem.model.scene.nodes > 0))
    if kind not in _ready:
        with compiling(f"the solver{' for elastic contacts' if kind[2] else ''}", "some seconds"):
            for _ in islice(run(problem.shortened(COMPILING_TIME), 1e-3, 2, Statistics()), COMPILING_BLOCKS):
                pass
        _ready.add(kind)
    return run
