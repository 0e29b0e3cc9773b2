"""What an ensemble of the low-speed case costs beside its solver: processor time a run, memory, use of the cores.

Of members that share their surface, and with it the tables of the force law: in memory and into an archive, one run at
a time and several, and on a Dask cluster of as many processes on this machine::

    python -m gearidae_bench.ensemble_cost 3000 2

Each is begun once before it is measured: compiling, tables that are shared and imports (netCDF's writer imports Dask
where it is installed, half a second) are not of a run. Cores in use are of this machine: on a busy one only the
processor times mean something.

Two cores of a processor may be two threads of one: then the engine itself takes longer in each of them. What the
machine can do is measured by as many processes that share nothing, with a part of the members each.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

import xarray as xr

import gearidae as gd
from gearidae import engine
from gearidae_bench.long import peak_memory

__all__ = ["BEGUN", "VARY", "Cost", "Watch", "cost_row", "ensemble_cost", "same_runs", "wall_apart"]

VARY: Final = {"coating.sam_fraction": "uniform(0.5, 1)", "drive.torque": "normal(4.5e-18, 1e-19)"}
BEGUN: Final = 4
"""Members of the ensemble that is not measured, for each run at a time."""


@dataclass(frozen=True, slots=True)
class Cost:
    """Cost of one ensemble.

    Attributes
    ----------
    members : int
    wall : float
        Wall time [s].
    processor : float
        Processor time [s], that of a cluster's workers included.
    solving : float
        Processor time of the engine, its model included [s].
    peak : float
        Largest resident memory of the process so far [MB].
    """

    members: int
    wall: float
    processor: float
    solving: float
    peak: float

    @property
    def beside(self) -> float:
        """Processor time beside the engine, a run [s]."""
        return (self.processor - self.solving) / self.members

    @property
    def over_solver(self) -> float:
        """Processor time over that of the engine."""
        return self.processor / self.solving

    @property
    def cores(self) -> float:
        """Processor time over wall time: the number of cores in use."""
        return self.processor / self.wall


class Watch:
    """Counts the processor time of the engine in the threads of this process.

    Attributes
    ----------
    spent : float
        So far [s].
    """

    def __init__(self) -> None:
        self.spent, self._busy, self._inner = 0.0, threading.Lock(), engine.solve

    def begin(self) -> None:
        """Stand in the engine's place."""
        engine.solve = self._solve

    def end(self) -> None:
        """Give the place back."""
        engine.solve = self._inner

    def _solve(self, *arguments: Any, **settings: Any) -> Any:
        began = time.thread_time()
        try:
            return self._inner(*arguments, **settings)
        finally:
            with self._busy:
                self.spent += time.thread_time() - began


def ensemble_cost(
    scene: gd.Scene,
    members: int,
    jobs: int,
    archive: Path | None = None,
    *,
    executor: Executor | None = None,
    elsewhere: Callable[[], tuple[float, float]] = lambda: (0.0, 0.0),
) -> tuple[Cost, xr.Dataset]:
    """Measure one ensemble.

    Parameters
    ----------
    scene : Scene
    members, jobs : int
        Runs, and runs at a time.
    archive : Path, optional
        Where to write it, with its finished runs beside it meanwhile.
    executor : Executor, optional
        In place of threads of this process.
    elsewhere : callable, optional
        Processor time and solving time of the executor's processes so far [s].

    Returns
    -------
    Cost
    Dataset
        The ensemble.
    """
    settings: dict[str, Any] = {"jobs": jobs, "executor": executor, "archive": archive, "overwrite": True}
    gd.studies.ensemble(scene, VARY, BEGUN * jobs, **settings)
    used, solved = elsewhere()
    began, processor = time.perf_counter(), time.process_time()
    watch = Watch()
    watch.begin()
    try:
        ds = gd.studies.ensemble(scene, VARY, members, **settings)
    finally:
        watch.end()
    wall, processor_time = time.perf_counter() - began, time.process_time() - processor
    now_used, now_solved = elsewhere()
    solving = watch.spent + now_solved - solved
    return Cost(members, wall, processor_time + now_used - used, solving, 1e-6 * peak_memory()), ds


