"""Run a scene with the driver that suits this machine, block by block."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiles
from gearidae.engine.changeover import change_over, extend_nodes, to_rigid
from gearidae.engine.collecting import Collector
from gearidae.engine.continuing import checkpoint_of_start, knots_at_start, problem_from
from gearidae.engine.drivers import formulas, load_driver, native_formulas, ready_driver
from gearidae.engine.integrate.driver import Block, Ending, SampleReader
from gearidae.engine.run_ends import Ended, OnBlock
from gearidae.engine.setup.problem import Problem
from gearidae.engine.setup.start import AT_ONCE, Start
from gearidae.engine.sundials.names import unavailable
from gearidae.errors import SceneError
from gearidae.records import (
    ROWS,
    EnergyBalance,
    Events,
    Extremes,
    Solution,
    Statistics,
    sample_times,
)
from gearidae.scene import Scene
from gearidae.scene.sampled import columns_of

__all__ = [
    "Ended",
    "choose_backend",
    "follow",
    "kept_at",
    "outlook",
    "run_blocks",
    "solve",
    "statistics_of",
]

log = logging.getLogger(__name__)


def choose_backend(backend: str, method: str) -> str:
    """Name the driver that will run.

    Parameters
    ----------
    backend : {"auto", "native", "sksundae"}
        ``auto`` takes the native driver where it works and passes its self-test, and logs why where it does not.
    method : {"auto", "bdf"}
        ``run.method`` of the scene.

    Raises
    ------
    SceneError
        If the native driver is requested and cannot work here, the name is unknown, or numba is set to compile
        nothing.
    """
    if not compiles():
        raise SceneError("NUMBA_DISABLE_JIT", 1, "must not be set: the solver runs compiled only")
    if backend not in ("auto", "native", "sksundae"):
        raise SceneError("backend", backend, "must be auto, native or sksundae")
    if backend == "sksundae":
        return backend
    reason = unavailable()
    if not reason:
        if native_formulas(method):
            return "native"
        reason = "it fails its self-test"
    if backend == "native":
        raise SceneError("backend", backend, f"cannot be used here: {reason}")
    log.warning("the native driver cannot be used here: %s; running through scikit-sundae instead", reason)
    return "sksundae"


def run_blocks(
    problem: Problem,
    rtol: float,
    samples: int,
    backend: str,
    statistics: Statistics,
    resume: NDArray[np.float64] | None = None,
    reader: SampleReader | None = None,
) -> Iterator[Block]:
    """Run a problem and yield its output block by block; `statistics` is filled in on the way.

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
    resume : ndarray, optional
        Checkpoint of an earlier run of the same problem with the same settings and backend, to resume from.
    reader : SampleReader, optional
        Reads the model at some of the samples.
    """
    driver = ready_driver(backend, problem)
    statistics.method = formulas(problem, backend)
    current = problem
    if resume is not None:
        problem.prepare(rtol, samples)  # by which checkpoints are judged
        current = problem.of_checkpoint(resume)
        current.prepare(rtol, samples)
    while True:
        if resume is not None:
            current, resume = _with_its_model(problem, current, resume)
        goes_on = False
        for block in driver(current, rtol, samples, statistics, resume, reader=reader):
            resume = block.checkpoint
            goes_on = resume is not None and _changes_model(problem, current, statistics.ending)
            if goes_on:  # that is no ending
                statistics.ending = Ending.FINISHED
            yield block
        if not goes_on:
            return


def _changes_model(problem: Problem, current: Problem, ending: Ending) -> bool:
    """Whether a run goes on with another contact model, or other nodes, where it has ended so."""
    if ending is Ending.TOO_DEEP:
        return current.deeper is not None
    return problem.elastic is not None and ending in (Ending.DEFLECTION, Ending.LIGHT)


def _with_its_model(
    problem: Problem, current: Problem, checkpoint: NDArray[np.float64]
) -> tuple[Problem, NDArray[np.float64]]:
    """Return the problem with the contact model that a checkpoint calls for, and a checkpoint of that problem.

    Parameters
    ----------
    problem, current : Problem
        Of the scene, and with the contact model that the checkpoint has.
    """
    here, beyond = current, current.outgrown(checkpoint)
    if beyond and current.elastic is not None:
        log.info(
            "the deflection of the bodies exceeds the asperity model's limit: continuing with the elastic model"
        )
        here = current.elastic()
        checkpoint = change_over(current, here, checkpoint)
    elif beyond and current.deeper is not None:
        here = current.deeper()
        checkpoint = extend_nodes(current, here, checkpoint)
    elif not beyond and current.depth > problem.depth == 0 and current.rigid_again(checkpoint):
        log.info("contacts have been light for long: continuing with the asperity model")
        here = problem
        checkpoint = to_rigid(current, here, checkpoint)
    if here.has_been_elastic(checkpoint):
        problem.skipped["elastic_deflection"] = 0
    return here, checkpoint


def follow(
    scene: Scene,
    take: Callable[[Block, Statistics, float], None],
    *,
    backend: str = "auto",
    on_progress: Callable[[float, int], None] | None = None,
    start: Start = AT_ONCE,
    on_block: OnBlock | None = None,
    reader: SampleReader | None = None,
) -> Ended:
    """Run a scene and hand every block of output to `take` as soon as it is there.

    Parameters
    ----------
    take : callable
        Called with a block, the solver's counters and the wall time in the solver [s] at its end.
    backend : {"auto", "native", "sksundae"}, optional
    on_progress : callable, optional
        Called now and then with the simulated time reached [s] and the number of events so far.
    start : Start, optional
        Where the run begins, or is resumed; by default it begins at time 0.
    on_block : callable, optional
        Called with every block of output, after `take`; True ends the run there, with the status ``stopped``.
    reader : SampleReader, optional
        Reads the model at some of the samples.

    Returns
    -------
    Ended
        Also after Ctrl-C: what had been taken by then is sound.

    Raises
    ------
    SceneError
        If the scene is beyond what the engine can do.
    """
    name = choose_backend(backend, scene.run.method)
    statistics, seen = replace(start.statistics), start.events
    reached = start.time if start.checkpoint is None else start.reached
    status = message = ""
    balance: EnergyBalance | None = None
    extremes: Extremes | None = None
    checkpoint: NDArray[np.float64] | None = None
    skipped: dict[str, int] = {}
    started = time.perf_counter()
    try:
        load_driver(name)
        problem = problem_from(scene, start)
        ready_driver(name, problem)
        skipped = problem.skipped  # which a change to another contact model changes
        started = time.perf_counter()
        resume, at_start = start.checkpoint, Events.no_table()
        if resume is None and start.scene is not None:
            resume = checkpoint_of_start(scene, start)
            at_start = knots_at_start(problem)
        run = scene.run
        for block in run_blocks(problem, run.rtol, run.sample_count, name, statistics, resume, reader):
            if len(at_start):
                block.events, at_start = np.concatenate([at_start, block.events]), Events.no_table()
            take(block, statistics, start.wall_time + time.perf_counter() - started)
            reached = block.time
            balance, extremes = block.balance or balance, block.extremes or extremes
            seen += len(block.events)
            checkpoint = block.checkpoint
            if on_progress is not None:
                on_progress(reached, seen)
            if on_block is not None and on_block(block) is True:
                statistics.ending = Ending.STOPPED
                break
        status, message = statistics.ending.status, statistics.message
    except KeyboardInterrupt:
        status, message = "interrupted", "interrupted by the user"
    wall_time = start.wall_time + time.perf_counter() - started
    counted = statistics_of(statistics, wall_time, name, skipped)
    return Ended(counted, status, message, reached, balance, extremes, checkpoint)


def statistics_of(
    statistics: Statistics, wall_time: float, backend: str, skipped: dict[str, int]
) -> Statistics:
    """Turn a run's counters into what is kept of them."""
    skipped = skipped | {"flight_steps": statistics.flight_steps}
    return replace(statistics, wall_time=wall_time, backend=backend, skipped=skipped)


