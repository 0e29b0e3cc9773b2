"""Many runs of one scene with some of its keys varied, as one labelled dataset."""

from __future__ import annotations

import itertools
import os
import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor, Future, as_completed
from functools import partial
from typing import TYPE_CHECKING, Any

from gearidae.archive import check_target, combine, save
from gearidae.errors import SceneError
from gearidae.executors import check_jobs, own_executor, stop
from gearidae.progress import SweepProgress, sweep_progress
from gearidae.records import Solution
from gearidae.running import prepare, runs_in_threads, solve, unsolved

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.scene import Scene

__all__ = ["sweep"]

_ONE_TIME_AXIS = ("run.duration", "run.samples")


def sweep(
    scene: Scene,
    over: Mapping[str, Iterable[Any]],
    executor: Executor | None = None,
    *,
    rtol: float | None = None,
    t_end: float | None = None,
    samples: int | None = None,
    backend: str = "auto",
    progress: bool | SweepProgress = False,
    archive: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    jobs: int | None = None,
) -> xr.Dataset:
    """Run a scene for every combination of some keys' values.

    Parameters
    ----------
    scene : Scene
        What the runs have in common.
    over : mapping of str to iterable
        Values of each swept key of the scene; numbers in SI units or strings with a unit, as in a case file.
        ``run.duration`` and ``run.samples`` cannot be swept, because all runs share one time axis.
    executor : concurrent.futures.Executor, optional
        Where to compute the runs: any executor, also of a cluster. By default threads, as many as `jobs`,
        when the solver runs outside Python's lock (backend ``native``); the others one after the other, or in
        `jobs` processes if `jobs` is given (the script that calls it then needs ``if __name__ ==
        "__main__":``).
    rtol, t_end, samples, backend, archive, overwrite
        As for `simulate`, for every run.
    progress : bool or callable, optional
        True for a progress bar on a terminal, or a function that is told the number of runs done (with
        fractions for those under way, where they can be seen) and the number of runs.
    jobs : int, optional
        Runs at a time; by default the number of usable cores. Ignored if `executor` is given.

    Returns
    -------
    xarray.Dataset
        As from `simulate`, with a dimension for each swept key in front of ``time``, named by the key's last
        part (``sam_fraction``). Events lie on one flat ``event`` dimension, labelled by
        ``event_<dimension>``. A run that could not go on says so in its ``status`` and is NaN from there on;
        the others are not affected.

    Raises
    ------
    SceneError
        If a key, a value or a setting is not allowed or the archive cannot be written; nothing has been run
        then.
    KeyboardInterrupt
        On Ctrl-C, after `archive` has been written with the runs that were finished.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> ds = gd.sweep(scene, {"coating.sam_fraction": [1.0, 0.5, 0.47]})  # doctest: +SKIP
    >>> ds.gear_speed.sel(sam_fraction=0.5).min()  # doctest: +SKIP
    """
    base = prepare(scene, rtol=rtol, t_end=t_end, samples=samples, backend=backend)
    swept, scenes = _derive(base, _listed(over))
    workers = check_jobs(jobs)
    if archive is not None:
        check_target(archive, overwrite=overwrite)
    releases_gil = runs_in_threads(backend)
    if not releases_gil and jobs is None:
        workers = 1
    with sweep_progress(progress, len(scenes)) as report:
        batch = _Batch(scenes, backend, report)
        if executor is not None:
            interrupted = batch.run(executor, in_process=False)
        else:
            with own_executor(workers, len(scenes), releases_gil=releases_gil) as own:
                interrupted = batch.run(own, in_process=releases_gil)
                if interrupted and own is not None:
                    stop(own)
    ds = combine(base, swept, scenes, batch.solutions())
    if archive is not None:
        save(ds, archive, overwrite=overwrite)
    if interrupted:
        raise KeyboardInterrupt(
            *([] if archive is None else [f"the finished runs are in {os.fspath(archive)}"])
        )
    return ds


