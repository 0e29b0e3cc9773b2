"""The runs of one sweep on their way through an executor."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future, as_completed
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from gearidae.archive.keep import Keep
from gearidae.archive.sample_table import SampleTable
from gearidae.archive.variables import VERDICT
from gearidae.archive.verdict import verdict_of
from gearidae.errors import SceneError
from gearidae.progress import SweepProgress
from gearidae.records import Solution
from gearidae.runs.kept_runs import KeptRuns
from gearidae.runs.running import solve, unsolved
from gearidae.runs.sweep_plan import SweepPlan

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.scene import Scene

__all__ = ["Batch", "Left", "solve_and_leave"]


@dataclass(frozen=True, slots=True)
class Left:
    """What a run leaves behind.

    Attributes
    ----------
    solution : Solution
        Without the parts that are not kept.
    verdict : str
        Its outcome in one word, if parts are not kept; empty if all are.
    impacts, flank_changes : int
        Contacts made, and how often contact went over to the other flank, likewise.
    """

    solution: Solution
    verdict: str = ""
    impacts: int = 0
    flank_changes: int = 0


def solve_and_leave(
    scene: Scene, backend: str, keep: Keep, on_progress: Callable[[float, int], None] | None = None
) -> Left:
    """Run a scene, judge it, and drop what is not kept, where it was run.

    Parameters
    ----------
    scene : Scene
    backend : str
        As for `gearidae.simulate`.
    keep : Keep
    on_progress : callable, optional
        As for `gearidae.runs.running.solve`.

    Returns
    -------
    Left
    """
    return leave(scene, solve(scene, backend, on_progress), keep)


def leave(scene: Scene, solution: Solution, keep: Keep) -> Left:
    """Judge a run and drop what is not kept of it."""
    if keep.names is None:
        return Left(solution)
    return Left(keep.thinned(solution), *verdict_of(scene, solution))


class Batch:
    """The runs of one sweep.

    Parameters
    ----------
    plan : SweepPlan
    backend : str
        As for `gearidae.simulate`.
    report : callable
        Told how many runs are done and how many there are.
    kept : KeptRuns or None
        Where finished runs are kept until all are.
    keep : Keep
        What each run leaves behind.
    """

    def __init__(
        self,
        plan: SweepPlan,
        backend: str,
        report: SweepProgress,
        kept: KeptRuns | None,
        keep: Keep,
    ) -> None:
        self._plan = plan
        self._scenes = plan.scenes
        self._backend = backend
        self._report = report
        self._kept = kept
        self._keep = keep
        # samples go to where the dataset has them as soon as they are there: they are in memory once
        self._samples = SampleTable(keep.columns(plan.base), len(plan.scenes), plan.base.run.sample_count)
        self._done: dict[int, Left] = {}
        self._reached = [0.0] * len(plan.scenes)
        self._cancelled = threading.Event()

    @property
    def left(self) -> int:
        """Number of runs that are to be computed."""
        return len(self._scenes) - len(self._done)

    def take_kept(self, former: KeptRuns) -> None:
        """Read the runs that an unfinished sweep has kept."""
        for number, scene in enumerate(self._scenes):
            taken = former.take(scene)
            if taken is not None:
                solution, judged = taken
                self._store(number, Left(solution, **judged))
                self._reached[number] = 1.0
        self._report(sum(self._reached), len(self._scenes))

    def run(self, executor: Executor | None, *, in_process: bool) -> bool:
        """Compute all runs; return whether Ctrl-C ended it early."""
        try:
            if executor is None:
                for number in self._missing():
                    self._finish(number, self._outcome(number, partial(self._solve_here, number)))
            else:
                self._submit(executor, in_process=in_process)
        except KeyboardInterrupt:
            self._cancelled.set()
            return True
        return False

    def dataset(self) -> xr.Dataset:
        """Put what the runs have left behind into one dataset; runs that are missing were interrupted."""
        none = unsolved("interrupted", "the sweep was interrupted before this run was finished")
        missing = Left(none, "unfinished")
        found = [self._done.get(number, missing) for number in range(len(self._scenes))]
        ds = self._plan.stack([each.solution for each in found], keep=self._keep, samples=self._samples)
        if self._keep.names is None:
            return ds
        dims = ds["status"].dims
        for name, variable in VERDICT.items():
            values = np.array([getattr(each, name) for each in found], dtype=variable.dtype)
            ds[name] = (dims, values.reshape(ds["status"].shape), variable.attributes)
        return ds

    def _missing(self) -> list[int]:
        return [number for number in range(len(self._scenes)) if number not in self._done]

    def _submit(self, executor: Executor, *, in_process: bool) -> None:
        futures: dict[Future[Left], int] = {}
        try:
            for number in self._missing():
                if in_process:
                    future = executor.submit(self._solve_here, number)
                else:
                    future = executor.submit(solve_and_leave, self._scenes[number], self._backend, self._keep)
                futures[future] = number
            for future in as_completed(list(futures)):
                number = futures[future]
                self._finish(number, self._outcome(number, future.result))
                del futures[
                    future
                ]  # which holds the run's samples; after it was stored, which Ctrl-C may prevent
        except BaseException:
            self._cancelled.set()
            for future, number in futures.items():
                if not future.cancel() and future.done() and future.exception() is None:
                    left = future.result()
                    if left.solution.status != "interrupted":
                        self._note(number, left)
            raise

    def _solve_here(self, number: int) -> Left:
        duration = self._scenes[number].run.duration

        def on_progress(time: float, events: int) -> None:
            if self._cancelled.is_set():
                raise KeyboardInterrupt  # the only way to end a thread's run is from inside
            self._reached[number] = time / duration
            self._report(sum(self._reached), len(self._scenes))

        return solve_and_leave(self._scenes[number], self._backend, self._keep, on_progress)

    def _finish(self, number: int, left: Left) -> None:
        if left.solution.status == "interrupted":
            raise KeyboardInterrupt
        self._note(number, left)
        self._reached[number] = 1.0
        self._report(sum(self._reached), len(self._scenes))

    def _note(self, number: int, left: Left) -> None:
        if number not in self._done:
            if self._kept is not None and left.solution.status == "finished":
                judged = {name: getattr(left, name) for name in VERDICT}
                self._kept.keep(self._scenes[number], left.solution, judged)
            self._store(number, left)

    def _store(self, number: int, left: Left) -> None:
        slim = self._samples.take(number, left.solution)
        self._done[number] = replace(left, solution=slim)

    def _outcome(self, number: int, result: Callable[[], Left]) -> Left:
        """Return a run's result; one that died with its worker (out of memory) must not take the others along."""
        try:
            return result()
        except SceneError:
            raise
        except Exception as error:
            return leave(
                self._scenes[number], unsolved("crashed", f"{type(error).__name__}: {error}"), self._keep
            )
