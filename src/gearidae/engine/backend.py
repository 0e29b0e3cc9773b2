"""Run a scene with the driver that suits this machine, block by block."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from functools import cache
from importlib import import_module
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import cache_folder
from gearidae.engine.problem import Problem, make_problem
from gearidae.engine.run import Block, Tally
from gearidae.engine.sundials import unavailable
from gearidae.errors import SceneError
from gearidae.records import Events, Solution, Statistics
from gearidae.scene import Scene, preset

__all__ = ["choose_backend", "ready_driver", "run_blocks", "solve"]

log = logging.getLogger(__name__)


def choose_backend(backend: str = "auto") -> str:
    """Name the driver that will run.

    Parameters
    ----------
    backend : {"auto", "native", "sksundae"}
        ``auto`` takes the native driver where it works, and logs why where it does not.

    Raises
    ------
    SceneError
        If the native driver is asked for and cannot work here, or the name is unknown.
    """
    if backend not in ("auto", "native", "sksundae"):
        raise SceneError("backend", backend, "must be auto, native or sksundae")
    if backend == "sksundae":
        return backend
    reason = unavailable()
    if not reason:
        return "native"
    if backend == "native":
        raise SceneError("backend", backend, f"cannot be used here: {reason}")
    log.warning("the native driver cannot be used here: %s; running through scikit-sundae instead", reason)
    return "sksundae"


@cache
def ready_driver(backend: str) -> ModuleType:
    """Import a driver and have all of it compiled, or read from disk, by a run of one step.

    The first time on a machine this takes some 20 seconds, which is said.
    """
    if not any(cache_folder().rglob("*.nbi")):
        log.warning("compiling the solver for this machine: once, some 20 seconds")
    # imported late: the native driver compiles its callbacks when it is imported
    driver = import_module(f"gearidae.engine.{'native' if backend == 'native' else 'portable'}")
    tiny = make_problem(preset("roller_slow").replace({"run.duration": 1e-9}))
    for _ in driver.run(tiny, 1e-3, 2, Tally()):
        pass
    return driver


def run_blocks(
    problem: Problem,
    rtol: float,
    samples: int,
    backend: str,
    tally: Tally,
    resume: NDArray[np.float64] | None = None,
) -> Iterator[Block]:
    """Run a problem and hand out its output block by block; `tally` is filled in on the way.

    Parameters
    ----------
    problem : Problem
        From `make_problem`; used up by the run.
    rtol : float
        Relative tolerance.
    samples : int
        Number of samples, ends included.
    backend : {"native", "sksundae"}
        From `choose_backend`.
    tally : Tally
    resume : ndarray, optional
        Checkpoint of an earlier run of the same problem with the same settings and backend, to go on from.
    """
    blocks: Iterator[Block] = ready_driver(backend).run(problem, rtol, samples, tally, resume)
    return blocks


def solve(
    scene: Scene,
    *,
    rtol: float | None = None,
    t_end: float | None = None,
    samples: int | None = None,
    backend: str = "auto",
    on_progress: Callable[[float, int], None] | None = None,
) -> Solution:
    """Run a scene and collect all of it.

    Parameters
    ----------
    scene : Scene
    rtol, t_end, samples : optional
        In place of ``run.rtol`` [1], ``run.duration`` [s] and ``run.samples``.
    backend : {"auto", "native", "sksundae"}, optional
    on_progress : callable, optional
        Called now and then with the simulated time reached [s] and the number of events so far.

    Returns
    -------
    Solution
        Whatever was reached, with a status that says how the run ended.

    Raises
    ------
    SceneError
        If the scene is beyond what the engine can do.
    """
    given = {"run.rtol": rtol, "run.duration": t_end, "run.samples": samples}
    changes = {key: value for key, value in given.items() if value is not None}
    scene = scene.replace(changes) if changes else scene
    name = choose_backend(backend)
    ready_driver(name)
    problem = make_problem(scene)
    tally, rows, events, seen = Tally(), [], [], 0
    started = time.perf_counter()
    for block in run_blocks(problem, scene.run.rtol, scene.run.samples, name, tally):
        rows.append(block.rows)
        events.append(block.events)
        seen += len(block.events)
        if on_progress is not None:
            on_progress(block.time, seen)
    wall_time = time.perf_counter() - started
    table = np.concatenate(rows) if rows else np.empty((0, len(problem.columns)))
    times = np.linspace(0.0, scene.run.duration, scene.run.samples)[: len(table)]
    return Solution(
        time=times,
        samples={column: np.ascontiguousarray(table[:, i]) for i, column in enumerate(problem.columns)},
        events=_events(np.concatenate(events) if events else np.empty((0, 5))),
        statistics=Statistics(
            steps=tally.steps,
            residual_evaluations=tally.residual_evaluations,
            jacobian_evaluations=tally.jacobian_evaluations,
            error_test_failures=tally.error_test_failures,
            convergence_failures=tally.convergence_failures,
            restarts=tally.restarts,
            guard_evaluations=tally.guard_evaluations,
            wall_time=wall_time,
            backend=name,
            skipped=problem.skipped | {"flight_steps": tally.flight_steps},
        ),
        status=tally.ending.status,
        message=tally.ending.message,
    )


def _events(table: NDArray[np.float64]) -> Events:
    return Events(
        time=np.ascontiguousarray(table[:, 0]),
        kind=table[:, 1].astype(np.int8),
        pair=table[:, 2].astype(np.int64),
        flank=table[:, 3].astype(np.int8),
        gap_rate=np.ascontiguousarray(table[:, 4]),
    )
