"""How the runs of a sweep or a study are computed and kept until its archive is written, so that it can be resumed."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, TypedDict, TypeVar, cast

import xarray as xr

from gearidae.archive import open_archive, save
from gearidae.archive.provenance import SCENE_DIGEST, provenance
from gearidae.archive.target import check_target, claims_output
from gearidae.errors import Interrupted, SceneError
from gearidae.progress import sweep_progress
from gearidae.runs.executors import check_executor, check_jobs, own_executor, side_by_side
from gearidae.runs.run_cache import RunCache
from gearidae.runs.running import SomeScene, prepare, with_samples

if TYPE_CHECKING:
    from gearidae.progress import SweepProgress
    from gearidae.records.train_results import AnySolution
    from gearidae.scene import Scene


class Store(Protocol):
    """Results that are kept beside an archive until it is written."""

    path: Path

    def count(self) -> int:
        """Count the results."""

    def remove(self, scenes: Sequence[Scene] | None = None, /) -> None:
        """Delete those of some scenes, or all."""

    def close(self) -> None:
        """Leave them as they are."""


SideBySide: TypeAlias = Callable[..., Iterator[tuple["AnySolution", str]]]
Kept = TypeVar("Kept", bound=Store)
Solved = TypeVar("Solved", bound="AnySolution")


class RunOptions(TypedDict, total=False):
    """Keyword arguments of every study, as those of `gearidae.sweep`: where its runs are computed and kept."""

    executor: Executor | None
    jobs: int | None
    backend: str
    progress: bool | SweepProgress
    archive: str | os.PathLike[str] | None
    overwrite: bool
    resume: bool


@dataclass(frozen=True, slots=True)
class Execution:
    """How runs are computed and kept: the `RunOptions`, and the formulas of the solver.

    Raises
    ------
    SceneError
        If a setting is not allowed: before anything is run.
    """

    executor: Executor | None = None
    jobs: int | None = None
    backend: str = "auto"
    progress: bool | SweepProgress = True
    archive: str | os.PathLike[str] | None = None
    overwrite: bool = False
    resume: bool = False
    method: str = "auto"
    """Formulas of the solver, as the scenes have them: not every driver has all."""
    compress: bool = True

    def __post_init__(self) -> None:
        check_jobs(self.jobs)
        check_executor(self.executor)

    @property
    def driver(self) -> str:
        """Driver of the solver that computes the runs."""
        from gearidae.engine import choose_backend  # what reads results does without the engine

        return choose_backend(self.backend, self.method)

    def threads(self) -> int:
        """Return how many threads of this process compute at most; 0 if processes do, or somebody else's executor."""
        return check_jobs(self.jobs) if self.executor is None and self.driver == "native" else 0

    def words(self, scenes: Sequence[Scene]) -> str:
        """Say how long runs will take on the cores that compute them; nothing where somebody else's executor does."""
        if self.executor is not None or not scenes:
            return ""
        from gearidae.runs.run_time import time_in_words  # what reads results does without estimates

        return time_in_words(scenes, len(scenes), self.threads() or self.jobs)

    @contextmanager
    def computing(self, calls: int) -> Iterator[Executor | None]:
        """Provide the executor that was given, or one that suits the solver; None to compute here.

        Parameters
        ----------
        calls : int
            At most.
        """
        if self.executor is not None:
            yield self.executor
            return
        # processes take seconds to start: only on request
        workers = self.threads() or (1 if self.jobs is None else self.jobs)
        with own_executor(workers, calls, releases_gil=self.threads() > 0) as executor:
            yield executor

    @contextmanager
    def side_by_side(
        self, kept: RunCache | None, usual: int, at_a_time: int | None = None
    ) -> Iterator[SideBySide]:
        """Provide `solutions` for a study that usually has so many runs: with this driver, and its progress shown."""
        done = itertools.count(1)
        with (
            sweep_progress(self.progress, usual) as report,
            self.computing(at_a_time or usual) as executor,
        ):

            def run(
                function: Any, scenes: Sequence[Scene], *arguments: Any
            ) -> Iterator[tuple[AnySolution, str]]:
                for solved in solutions(kept, executor, function, scenes, *arguments, self.backend):
                    yield solved
                    report(float(min(next(done), usual)), usual)  # of what has been taken in

            yield run


