"""Many runs of one scene with some of its keys varied, as one labelled dataset."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearidae.archive import check_target, open_archive, save
from gearidae.archive.keep import EVERYTHING, Keep, read_keep
from gearidae.archive.provenance import provenance
from gearidae.archive.target import claims_archive
from gearidae.engine import choose_backend
from gearidae.errors import Interrupted, SceneError
from gearidae.progress import SweepProgress, sweep_progress
from gearidae.runs.batch import Batch
from gearidae.runs.executors import check_executor, check_jobs, own_executor
from gearidae.runs.imbalance import log_imbalance
from gearidae.runs.kept_runs import KeptRuns
from gearidae.runs.kept_validity import with_validity
from gearidae.runs.running import prepare, runs_in_threads
from gearidae.runs.sweep_plan import SweepPlan, plan_sweep

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.scene import Scene

__all__ = ["kept_beside", "prepare_archive", "run_plan", "sweep", "whole_archive"]


@claims_archive
def sweep(
    scene: Scene,
    over: Mapping[str, Iterable[Any]],
    executor: Executor | None = None,
    *,
    rtol: float | None = None,
    t_end: float | None = None,
    samples: int | str | None = None,
    backend: str = "auto",
    progress: bool | SweepProgress = False,
    archive: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    jobs: int | None = None,
    zipped: bool | Collection[str] = False,
    resume: bool = False,
    keep: Iterable[str] | str | None = None,
) -> xr.Dataset:
    """Run a scene for every combination of some keys' values, or for values that are walked together.

    With `archive`, every finished run is kept in a folder beside it (``OUT.nc.runs``) until the archive is
    written, so that a sweep that was cut off, even by a power failure, can be resumed.

    Parameters
    ----------
    scene : Scene
        What the runs have in common.
    over : mapping of str to iterable
        Values of each swept key of the scene; numbers in SI units or strings with a unit, as in a case file.
        ``run.duration`` and ``run.samples`` cannot be swept, because all runs share one time axis.
    executor : concurrent.futures.Executor, optional
        Where to compute the runs: any executor, also of a cluster (of a Dask client,
        ``client.get_executor()``). By default threads, as many as `jobs`,
        when the solver runs outside Python's lock (backend ``native``); the others one after the other, or in
        `jobs` processes if `jobs` is given (the script that calls it then needs ``if __name__ ==
        "__main__":``).
    rtol, t_end, samples, backend, archive
        As for `simulate`, for every run.
    overwrite : bool, optional
        Whether `archive` may replace a file, and the runs of an unfinished sweep beside it be discarded.
    progress : bool or callable, optional
        True for a progress bar on a terminal or in a notebook, or a function that is told the number of runs done (with
        fractions for those under way, where they can be seen) and the number of runs.
    jobs : int, optional
        Runs at a time; by default the number of usable cores. Ignored if `executor` is given.
    zipped : bool or collection of str, optional
        True if all keys are to be walked together, the first value of each, then the second, instead of in all
        combinations; or the keys for which that holds. They need as many values each, and share one dimension:
        the first of them names and labels it, the others are coordinates along it.
    resume : bool, optional
        Take the runs that an unfinished sweep into `archive` has kept, and compute the others only. An archive
        that holds this very sweep already is returned as it is.
    keep : iterable of str, optional
        What each run leaves behind: names of variables (``min_gear_speed``, ``gear_speed``) and of groups of them
        (``extremes``, ``statistics``, ``energy_balance``, ``scene``, ``samples``, ``events``). Everything by default,
        and no more than ``verdict`` (with ``impacts``, ``status``, ``wall_time`` and when a gear stuck) for an empty
        list, or ``["verdict"]``. Without samples the runs are made with ``run.samples = "off"``.

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
        If a key, a value or a setting is not allowed, the archive cannot be written or there is an unfinished
        sweep into it; nothing has been run then.
    Interrupted
        On Ctrl-C: a `KeyboardInterrupt` that carries the finished runs as its ``dataset``. `archive` holds the same
        and can be resumed.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> ds = gd.sweep(scene, {"coating.sam_fraction": [1.0, 0.5, 0.47]})  # doctest: +SKIP
    >>> ds.gear_speed.sel(sam_fraction=0.5).min()  # doctest: +SKIP
    """
    base = prepare(scene, rtol=rtol, t_end=t_end, samples=samples, backend=backend)
    parts = read_keep(keep, base)
    if not parts.columns(base):
        base = base.replace({"run.samples": "off"})
    plan = plan_sweep(base, over, zipped=zipped)
    check_jobs(jobs)
    check_executor(executor)
    kept, whole = prepare_archive(
        archive,
        plan.scenes,
        backend,
        partial(whole_archive, plan=plan, backend=backend, keep=parts),
        keep=parts,
        overwrite=overwrite,
        resume=resume,
    )
    if whole is not None:
        return whole
    ds, interrupted = run_plan(
        plan,
        kept if resume else None,
        kept,
        executor,
        keep=parts,
        backend=backend,
        jobs=jobs,
        progress=progress,
    )
    if archive is not None:
        save(with_validity(ds, plan.base), archive, overwrite=overwrite or resume)
    if interrupted:
        where = (
            f"stopped before all {len(plan.scenes)} runs were done; the error's dataset has those that are"
        )
        if archive is not None:
            where = f"the finished runs are in {os.fspath(archive)}; go on with --resume"
        raise Interrupted(where, ds)
    if kept is not None:
        kept.remove(plan.scenes)
    return ds


def run_plan(
    plan: SweepPlan,
    former: KeptRuns | None,
    kept: KeptRuns | None,
    executor: Executor | None,
    *,
    keep: Keep = EVERYTHING,
    backend: str,
    jobs: int | None,
    progress: bool | SweepProgress,
) -> tuple[xr.Dataset, bool]:
    """Compute the runs of a sweep.

    Parameters
    ----------
    plan : SweepPlan
    former, kept : KeptRuns, optional
        Where to take finished runs from, and where to keep those that finish.
    executor, backend, jobs, progress
        As for `sweep`.
    keep : Keep, optional
        What each run leaves behind; by default everything.

    Returns
    -------
    Dataset
        As from `sweep`.
    bool
        Whether Ctrl-C ended it early.
    """
    workers, releases_gil = check_jobs(jobs), runs_in_threads(backend, plan.base.run.method)
    if not releases_gil and jobs is None:
        workers = 1
    with sweep_progress(progress, len(plan.scenes)) as report:
        batch = Batch(plan, backend, report, kept, keep)
        interrupted = False
        try:
            if former is not None:
                batch.take_kept(former)
            if executor is not None:
                batch.run(executor)
            else:
                with own_executor(workers, batch.left, releases_gil=releases_gil) as own:
                    batch.run(own, threads=workers if releases_gil else 0)
        except KeyboardInterrupt:
            interrupted = True
    ds = batch.dataset()
    log_imbalance(ds)
    return ds, interrupted


def prepare_archive(
    archive: str | os.PathLike[str] | None,
    scenes: Sequence[Scene],
    backend: str,
    whole: Callable[[Path], xr.Dataset | None],
    *,
    keep: Keep = EVERYTHING,
    overwrite: bool,
    resume: bool,
) -> tuple[KeptRuns | None, xr.Dataset | None]:
    """Find out where to keep finished runs, and whether all is done already.

    Parameters
    ----------
    archive, backend, overwrite, resume
        As for `sweep`.
    scenes : sequence of Scene
        All runs.
    whole : callable
        Told the archive that is there: its content if it holds all of these runs, None if some are missing; raises
        `SceneError` if it is of others.
    keep : Keep, optional
        What each run leaves behind; by default everything.

    Returns
    -------
    KeptRuns, optional
        None without an archive.
    Dataset, optional
        What is there, if it is all.

    Raises
    ------
    SceneError
        If the archive cannot be written, or is there and may not be replaced.
    """
    kept = kept_beside(archive, scenes[0], backend, keep=keep, overwrite=overwrite, resume=resume)
    if archive is None or kept is None or not resume:
        return kept, None
    target = check_target(archive, overwrite=True)
    if kept.count():
        kept.note_strangers(scenes)
    elif target.exists():
        return kept, whole(target)
    return kept, None


def kept_beside(
    archive: str | os.PathLike[str] | None,
    scene: Scene,
    backend: str,
    *,
    keep: Keep = EVERYTHING,
    overwrite: bool,
    resume: bool,
) -> KeptRuns | None:
    """Find out where to keep finished runs.

    Parameters
    ----------
    archive, backend, overwrite, resume
        As for `sweep`.
    scene : Scene
        Any of them.
    keep : Keep, optional
        What each run leaves behind; by default everything.

    Returns
    -------
    KeptRuns or None
        None without an archive. Without `resume`, empty.

    Raises
    ------
    SceneError
        If the archive cannot be written, or is there, or was cut off, and may not be replaced.
    """
    if archive is None:
        if resume:
            raise SceneError("resume", resume, "needs an archive: the runs to go on from are kept beside it")
        return None
    target = check_target(archive, overwrite=True)
    kept = KeptRuns(target, scene, choose_backend(backend, scene.run.method), keep)
    count = 0 if resume else kept.count()
    if count and not overwrite:
        raise SceneError(
            "archive",
            archive,
            f"was cut off, {count} of its runs are in {kept.folder.name}: "
            "go on with --resume (resume=True), or start anew with --overwrite (overwrite=True)",
        )
    if count:
        kept.remove()
    elif not resume:
        check_target(archive, overwrite=overwrite)
    return kept


def whole_archive(
    target: Path, plan: SweepPlan, backend: str, keep: Keep, more: Mapping[str, str] | None = None
) -> xr.Dataset | None:
    """Return the archive of this very sweep, None if runs of it are missing; refuse any other file.

    Parameters
    ----------
    target : Path
        That is there.
    plan : SweepPlan
    backend : str
        As for `sweep`.
    keep : Keep
    more : mapping of str to str, optional
        Further attributes that it must have.

    Returns
    -------
    Dataset or None

    Raises
    ------
    SceneError
        If it is of another sweep, or cannot be read.
    """
    try:
        ds = open_archive(target)
    except SceneError as error:
        raise SceneError("archive", target, f"exists and cannot be resumed: it {error.allowed}") from None
    asked = "" if keep.names is None else json.dumps(keep.asked)
    expected = {
        name: str(value) for name, value in provenance(plan.base, "").items() if name in ("scene", "source")
    }
    expected |= {"swept": plan.swept, "zipped": plan.zipped, "keep": asked, **(more or {})}
    differing = [name for name, value in expected.items() if ds.attrs.get(name, "") != value]
    if differing or ds.attrs["backend"] not in ("", choose_backend(backend, plan.base.run.method)):
        ds.close()
        raise SceneError(
            "archive",
            target,
            "exists and is of another sweep, other settings or another version: name another, or allow "
            "--overwrite (overwrite=True)",
        )
    if "interrupted" not in ds["status"].values:
        return ds
    ds.close()
    return None