def solve(
    scene: Scene,
    *,
    rtol: float | None = None,
    t_end: float | None = None,
    samples: int | str | None = None,
    backend: str = "auto",
    on_progress: Callable[[float, int], None] | None = None,
    start: Start = AT_ONCE,
    on_block: OnBlock | None = None,
) -> Solution:
    """Run a scene and collect all of it.

    Parameters
    ----------
    rtol, t_end, samples : optional
        In place of ``run.rtol`` [1], ``run.duration`` [s] and ``run.samples``.
    backend : {"auto", "native", "sksundae"}, optional
    on_progress : callable, optional
        Called now and then with the simulated time reached [s] and the number of events so far.
    start : Start, optional
        Where the run begins, from `end_of` of the run that it goes on from.
    on_block : callable, optional
        As for `follow`.

    Returns
    -------
    Solution
        Whatever was reached, with a status that says how the run ended; also after Ctrl-C.

    Raises
    ------
    SceneError
        If the scene is beyond what the engine can do.
    """
    arguments = {"run.rtol": rtol, "run.duration": t_end, "run.samples": samples}
    changes = {key: value for key, value in arguments.items() if value is not None}
    scene = scene.replace(changes) if changes else scene
    columns = columns_of(scene)
    rows = [np.empty((0, len(columns)))]
    collectors = {kind.field: Collector(kind) for kind in ROWS}

    def take(block: Block, statistics: Statistics, wall_time: float) -> None:
        rows.append(block.rows)
        for field, collector in collectors.items():
            collector.add(getattr(block, field))

    ended = follow(scene, take, backend=backend, on_progress=on_progress, start=start, on_block=on_block)
    table = np.concatenate(rows)
    left: dict[str, Any] = {field: collector.rows() for field, collector in collectors.items()}
    return Solution(
        time=sample_times(start.time, scene.run.duration, scene.run.sample_count)[: len(table)],
        samples={column: np.ascontiguousarray(table[:, i]) for i, column in enumerate(columns)},
        statistics=ended.statistics,
        status=ended.status,
        message=ended.message,
        reached=ended.end_time,
        balance=ended.balance,
        extremes=ended.extremes,
        start=start.time,
        checkpoint=ended.checkpoint,
        **left,
    )


