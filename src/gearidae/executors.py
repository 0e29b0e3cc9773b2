"""Where the runs of a sweep are computed: here, in threads, or in processes."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager

from gearidae.errors import SceneError

__all__ = ["check_jobs", "own_executor", "stop"]


def check_jobs(jobs: int | None) -> int:
    """Return the number of runs at a time: `jobs`, or the number of usable cores.

    Parameters
    ----------
    jobs : int or None

    Returns
    -------
    int

    Raises
    ------
    SceneError
        If `jobs` is not a positive whole number.
    """
    if jobs is None:
        return _cores()
    if not isinstance(jobs, int) or isinstance(jobs, bool) or jobs < 1:
        raise SceneError("jobs", jobs, "must be a whole number, 1 or more")
    return jobs


@contextmanager
def own_executor(jobs: int, runs: int, *, releases_gil: bool) -> Iterator[Executor | None]:
    """Provide the executor that suits the solver, or None where runs are best computed one by one here.

    Parameters
    ----------
    jobs : int
        Runs at a time.
    runs : int
        Runs altogether.
    releases_gil : bool
        Whether the solver runs outside Python's lock: threads then share one compiled solver and cost nothing
        to start. Otherwise each job is a process of its own, started afresh ("spawn": a forked one would
        inherit locks held by the threads of numba and HDF5).

    Yields
    ------
    Executor or None
        It is shut down on leaving; runs that have not begun are dropped.
    """
    workers = min(jobs, runs)
    if workers == 1:
        yield None
        return
    executor: Executor
    if releases_gil:
        executor = ThreadPoolExecutor(workers, thread_name_prefix="gearidae")
    else:
        context = multiprocessing.get_context("spawn")
        executor = ProcessPoolExecutor(workers, mp_context=context, initializer=_quiet_on_interrupt)
    try:
        yield executor
    finally:
        executor.shutdown(wait=True, cancel_futures=True)


def stop(executor: Executor) -> None:
    """End the processes of an executor of ours at once, in the middle of their runs."""
    if isinstance(executor, ProcessPoolExecutor):
        for process in list((executor._processes or {}).values()):  # public only from Python 3.14 on
            process.terminate()


def _quiet_on_interrupt() -> None:
    """Let a worker end without a traceback when Ctrl-C reaches it too."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _cores() -> int:
    """Cores this process may use, which can be fewer than the machine has."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
