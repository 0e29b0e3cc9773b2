"""Other costs than the time of one run: growth with length, memory, elastic bodies, two cores, start-up."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Final

from gearidae.engine.backend import choose_backend, run_blocks
from gearidae.engine.setup.build import make_problem
from gearidae.records import Statistics as Statistics
from gearidae.scene import Scene
from gearidae_bench.scenes import SCENES

__all__ = ["Growth", "Start", "measure_elastic", "measure_growth", "measure_start", "measure_sweep"]

STRETCHES: Final = (1, 2, 4, 8)
SAMPLES_PER_STRETCH: Final = 20_000
SECOND_SAMPLES: Final = 100_001


@dataclass(frozen=True, slots=True)
class Growth:
    """A run of some stretch of simulated time with the native driver, its blocks dropped as they come.

    Attributes
    ----------
    simulated, time : float
        Simulated and run time [s], the latter a median.
    steps : int
    memory : int
        Most bytes allocated through Python while running.
    """

    simulated: float
    time: float
    steps: int
    memory: int


@dataclass(frozen=True, slots=True)
class Start:
    """Seconds of a new process: importing gearidae, and from there to the end of a short run.

    Attributes
    ----------
    cold_import, cold_run : float
        With an empty cache of compiled code: once per machine and version.
    warm_import, warm_run : float
        Of every later process.
    """

    cold_import: float
    cold_run: float
    warm_import: float
    warm_run: float


def _drain(scene: Scene) -> int:
    statistics = Statistics()
    backend = choose_backend("auto", "auto")
    for _ in run_blocks(make_problem(scene), scene.run.rtol, scene.run.sample_count, backend, statistics):
        pass
    return statistics.steps


def _timed(work: Callable[[], object], repeats: int) -> float:
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        work()
        times.append(time.perf_counter() - started)
    return statistics.median(times)


def measure_growth(name: str = "high_sam") -> list[Growth]:
    """Run 1, 2, 4 and 8 stretches of a scene, at a constant rate of samples, and once a whole second of it."""
    scene = SCENES[name].scene
    results = []
    for stretches in STRETCHES:
        longer = scene.replace(
            {
                "run.duration": stretches * scene.run.duration,
                "run.samples": stretches * SAMPLES_PER_STRETCH + 1,
            }
        )
        steps = _drain(longer)
        seconds = _timed(lambda longer=longer: _drain(longer), 5)  # type: ignore[misc]
        tracemalloc.start()
        _drain(longer)
        memory = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        results.append(Growth(longer.run.duration, seconds, steps, memory))
    second = scene.replace({"run.duration": 1.0, "run.samples": SECOND_SAMPLES})
    tracemalloc.start()
    started = time.perf_counter()
    steps = _drain(second)
    results.append(Growth(1.0, time.perf_counter() - started, steps, tracemalloc.get_traced_memory()[1]))
    tracemalloc.stop()
    return results


def measure_elastic(name: str = "high_sam", repeats: int = 5) -> dict[str, float]:
    """Time of a run with the elastic contact over that with the asperity model, by SAM fraction; medians."""
    ratios = {}
    for fraction in (1.0, 0.5, 0.0):
        scene = SCENES[name].scene.replace({"coating.sam_fraction": fraction})
        times: dict[str, list[float]] = {"rigid": [], "elastic": []}
        for bodies in times:
            _drain(scene.replace({"contact.bodies": bodies}))
        for _ in range(repeats):
            for bodies, durations in times.items():
                run = scene.replace({"contact.bodies": bodies})
                durations.append(_timed(lambda run=run: _drain(run), 1))  # type: ignore[misc]
        ratios[f"{fraction:g}"] = statistics.median(times["elastic"]) / statistics.median(times["rigid"])
    return ratios


def measure_sweep(runs: int = 8, repeats: int = 5) -> float:
    """Efficiency of two threads on a sweep: time of one over twice the time of two, medians of alternating runs.

    Returns
    -------
    float
        1 is perfect; NaN where fewer than two cores are usable.
    """
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if cores < 2:
        return float("nan")
    base = SCENES["high_sam"].scene.replace({"run.duration": 2e-3})
    scenes = [base.replace({"coating.sam_fraction": 1.0 - 0.01 * k}) for k in range(runs)]

    def sweep(workers: int) -> None:
        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(_drain, scenes))

    sweep(2)
    single, double = [], []
    for _ in range(repeats):
        single.append(_timed(lambda: sweep(1), 1))
        double.append(_timed(lambda: sweep(2), 1))
    return statistics.median(single) / (2.0 * statistics.median(double))


_START = """
import time
begin = time.perf_counter()
import gearidae
imported = time.perf_counter()
gearidae.simulate(gearidae.preset("teodorescu2009").replace({"run.duration": 1e-5, "run.samples": 101}))
print(imported - begin, time.perf_counter() - imported)
"""


def measure_start(*, cold: bool = True) -> Start:
    """Time two new processes, the first with an empty cache of compiled code.

    Parameters
    ----------
    cold : bool, optional
        Whether to measure the first one at all (it compiles for some tens of seconds); NaN if not.
    """
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "NUMBA_CACHE_DIR": folder} if cold else dict(os.environ)
        first = _start(environment)
        second = [_start(environment) for _ in range(3)]
    if not cold:
        first = (float("nan"), float("nan"))
    return Start(*first, *(statistics.median(values) for values in zip(*second, strict=True)))


def _start(environment: dict[str, str]) -> tuple[float, float]:
    command = [sys.executable, "-c", _START]
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    imported, run = done.stdout.split()
    return float(imported), float(run)