def outlook(
    scene: Scene,
    backend: str,
    checkpoint: NDArray[np.float64] | None = None,
    start: Start = AT_ONCE,
) -> tuple[dict[str, int], str]:
    """What can be said of a run without running it.

    Parameters
    ----------
    backend : {"native", "sksundae"}
    checkpoint : ndarray, optional
        Where the run is to go on.
    start : Start, optional
        Where the run begins.

    Returns
    -------
    skipped : dict
        What the run did not need until then, by name.
    method : str
        The formulas that the run begins with, see `Statistics`.

    Raises
    ------
    SceneError
        If the scene is beyond what the engine can do.
    """
    problem = problem_from(scene, start)
    if checkpoint is not None and problem.of_checkpoint(checkpoint).has_been_elastic(checkpoint):
        problem.skipped["elastic_deflection"] = 0
    return problem.skipped, formulas(problem, backend)


def kept_at(
    scene: Scene, checkpoint: NDArray[np.float64], start: Start = AT_ONCE
) -> tuple[EnergyBalance | None, Extremes | None]:
    """Return the energy balance and the extremes at a checkpoint of a run.

    Parameters
    ----------
    checkpoint : ndarray
        From a `Block` of a run of this scene.
    start : Start, optional
        Where the run began.

    Raises
    ------
    SceneError
        If the checkpoint is not of this scene.
    """
    problem = problem_from(scene, start).of_checkpoint(checkpoint)
    problem.prepare(scene.run.rtol, scene.run.sample_count)
    time, state = problem.restored(checkpoint)
    return problem.kept(time, state, np.zeros_like(state))