def prepared(
    scene: SomeScene, options: RunOptions, *, samples: int | str | None = None, trains: bool = False
) -> tuple[SomeScene, Execution]:
    """Check the scene and the options of a study, before anything is run; `samples` are in place of the scene's.

    `trains` says whether it runs trains of several meshes, too.
    """
    backend = options.get("backend", "auto")
    base = with_samples(prepare(scene, rtol=None, samples=samples, backend=backend, trains=trains))
    return base, Execution(**options, method=base.run.method)


def run_kept(
    execution: Execution,
    make_store: Callable[[Path], Kept],
    work: Callable[[Kept | None], xr.Dataset],
    about: Mapping[str, Any],
    *,
    read: Callable[[Path], xr.Dataset] | None = None,
    scenes: Sequence[Scene] | None = None,
    so_far: Callable[[], xr.Dataset] = xr.Dataset,
    prepared: Callable[[xr.Dataset], xr.Dataset] | None = None,
) -> xr.Dataset:
    """Compute something of many runs, which are kept until its archive is written.

    Parameters
    ----------
    make_store : callable
        Makes what keeps the results beside an archive.
    work : callable
        Computes the dataset, given the store; None without an archive.
    about : mapping of str to str
        What the result depends on: attributes of the dataset. An archive that has others is not resumed; an empty text
        stands for an attribute that is not there.
    read : callable, optional
        Reads a file that is there, to be resumed; by default as an archive of runs.
    scenes : sequence of Scene, optional
        Of the runs; results of others are warned of, and left where they are. By default all are of this study.
    so_far : callable, optional
        Makes the dataset of the finished part at Ctrl-C, where `work` raises a plain `KeyboardInterrupt`.
    prepared : callable, optional
        Makes the saved form of the dataset, also of the part at Ctrl-C, which otherwise is not saved.

    Returns
    -------
    Dataset
        Of an archive that is whole, its content.

    Raises
    ------
    SceneError
        If the archive cannot be written, or is of something else.
    Interrupted
        On Ctrl-C.
    """
    attributes = {name: value for name, value in about.items() if value != ""}
    if execution.archive is None:
        if execution.resume:
            raise SceneError("resume", True, "needs an archive: finished runs are kept beside it")
        with interruptible(None, so_far, attributes):
            return work(None).assign_attrs(attributes)
    with claims_output(execution.archive) as target, closing(make_store(target)) as store:
        _begin(execution, store, scenes)
        if execution.resume and not store.count() and target.exists():
            whole = _whole(target, about, execution.driver, read or open_archive)
            if whole is not None:
                return whole

        def keep(ds: xr.Dataset) -> xr.Dataset:
            made = ds if prepared is None else prepared(ds)
            if made.sizes:
                overwrite = execution.overwrite or execution.resume
                save(made, target, overwrite=overwrite, compress=execution.compress)
            return ds

        def cut_off(ds: xr.Dataset) -> xr.Dataset:
            return ds if prepared is None else keep(ds)

        with interruptible(store.path, so_far, attributes, cut_off):
            ds = keep(work(store).assign_attrs(attributes))
        store.remove(scenes)
    return ds


def _begin(execution: Execution, store: Store, scenes: Sequence[Scene] | None) -> None:
    """Refuse what is there already, or make room."""
    assert execution.archive is not None
    if isinstance(store, RunCache) and (execution.resume or not execution.overwrite):
        store.refuse_others()
    if execution.resume:
        if isinstance(store, RunCache) and scenes is not None:
            store.note_strangers(scenes)
    elif execution.overwrite:
        store.remove()
    elif count := store.count():
        raise SceneError(
            "archive",
            execution.archive,
            f"was cut off, {count} of its runs are in {store.path.name}: "
            "go on with --resume (resume=True), or start anew with --overwrite (overwrite=True)",
        )
    else:
        check_target(execution.archive)


