"""The runs of a study: computed, kept beside the archive until it is written, resumed."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from gearidae.archive import save
from gearidae.archive.keep import read_keep
from gearidae.errors import Interrupted
from gearidae.runs.executors import check_executor, check_jobs
from gearidae.runs.kept_validity import with_validity
from gearidae.runs.sweeping import prepare_archive, run_plan, whole_archive

if TYPE_CHECKING:
    from gearidae.progress import SweepProgress
    from gearidae.runs.sweep_plan import SweepPlan

__all__ = ["KEPT", "Execution", "interruptible", "run_study"]

KEPT = ("extremes",)
"""What each run leaves behind, beside its verdict."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Execution:
    """How the runs of a study are computed and kept; each field is an argument of `gearidae.sweep`.

    Raises
    ------
    SceneError
        If a setting is not allowed: before anything is run.
    """

    executor: Executor | None = None
    jobs: int | None = None
    backend: str = "auto"
    progress: bool | SweepProgress = False
    archive: str | os.PathLike[str] | None = None
    overwrite: bool = False
    resume: bool = False

    def __post_init__(self) -> None:
        check_jobs(self.jobs)
        check_executor(self.executor)


@contextmanager
def interruptible(
    folder: Path | None = None, so_far: Callable[[], xr.Dataset] = xr.Dataset
) -> Iterator[None]:
    """Turn Ctrl-C into an `Interrupted` that says where finished runs are.

    Parameters
    ----------
    folder : Path, optional
        Where finished runs are kept; without one nothing can be resumed.
    so_far : callable, optional
        Makes the dataset of what has been found.

    Raises
    ------
    Interrupted
        On Ctrl-C.
    """
    try:
        yield
    except KeyboardInterrupt:
        where = "nothing of it is kept"
        if folder is not None:
            where = f"finished runs are kept in {folder}; go on with --resume (resume=True)"
        raise Interrupted(where, so_far()) from None


def run_study(
    plan: SweepPlan,
    how: Execution,
    attributes: Mapping[str, str],
    finish: Callable[[xr.Dataset], xr.Dataset],
) -> xr.Dataset:
    """Compute the runs of a plan, without samples, and make the study's dataset of them.

    Parameters
    ----------
    plan : SweepPlan
    how : Execution
    attributes : mapping of str to str
        What the study depends on besides the runs: an archive that has others is not gone on with.
    finish : callable
        Makes the study's dataset of that of the runs.

    Returns
    -------
    Dataset
        With the attributes; of an archive that is whole, its content.

    Raises
    ------
    SceneError
        If the archive cannot be written, or is of something else.
    Interrupted
        On Ctrl-C, with the runs so far as its ``dataset``; `archive` holds the same and can be resumed.
    """
    keep = read_keep(KEPT, plan.base)
    whole = partial(whole_archive, plan=plan, backend=how.backend, keep=keep, more=attributes)
    kept, found = prepare_archive(
        how.archive, plan.scenes, how.backend, whole, keep=keep, overwrite=how.overwrite, resume=how.resume
    )
    if found is not None:
        return found
    ds, interrupted = run_plan(
        plan,
        kept if how.resume else None,
        kept,
        how.executor,
        keep=keep,
        backend=how.backend,
        jobs=how.jobs,
        progress=how.progress,
    )
    ds = finish(ds).assign_attrs(attributes)
    where = "the error's dataset has the finished runs"
    if how.archive is not None:
        save(with_validity(ds, plan.base), how.archive, overwrite=how.overwrite or how.resume)
        where = f"the finished runs are in {os.fspath(how.archive)}; go on with --resume"
    if interrupted:
        raise Interrupted(where, ds)
    if kept is not None:
        kept.remove(plan.scenes)
    return ds
