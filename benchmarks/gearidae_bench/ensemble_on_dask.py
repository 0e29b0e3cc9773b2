"""What an ensemble costs on a Dask cluster of processes on this machine."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, Final

import numpy as np
import xarray as xr

import gearidae as gd
from gearidae_bench.ensemble_cost import BEGUN, VARY, Cost, Watch, ensemble_cost
from gearidae_bench.long import peak_memory

__all__ = ["DaskCost", "dask_cost"]

_LOOKED_AT: Final = 3.0
"""How long an idle cluster is looked at [s]."""
_WATCH: Final = Watch()
"""Of this process, where it is a worker."""


@dataclass(frozen=True, slots=True)
class DaskCost:
    """Cost of one ensemble on a cluster.

    Attributes
    ----------
    cost : Cost
        That of the workers, the scheduler and the client; the largest memory is that of the latter two, in one process.
    runs : Dataset
        The ensemble.
    worker_peak : float
        Largest resident memory of a worker [MB].
    idle : float
        Cores that the cluster takes when it has nothing to do, such as for its heartbeats.
    """

    cost: Cost
    runs: xr.Dataset
    worker_peak: float
    idle: float

    @property
    def beside(self) -> float:
        """Processor time beside the engine and what the cluster takes in any case, a run [s]."""
        return self.cost.beside - self.idle * self.cost.wall / self.cost.members


def dask_cost(scene: gd.Scene, members: int, workers: int, archive: Path) -> DaskCost:
    """Measure one ensemble on a Dask cluster of processes on this machine, each with one thread.

    Parameters
    ----------
    scene : Scene
    members, workers : int
    archive : Path
        Where to write the ensemble.

    Returns
    -------
    DaskCost
    """
    distributed: Any = import_module("distributed")
    with (
        distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):

        def elsewhere() -> tuple[float, float]:
            used, solved = np.sum(list(client.run(_so_far).values()), axis=0).tolist()
            return used, solved

        client.run(_begin, scene)
        idle = _idle(elsewhere)
        executor = client.get_executor()
        cost, ds = ensemble_cost(scene, members, workers, archive, executor=executor, elsewhere=elsewhere)
        peak = 1e-6 * max(client.run(peak_memory).values())
    return DaskCost(cost, ds, peak, idle)


def _idle(elsewhere: Callable[[], tuple[float, float]]) -> float:
    """Cores that this process and the workers take while nothing is asked of them."""
    began, used = time.perf_counter(), time.process_time() + elsewhere()[0]
    time.sleep(_LOOKED_AT)
    return (time.process_time() + elsewhere()[0] - used) / (time.perf_counter() - began)


def _begin(scene: gd.Scene) -> None:
    """Let a worker make what its runs share, and watch its engine."""
    gd.studies.ensemble(scene, VARY, BEGUN, jobs=1)
    _WATCH.begin()


def _so_far() -> tuple[float, float]:
    """Processor time of a worker and of its engine so far [s]."""
    return time.process_time(), _WATCH.spent