class _Batch:
    """The runs of one sweep on their way through an executor."""

    def __init__(self, scenes: Sequence[Scene], backend: str, report: SweepProgress) -> None:
        self._scenes = scenes
        self._backend = backend
        self._report = report
        self._done: dict[int, Solution] = {}
        self._reached = [0.0] * len(scenes)
        self._cancelled = threading.Event()

    def run(self, executor: Executor | None, *, in_process: bool) -> bool:
        """Compute all runs; return whether Ctrl-C ended it early."""
        try:
            if executor is None:
                for number in range(len(self._scenes)):
                    self._finish(number, _outcome(partial(self._solve_here, number)))
            else:
                self._submit(executor, in_process=in_process)
        except KeyboardInterrupt:
            self._cancelled.set()
            return True
        return False

    def solutions(self) -> list[Solution]:
        """Solutions in the order of the scenes."""
        missing = unsolved("interrupted", "the sweep was interrupted before this run was finished")
        return [self._done.get(number, missing) for number in range(len(self._scenes))]

    def _submit(self, executor: Executor, *, in_process: bool) -> None:
        futures: dict[Future[Solution], int] = {}
        try:
            for number, scene in enumerate(self._scenes):
                if in_process:
                    future = executor.submit(self._solve_here, number)
                else:
                    future = executor.submit(solve, scene, self._backend)
                futures[future] = number
            for future in as_completed(futures):
                self._finish(futures[future], _outcome(future.result))
        except BaseException:
            self._cancelled.set()
            for future, number in futures.items():
                if not future.cancel() and future.done() and future.exception() is None:
                    self._done.setdefault(number, future.result())
            raise

    def _solve_here(self, number: int) -> Solution:
        duration = self._scenes[number].run.duration

        def on_progress(time: float, events: int) -> None:
            if self._cancelled.is_set():
                raise KeyboardInterrupt  # the only way to end a thread's run is from inside
            self._reached[number] = time / duration
            self._report(sum(self._reached), len(self._scenes))

        return solve(self._scenes[number], self._backend, on_progress)

    def _finish(self, number: int, solution: Solution) -> None:
        if solution.status == "interrupted":
            raise KeyboardInterrupt
        self._done[number] = solution
        self._reached[number] = 1.0
        self._report(sum(self._reached), len(self._scenes))


def _outcome(result: Callable[[], Solution]) -> Solution:
    """Return a run's result; one that died with its worker (out of memory) must not take the others along."""
    try:
        return result()
    except SceneError:
        raise
    except Exception as error:
        return unsolved("crashed", f"{type(error).__name__}: {error}")


def _listed(over: Mapping[str, Iterable[Any]]) -> dict[str, list[Any]]:
    """Values of each swept key as a list that is not empty."""
    if not isinstance(over, Mapping) or not over:
        raise SceneError(
            "over", over, 'must be a table of keys and their values, {"coating.sam_fraction": [1, 0.5]}'
        )
    listed: dict[str, list[Any]] = {}
    for key, values in over.items():
        if key in _ONE_TIME_AXIS:
            raise SceneError(key, values, "cannot be swept, because all runs share one time axis")
        if isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable):
            raise SceneError(key, values, "must be a list of values to sweep over")
        # numpy's scalars become plain numbers, which is what scenes are made of
        listed[key] = [value.item() if hasattr(value, "item") else value for value in values]
        if not listed[key]:
            raise SceneError(key, "[]", "must be a list of at least one value")
    return listed


def _derive(base: Scene, over: dict[str, list[Any]]) -> tuple[dict[str, list[Any]], list[Scene]]:
    """Every scene of the sweep, and the swept values as those scenes hold them (SI)."""
    scenes = [
        base.replace(dict(zip(over, values, strict=True))) for values in itertools.product(*over.values())
    ]
    swept: dict[str, list[Any]] = {}
    stride = len(scenes)
    for key, values in over.items():
        stride //= len(values)
        swept[key] = [_held(scenes[index * stride], key) for index in range(len(values))]
        for index, value in enumerate(swept[key]):
            if value in swept[key][:index]:
                raise SceneError(key, over[key][index], "stands twice in the list of values")
    return swept, scenes


def _held(scene: Scene, key: str) -> Any:
    """Value of a dotted key in SI units, as plain data."""
    value: Any = scene.to_dict()
    for part in key.split("."):
        if isinstance(value, list) and not part.isdigit():
            value = value[0]  # a list of one may go without its number
        value = value[int(part)] if isinstance(value, list) else value.get(part)
    return value
