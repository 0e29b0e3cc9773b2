"""The runs of one sweep on their way through an executor."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future
from dataclasses import replace
from functools import partial
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gearidae.archive.output_selection import OutputSelection
from gearidae.archive.sample_table import SampleTable
from gearidae.archive.stack import stack
from gearidae.archive.train.stack import stack_trains
from gearidae.archive.variables import VERDICT
from gearidae.errors import SceneError
from gearidae.progress import SweepProgress
from gearidae.records import Solution
from gearidae.runs.run_cache import RunCache
from gearidae.runs.run_result import RunResult, crashed, solve_and_leave, solve_group
from gearidae.runs.running import nothing_of
from gearidae.runs.sweep_plan import SweepPlan
from gearidae.scene import is_long_train

if TYPE_CHECKING:
    import xarray as xr

_AHEAD: Final = 8
"""Runs that wait for each thread: all at once would take more memory than what they leave behind."""
_ALONE: Final = 16
"""Runs that are sent alone to other processes, before it is known how long they take."""
_TOGETHER: Final = 0.5
"""About how long runs that are sent together shall take [s]: what it costs to send them is little beside that."""
_MOST_TOGETHER: Final = 64


class Batch:
    """The runs of one sweep.

    Parameters
    ----------
    plan : SweepPlan
    backend : str
        As for `gearidae.simulate`.
    report : callable
        Called with the number of finished runs and the number of all runs.
    kept : RunCache or None
        Where finished runs are kept until all are.
    keep : OutputSelection
        What each run leaves behind.
    """

    def __init__(
        self,
        plan: SweepPlan,
        backend: str,
        report: SweepProgress,
        kept: RunCache | None,
        selection: OutputSelection,
    ) -> None:
        self._plan = plan
        self._scenes = plan.scenes
        self._backend = backend
        self._report = report
        self._kept = kept
        self._selection = selection
        # samples go to where the dataset has them as soon as they are there: they are in memory once
        self._of_trains = is_long_train(plan.base)
        columns = () if self._of_trains else selection.columns(plan.base)
        self._samples = SampleTable(columns, len(plan.scenes), plan.base.run.sample_count)
        self._done: dict[int, RunResult] = {}
        self._under_way: dict[int, float] = {}  # share that is done of the runs that have begun
        self._counting = threading.Lock()

    @property
    def left(self) -> int:
        """Number of runs that are to be computed."""
        return len(self._scenes) - len(self._done)

    def take_kept(self, former: RunCache) -> None:
        """Read the runs that an unfinished sweep has kept."""
        for number, scene in enumerate(self._scenes):
            taken = former.take(scene)
            if taken is not None:
                solution, judged = taken
                self._store(number, RunResult(solution, **judged))
        self._tell()

    def run(self, executor: Executor | None, *, threads: int = 0) -> None:
        """Compute all runs, or those until a `KeyboardInterrupt`.

        Parameters
        ----------
        executor : Executor or None
            None for one run after the other, here.
        threads : int, optional
            How many threads of this process the executor has; 0 if it is of other processes.
        """
        if executor is None:
            for number in self._missing():
                self._finish(number, self._outcome_here(number))
        else:
            self._submit(executor, threads)

    def dataset(self) -> xr.Dataset:
        """Put what the runs have left behind into one dataset; runs that are missing were interrupted."""
        none = nothing_of(
            self._plan.base, "interrupted", "the sweep was interrupted before this run was finished"
        )
        missing = RunResult(none, "unfinished")
        results = [self._done.get(number, missing) for number in range(len(self._scenes))]
        solutions: list[Any] = [result.solution for result in results]
        stacked: Callable[..., xr.Dataset] = (
            stack_trains if self._of_trains else partial(stack, samples=self._samples)
        )
        ds = stacked(
            self._plan.base, self._plan.axes, self._plan.scenes, solutions, selection=self._selection
        )
        if self._selection.names is None:
            return ds
        dims = ds["status"].dims
        for name, variable in VERDICT.items():
            values = np.array([getattr(result, name) for result in results], dtype=variable.dtype)
            ds[name] = (dims, values.reshape(ds["status"].shape), variable.attributes)
        return ds

    def _missing(self) -> list[int]:
        return [number for number in range(len(self._scenes)) if number not in self._done]

    def _submit(self, executor: Executor, threads: int) -> None:
        pending: dict[Future[list[RunResult]], Sequence[int]] = {}
        ended: SimpleQueue[Future[list[RunResult]]] = SimpleQueue()

        def submit(numbers: Sequence[int]) -> None:
            future = self._future(executor, numbers, in_process=threads > 0)
            pending[future] = numbers
            future.add_done_callback(ended.put)

        waiting = deque(self._missing())
        try:
            for _ in range(min(len(waiting), _AHEAD * threads or _ALONE)):
                submit([waiting.popleft()])
            while pending:
                future = ended.get()
                for number, left in self._outcomes(future, pending[future], submit):
                    self._finish(number, left)
                # only now: it holds the runs' samples, and Ctrl-C may have kept them from being stored
                del pending[future]
                if threads and waiting:
                    submit([waiting.popleft()])
                elif waiting and (size := self._group_size() or (0 if pending else 1)):
                    while waiting:
                        submit([waiting.popleft() for _ in range(min(size, len(waiting)))])
        except BaseException:
            for future, numbers in pending.items():
                if not future.cancel() and future.done() and future.exception() is None:
                    for number, left in zip(numbers, future.result(), strict=False):
                        if left.solution.status != "interrupted":
                            self._note(number, left)
            raise

    def _future(
        self, executor: Executor, numbers: Sequence[int], *, in_process: bool
    ) -> Future[list[RunResult]]:
        """Hand runs to an executor."""
        scenes = [self._scenes[number] for number in numbers]
        try:
            if in_process:
                return executor.submit(self._solve_here, *numbers)
            return executor.submit(solve_group, scenes, self._backend, self._selection)
        except BrokenExecutor as error:  # a process of it has died: none of its runs will be finished
            future: Future[list[RunResult]] = Future()
            future.set_exception(error)
            return future

    def _outcomes(
        self, future: Future[list[RunResult]], numbers: Sequence[int], submit: Callable[[Sequence[int]], None]
    ) -> list[tuple[int, RunResult]]:
        """Return what runs have left; those that were together when a worker died are begun again, each alone."""
        try:
            return list(zip(numbers, future.result(), strict=False))
        except SceneError:
            raise
        except Exception as error:
            if len(numbers) == 1:
                return [(numbers[0], crashed(self._scenes[numbers[0]], error, self._selection))]
            for number in numbers:
                submit([number])
            return []

    def _group_size(self) -> int:
        """How many runs to send together, by how long those took that are there; 0 if that is not known."""
        longest = max((result.solution.statistics.wall_time for result in self._done.values()), default=0.0)
        return min(max(int(_TOGETHER / longest), 1), _MOST_TOGETHER) if longest > 0.0 else 0

    def _solve_here(self, number: int) -> list[RunResult]:
        duration = self._scenes[number].run.duration

        def on_progress(time: float, events: int) -> None:
            with self._counting:
                self._under_way[number] = time / duration
            self._tell()

        return [solve_and_leave(self._scenes[number], self._backend, self._selection, on_progress)]

    def _outcome_here(self, number: int) -> RunResult:
        """Run a scene; one that dies (of memory that ran out) must not take the others along."""
        try:
            return self._solve_here(number)[0]
        except SceneError:
            raise
        except Exception as error:
            return crashed(self._scenes[number], error, self._selection)

    def _finish(self, number: int, left: RunResult) -> None:
        if left.solution.status == "interrupted":
            raise KeyboardInterrupt
        self._note(number, left)
        self._tell()

    def _tell(self) -> None:
        """Report how many runs are done, those under way in part."""
        with self._counting:
            done = len(self._done) + sum(self._under_way.values())
        self._report(done, len(self._scenes))

    def _note(self, number: int, left: RunResult) -> None:
        if number not in self._done:
            if self._kept is not None and left.solution.status == "finished":
                judged = {name: getattr(left, name) for name in VERDICT}
                self._kept.store(self._scenes[number], left.solution, judged)
            self._store(number, left)

    def _store(self, number: int, left: RunResult) -> None:
        if isinstance(left.solution, Solution):
            left = replace(left, solution=self._samples.take(number, left.solution))
        with self._counting:
            self._done[number] = left
            self._under_way.pop(number, None)