def _whole(
    target: Path, about: Mapping[str, Any], driver: str, read: Callable[[Path], xr.Dataset]
) -> xr.Dataset | None:
    """Return the archive of this very study, None if runs of it are missing; refuse any other file."""
    try:
        ds = read(target)
    except SceneError as error:
        raise SceneError("archive", target, f"exists and cannot be resumed: it {error.allowed}") from None
    differing = [name for name, value in about.items() if ds.attrs.get(name, "") != value]
    if differing or ds.attrs.get("backend", "") not in ("", driver):
        ds.close()
        raise SceneError(
            "archive",
            target,
            "exists and is of another sweep or study, other settings or another version: name another, or allow "
            "--overwrite (overwrite=True)",
        )
    cut_off = ds.attrs.get("ending") == "interrupted" or (
        "status" in ds and "interrupted" in ds["status"].values
    )
    if not cut_off:
        return ds
    ds.close()
    return None


@contextmanager
def interruptible(
    path: Path | None = None,
    so_far: Callable[[], xr.Dataset] = xr.Dataset,
    about: Mapping[str, Any] | None = None,
    keep: Callable[[xr.Dataset], xr.Dataset] | None = None,
) -> Iterator[None]:
    """Turn Ctrl-C into an `Interrupted` that says where finished runs are.

    Parameters
    ----------
    path : Path, optional
        Where finished runs are kept; without one nothing can be resumed.
    so_far : callable, optional
        Makes the dataset of what has been found, if the interrupt does not carry it.
    about : mapping, optional
        Attributes for it.
    keep : callable, optional
        Called with the dataset.

    Raises
    ------
    Interrupted
        On Ctrl-C.
    """
    try:
        yield
    except KeyboardInterrupt as interrupt:
        partial = interrupt.dataset if isinstance(interrupt, Interrupted) else so_far()
        ds = partial.assign_attrs(about or {})
        if keep is not None:
            keep(ds)
        where = "the error's dataset has what was found so far" if ds.sizes else "nothing of it is kept"
        if path is not None:
            where = f"finished runs are kept in {path}; go on with --resume (resume=True)"
        raise Interrupted(where, ds) from None


def origin_of(scene: Scene) -> dict[str, str]:
    """Return the attributes that say of which scene a dataset is, and of which version of the program."""
    attributes = provenance(scene, "")
    return {name: str(attributes[name]) for name in ("scene", SCENE_DIGEST, "source")}


def solutions(
    kept: RunCache | None,
    executor: Executor | None,
    function: Callable[..., tuple[Solved, str]],
    scenes: Sequence[Scene],
    *arguments: Any,
) -> Iterator[tuple[Solved, str]]:
    """Take runs that are kept, compute the others side by side, and keep those that finish.

    Parameters
    ----------
    function : callable
        Runs a scene, given `arguments`: its solution, and what came of it in one word.

    Yields
    ------
    Solution or TrainSolution, str
        In the order of the scenes.
    """
    taken = [None if kept is None else kept.take(scene) for scene in scenes]
    left = [scene for scene, entry in zip(scenes, taken, strict=True) if entry is None]
    repeated: list[Iterable[Any]] = [[argument] * len(left) for argument in arguments]
    fresh = side_by_side(executor, function, left, *repeated)
    for scene, entry in zip(scenes, taken, strict=True):
        if entry is not None:
            yield cast("Solved", entry[0]), str(entry[1].get("verdict", ""))
            continue
        solution, word = next(fresh)
        if kept is not None and solution.status == "finished":
            kept.store(scene, solution, {"verdict": word})
        yield solution, word
