"""Run time against error: every contender on every scene, in interleaved rounds."""

from __future__ import annotations

import gc
import math
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.problem import Problem
from gearidae_bench.contender import Contender, Outcome, unused
from gearidae_bench.error import run_error
from gearidae_bench.reference import Reference, end_of, find_reference
from gearidae_bench.scenes import BenchScene

__all__ = ["Point", "Settings", "measure_scene"]

Floats = NDArray[np.float64]

SHORT: Final = 0.05
"""A run shorter than this [s] is run once untimed before each timed run."""


@dataclass(frozen=True, slots=True)
class Settings:
    """How much to measure.

    Attributes
    ----------
    rounds : int
        Rounds in which all runs of a scene take turns.
    longest : float
        A contender's ladder of tolerances ends with the first run that takes longer [s].
    share : float
        A run is repeated, round by round, until that much time is spent on it [s].
    every : int
        Take each so many-th tolerance of the ladders.
    """

    rounds: int = 5
    longest: float = 8.0
    share: float = 2.5
    every: int = 1


@dataclass(frozen=True, slots=True)
class Point:
    """One contender at one tolerance on one scene.

    Attributes
    ----------
    scene, contender : str
    tolerance : float
        Relative tolerance, or step length over tau.
    error : float
        See `gearidae_bench.error.run_error`; infinite where the run broke off.
    time, fastest, slowest : float
        Median, least and greatest run time [s] over `repeats` runs.
    repeats, steps, evaluations : int
    """

    scene: str
    contender: str
    tolerance: float
    error: float
    time: float
    fastest: float
    slowest: float
    repeats: int
    steps: int
    evaluations: int


@dataclass(slots=True)
class _Series:
    """What one contender did at one tolerance."""

    contender: Contender
    tolerance: float
    error: float
    outcome: Outcome
    times: list[float]


def measure_scene(
    bench: BenchScene,
    contenders: Sequence[Contender],
    settings: Settings,
    report: Callable[[str], object],
) -> tuple[Reference, list[Point], dict[str, float]]:
    """Measure all contenders on one scene.

    Parameters
    ----------
    bench : BenchScene
    contenders : sequence of Contender
        Those that can run here.
    settings : Settings
    report : callable
        Told in words what is being measured.

    Returns
    -------
    reference : Reference
    points : list of Point
    first_calls : dict
        Seconds of each contender's very first run, which compiles what is not yet in the cache; no point contains it.
    """
    report(f"{bench.title}: reference")
    reference = find_reference(bench)
    problem = make_problem(bench.scene)
    times = np.linspace(0.0, end_of(problem), bench.scene.run.sample_count)
    series: list[_Series] = []
    first_calls: dict[str, float] = {}
    for contender in contenders:
        report(f"{bench.title}: {contender.label}")
        ladder = contender.ladder[:: settings.every]
        first_calls[contender.key] = _timed(contender, problem, ladder[0], times)[0]
        for tolerance in ladder:
            seconds, outcome = _timed(contender, problem, tolerance, times)
            error = run_error(
                reference.speed, reference.position, outcome.speed, outcome.position, reference.length
            )
            if math.isinf(error):
                report(f"{bench.title}: {contender.label} broke off at {tolerance:.0e}")
            if seconds < SHORT:
                seconds, _ = _timed(contender, problem, tolerance, times)
            series.append(_Series(contender, tolerance, error, outcome, [seconds]))
            if seconds > settings.longest:
                break
    for number in range(1, settings.rounds):
        report(f"{bench.title}: round {number + 1} of {settings.rounds}")
        with _without_garbage_collection():
            _round(series, settings.share, problem, times)
    return reference, [_point(bench, entry) for entry in series], first_calls


def _round(series: Sequence[_Series], share: float, problem: Problem, times: Floats) -> None:
    """Let every run have its turn that has not yet had its share of time."""
    for entry in series:
        if math.fsum(entry.times) >= share:
            continue
        if entry.times[0] < SHORT:  # what ran before has filled the processor's caches with its own
            _timed(entry.contender, problem, entry.tolerance, times)
        entry.times.append(_timed(entry.contender, problem, entry.tolerance, times)[0])


def _timed(contender: Contender, problem: Problem, tolerance: float, times: Floats) -> tuple[float, Outcome]:
    """Run once, on a copy of the problem that the run may use up."""
    copy = unused(problem)
    started = time.perf_counter()
    outcome = contender.run(copy, tolerance, times)
    return time.perf_counter() - started, outcome


@contextmanager
def _without_garbage_collection() -> Iterator[None]:
    """Collect now rather than in the middle of somebody's run."""
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def _point(bench: BenchScene, entry: _Series) -> Point:
    return Point(
        bench.name,
        entry.contender.key,
        entry.tolerance,
        entry.error,
        statistics.median(entry.times),
        min(entry.times),
        max(entry.times),
        len(entry.times),
        entry.outcome.steps,
        entry.outcome.evaluations,
    )