def wall_apart(scene: gd.Scene, members: int, processes: int, folder: Path) -> float:
    """Wall time [s] of an ensemble divided between processes that share nothing, each with one job and its archive."""
    with ProcessPoolExecutor(processes, multiprocessing.get_context("spawn")) as pool:
        parts = [
            pool.submit(_part, scene, members // processes, folder / f"part_{k}.nc") for k in range(processes)
        ]
        return max(part.result() for part in parts)


def _part(scene: gd.Scene, members: int, archive: Path) -> float:
    return ensemble_cost(scene, members, 1, archive)[0].wall


def same_runs(left: xr.Dataset, right: xr.Dataset) -> bool:
    """Whether two ensembles agree to the last bit in all but the times that their runs took."""
    timed = [name for name in ("wall_time",) if name in left]
    first, second = (ds.drop_vars(timed).drop_attrs(deep=False) for ds in (left, right))
    return bool(first.identical(second))


HEADINGS: Final = (
    " " * 27 + "members    wall s   engine ms/run   beside ms/run   over solver   cores   peak MB"
)
"""Of `cost_row`."""


def cost_row(name: str, cost: Cost) -> str:
    """Write a cost as a line of text, below `HEADINGS`.

    Parameters
    ----------
    name : str
    cost : Cost

    Returns
    -------
    str
    """
    engine = 1e3 * cost.solving / cost.members
    return (
        f"{name:26s} {cost.members:7d} {cost.wall:9.1f} {engine:15.2f} {1e3 * cost.beside:15.2f} "
        f"{cost.over_solver:13.3f} {cost.cores:7.2f} {cost.peak:9.0f}"
    )


def main(arguments: Sequence[str]) -> int:
    """Measure and print."""
    members = int(arguments[0]) if arguments else 1000
    jobs = int(arguments[1]) if len(arguments) > 1 else 2
    scene = gd.preset("teodorescu2009_low_speed")
    costs: dict[int, Cost] = {}
    _say(f"{os.cpu_count()} cores\n{HEADINGS}")
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "ensemble.nc"
        _say(cost_row(f"in memory, jobs {jobs}", ensemble_cost(scene, members, jobs)[0]))
        for number in sorted({1, jobs}):
            costs[number], local = ensemble_cost(scene, members, number, target)
            _say(cost_row(f"into an archive, jobs {number}", costs[number]))
        limit = wall_apart(scene, members, jobs, Path(folder))
        _say(
            f"{jobs} processes that share nothing: {limit:.1f} s, {costs[1].wall / (jobs * limit):.3f} of {jobs} cores"
        )
        _say(_efficiency(f"{jobs} threads", costs[1].wall / jobs, limit, costs[jobs].wall))
        if find_spec("distributed") is not None:
            from gearidae_bench.ensemble_on_dask import dask_cost

            there = dask_cost(scene, members, jobs, target)
            _say(cost_row(f"Dask, {jobs} workers", there.cost))
            _say(_efficiency(f"{jobs} Dask workers", costs[1].wall / jobs, limit, there.cost.wall))
            _say(
                f"the cluster takes {100.0 * there.idle:.1f} % of a core when idle; without that "
                f"{1e3 * there.beside:.2f} ms beside the engine a run"
            )
            _say(f"largest memory of a worker: {there.worker_peak:.0f} MB")
            _say(
                f"the cluster's runs are those of the threads to the last bit: {same_runs(local, there.runs)}"
            )
    return 0


def _efficiency(who: str, ideal: float, limit: float, wall: float) -> str:
    return f"efficiency of {who}: {ideal / wall:.3f}, {limit / wall:.3f} of what the machine can do"


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
