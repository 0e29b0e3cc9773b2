"""What an ensemble costs on a Dask cluster of processes on this machine."""

from __future__ import annotations

import time
from importlib import import_module
from pathlib import Path
from typing import Any, Final

import numpy as np
import xarray as xr

import gearidae as gd
from gearidae_bench.ensemble_cost import BEGUN, VARY, Cost, Watch, ensemble_cost
from gearidae_bench.long import peak_memory

__all__ = ["dask_cost"]

_WATCH: Final = Watch()
"""Of this process, where it is a worker."""


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
    gd.studies.ensemble(scene, VARY, BEGUN, jobs=1)
    _WATCH.begin()


def _so_far() -> tuple[float, float]:
    """Processor time of a worker and of its engine so far [s]."""
    return time.process_time(), _WATCH.spent
