"""Where the runs of a sweep are computed: here, in threads, in processes, or on a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
import signal
import socket
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from importlib import import_module
from typing import Any, TypeVar

from gearidae import __version__
from gearidae.errors import SceneError
from gearidae.runs.running import heed
from gearidae.scene.quantity import whole

Made = TypeVar("Made")

_PATIENCE = 10.0
"""How long to wait for a Dask scheduler to answer [s]."""


def check_jobs(jobs: int | None) -> int:
    """Return the number of runs at a time: `jobs`, or the number of usable cores.

    Raises
    ------
    SceneError
        If `jobs` is not a positive whole number.
    """
    return _cores() if jobs is None else whole("jobs", jobs, 1)


def check_executor(executor: object) -> None:
    """Make sure that something is an executor, as far as that can be seen.

    Parameters
    ----------
    executor : object
        What was given as executor, or None.

    Raises
    ------
    SceneError
        If it is not one; a Dask client is not, but has one.
    """
    if hasattr(executor, "get_executor"):
        raise SceneError(
            "executor", type(executor).__name__, "is a Dask client: pass its client.get_executor()"
        )
    if executor is not None and not callable(getattr(executor, "submit", None)):
        raise SceneError("executor", executor, "must be an executor, as those of concurrent.futures")


@contextmanager
def dask_executor(address: str | None) -> Iterator[Executor | None]:
    """Provide the executor of a Dask cluster, if one is wanted.

    Parameters
    ----------
    address : str or None
        Of the cluster's scheduler, ``tcp://host:8786``. Its workers need the same version of gearidae.

    Yields
    ------
    Executor or None
        None without an address. On leaving, the connection is closed, and runs that have not been finished are dropped.

    Raises
    ------
    SceneError
        If Dask is not installed, no scheduler answers at the address, or one of its workers lacks this version.
    """
    if address is None:
        yield None
        return
    try:
        distributed: Any = import_module("distributed")
    except ImportError:
        raise SceneError(
            "--dask", address, "needs Dask's scheduler: python -m pip install 'gearidae[dask]'"
        ) from None
    try:
        # a client that fails to connect can leave its event loop unusable for the next: look before
        comm = import_module("distributed.comm")
        resolved = comm.resolve_address(address)
        if resolved.startswith(("tcp://", "tls://")):
            socket.create_connection(comm.get_address_host_port(resolved), timeout=_PATIENCE).close()
        client = distributed.Client(address, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        reason = str(error) or type(error).__name__
        raise SceneError("--dask", address, f"no Dask scheduler answers there ({reason})") from error
    with client:
        _check_workers(client, address)
        yield client.get_executor()


def _check_workers(client: Any, address: str) -> None:
    """Refuse a cluster that cannot run our scenes, as its workers would not report that: the sweep would hang."""

    def version() -> str:  # inside another function, so that it is sent as it is and not by its name
        import gearidae

        return gearidae.__version__

    for worker, answer in client.run(version, on_error="return").items():
        if answer != __version__:
            installed = answer if isinstance(answer, str) else f"{type(answer).__name__}: {answer}"
            raise SceneError(
                "--dask", address, f"its worker {worker} needs gearidae {__version__}, and has: {installed}"
            )


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
        It is shut down on leaving; runs that have not begun are dropped. If an exception is the reason, such as
        Ctrl-C, runs under way end as well.
    """
    workers = min(jobs, runs)
    if workers <= 1:
        yield None
        return
    executor: Executor
    halted = threading.Event()
    if releases_gil:
        executor = ThreadPoolExecutor(
            workers, thread_name_prefix="gearidae", initializer=heed, initargs=(halted,)
        )
    else:
        context = multiprocessing.get_context("spawn")
        executor = ProcessPoolExecutor(workers, mp_context=context, initializer=_quiet_on_interrupt)
    try:
        yield executor
    except BaseException:
        halted.set()
        stop(executor)
        raise
    finally:
        executor.shutdown(wait=True, cancel_futures=True)


def stop(executor: Executor) -> None:
    """End the processes of an executor of ours at once, in the middle of their runs."""
    if isinstance(executor, ProcessPoolExecutor):
        for process in list((executor._processes or {}).values()):  # public only from Python 3.14 on
            process.terminate()


def side_by_side(
    executor: Executor | None, function: Callable[..., Made], *columns: Iterable[Any]
) -> Iterator[Made]:
    """Apply a function to rows of arguments, in an executor if there is one, and yield the results in their order.

    Parameters
    ----------
    *columns : iterable
        Values of each argument.

    Yields
    ------
    object
        What the function returns. Calls that have not begun are dropped as soon as one fails.
    """
    rows = zip(*columns, strict=True)
    if executor is None:
        for row in rows:
            yield function(*row)
        return
    futures = [executor.submit(function, *row) for row in rows]
    try:
        for future in futures:
            yield future.result()
    finally:
        for future in futures:
            future.cancel()


def _quiet_on_interrupt() -> None:
    """Let a worker end without a traceback when Ctrl-C reaches it too."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _cores() -> int:
    """Cores this process may use, which can be fewer than the machine has."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
