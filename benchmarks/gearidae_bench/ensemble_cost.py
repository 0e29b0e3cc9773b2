"""What an ensemble of the low-speed case costs beside its solver: processor time a run, memory, use of the cores.

Of members that share their surface, and with it the tables of the force law: in memory and into an archive, one run at
a time and several, and on a Dask cluster of as many processes on this machine::

    python -m gearidae_bench.ensemble_cost 3000 2

Each is begun once before it is measured: compiling, tables that are shared and imports (netCDF's writer imports Dask
where it is installed, half a second) are not of a run. Cores in use are of this machine: on a busy one only the
processor times mean something.
"""

from __future__ import annotations

import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

import numpy as np
import xarray as xr

import gearidae as gd
from gearidae import engine
from gearidae_bench.long import peak_memory

__all__ = ["Cost", "cost_table", "dask_cost", "ensemble_cost", "same_runs"]

VARY: Final = {"coating.sam_fraction": "uniform(0.5, 1)", "drive.torque": "normal(4.5e-18, 1e-19)"}
_BEGUN: Final = 4
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


class _Watch:
    """Counts the processor time of the engine in the threads of this process."""

    def __init__(self) -> None:
        self.spent, self._busy, self._inner = 0.0, threading.Lock(), engine.solve

    def __call__(self, *arguments: Any, **settings: Any) -> Any:
        began = time.thread_time()
        try:
            return self._inner(*arguments, **settings)
        finally:
            with self._busy:
                self.spent += time.thread_time() - began

    def __enter__(self) -> _Watch:
        engine.solve = self
        return self

    def __exit__(self, *_: object) -> None:
        engine.solve = self._inner


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
    gd.studies.ensemble(scene, VARY, _BEGUN * jobs, **settings)
    used, solved = elsewhere()
    began, processor = time.perf_counter(), time.process_time()
    with _Watch() as watch:
        ds = gd.studies.ensemble(scene, VARY, members, **settings)
    wall, own = time.perf_counter() - began, time.process_time() - processor
    now_used, now_solved = elsewhere()
    solving = watch.spent + now_solved - solved
    return Cost(members, wall, own + now_used - used, solving, 1e-6 * peak_memory()), ds


def dask_cost(
    scene: gd.Scene, members: int, workers: int, archive: Path
) -> tuple[Cost, xr.Dataset, list[float]]:
    """Measure one ensemble on a Dask cluster of processes on this machine, each with one thread.

    Returns
    -------
    Cost
        With the largest resident memory of this process, which holds the scheduler too.
    Dataset
        The ensemble.
    list of float
        Largest resident memory of each worker [MB].
    """
    distributed: Any = import_module("distributed")
    with (
        distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):
        client.run(_begin, scene)
        cost, ds = ensemble_cost(
            scene,
            members,
            workers,
            archive,
            executor=client.get_executor(),
            elsewhere=lambda: tuple(np.sum(list(client.run(_so_far).values()), axis=0).tolist()),
        )
        peaks = [1e-6 * peak for peak in client.run(peak_memory).values()]
    return cost, ds, peaks


def _begin(scene: gd.Scene) -> None:
    """Let a worker make what its runs share, and watch its engine."""
    from gearidae_bench import ensemble_cost

    gd.studies.ensemble(scene, VARY, _BEGUN, jobs=1)
    ensemble_cost._Watch().__enter__()


def _so_far() -> tuple[float, float]:
    """Processor time of a worker and of its engine so far [s]."""
    from gearidae import engine

    return time.process_time(), float(engine.solve.spent)  # type: ignore[attr-defined]


def same_runs(one: xr.Dataset, other: xr.Dataset) -> bool:
    """Whether two ensembles agree to the last bit in all but the times that their runs took."""
    timed = [name for name in ("wall_time",) if name in one]
    first, second = (each.drop_vars(timed).drop_attrs(deep=False) for each in (one, other))
    return bool(first.identical(second))


def cost_table(costs: dict[str, Cost]) -> str:
    """Write costs as lines of text.

    Parameters
    ----------
    costs : dict of str to Cost

    Returns
    -------
    str
    """
    lines = [
        "                           members    wall s   engine ms/run   beside ms/run   over solver   cores   peak MB"
    ]
    for name, each in costs.items():
        engine = 1e3 * each.solving / each.members
        lines.append(
            f"{name:26s} {each.members:7d} {each.wall:9.1f} {engine:15.2f} {1e3 * each.beside:15.2f} "
            f"{each.over_solver:13.3f} {each.cores:7.2f} {each.peak:9.0f}"
        )
    return "\n".join(lines)


def main(arguments: Sequence[str]) -> int:
    """Measure and print."""
    members = int(arguments[0]) if arguments else 1000
    jobs = int(arguments[1]) if len(arguments) > 1 else 2
    scene = gd.preset("teodorescu2009_low_speed")
    costs: dict[str, Cost] = {}
    words = [f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} at the start"]
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "ensemble.nc"
        costs[f"in memory, jobs {jobs}"], _ = ensemble_cost(scene, members, jobs)
        for number in sorted({1, jobs}):
            name = f"into an archive, jobs {number}"
            costs[name], local = ensemble_cost(scene, members, number, target)
        alone, together = costs["into an archive, jobs 1"], costs[f"into an archive, jobs {jobs}"]
        words.append(f"efficiency of {jobs} threads: {alone.wall / (jobs * together.wall):.3f}")
        if find_spec("distributed") is not None:
            name = f"Dask, {jobs} workers"
            costs[name], remote, peaks = dask_cost(scene, members, jobs, target)
            words += [
                f"efficiency of {jobs} Dask workers: {alone.wall / (jobs * costs[name].wall):.3f}",
                f"largest memory of a worker: {max(peaks):.0f} MB",
                f"the cluster's runs are those of the threads to the last bit: {same_runs(local, remote)}",
            ]
    sys.stdout.write("\n".join([cost_table(costs), *words, ""]))
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
