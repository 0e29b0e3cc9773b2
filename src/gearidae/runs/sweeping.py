"""Many runs of one scene with some of its keys varied, as one labelled dataset."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Collection, Iterable, Mapping
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any

from gearidae.archive.output_selection import EVERYTHING, OutputSelection, read_keep
from gearidae.errors import Interrupted
from gearidae.progress import SweepProgress, sweep_progress
from gearidae.runs.batch import Batch
from gearidae.runs.execution import Execution, origin_of, run_kept
from gearidae.runs.imbalance import log_imbalance
from gearidae.runs.kept_validity import with_validity
from gearidae.runs.run_cache import RunCache
from gearidae.runs.running import prepare
from gearidae.runs.sweep_plan import SweepPlan, plan_sweep
from gearidae.runs.train_sweep import refuse_unlike

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.scene import Scene


def sweep(
    scene: Scene,
    over: Mapping[str, Iterable[Any]],
    executor: Executor | None = None,
    *,
    rtol: float | None = None,
    t_end: float | None = None,
    samples: int | str | None = None,
    backend: str = "auto",
    progress: bool | SweepProgress = True,
    archive: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    jobs: int | None = None,
    zipped: bool | Collection[str] = False,
    resume: bool = False,
    keep: Iterable[str] | str | None = None,
    compress: bool = True,
) -> xr.Dataset:
    """Run a scene for every combination of some keys' values, or for values that are walked together.

    With `archive`, every finished run is kept in a file beside it (``OUT.nc.journal``) until the archive is
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
        True for a progress bar on a terminal or in a notebook, with the time that is left, and a line in the log where
        neither is there and the runs take more than a minute; False for none; or a function of the number of finished
        runs (with fractions for those under way, where they can be seen) and the number of runs.
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
    compress : bool, optional
        Whether `archive` is compressed, as for `gearidae.save`.

    Returns
    -------
    xarray.Dataset
        As from `simulate`, with a dimension for each swept key in front of ``time``, named by the key's last
        part (``sam_fraction``). Events lie on one flat ``event`` dimension, labelled by
        ``event_<dimension>``. A run that could not go on says so in its ``status`` and is NaN from there on;
        the others are not affected.
        Of trains ``shaft`` and ``mesh`` stand between the swept keys and ``time``.

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
    base = prepare(scene, rtol=rtol, t_end=t_end, samples=samples, backend=backend, trains=True)
    parts = read_keep(keep, base)
    if not parts.columns(base):
        base = base.replace({"run.samples": "off"})
    execution = Execution(
        executor, jobs, backend, progress, archive, overwrite, resume, base.run.method, compress
    )
    plan = plan_sweep(base, over, zipped=zipped)
    return run_study(plan, execution, {}, selection=parts)


def run_study(
    plan: SweepPlan,
    execution: Execution,
    about: Mapping[str, str],
    finish: Callable[[xr.Dataset], xr.Dataset] = lambda ds: ds,
    *,
    selection: OutputSelection | None = None,
) -> xr.Dataset:
    """Compute the runs of a plan, and make the dataset of a sweep or a study of them.

    Parameters
    ----------
    about : mapping of str to str
        What the result depends on besides the runs, as attributes.
    finish : callable, optional
        Makes the study's dataset of that of the runs.
    selection : OutputSelection, optional
        What each run leaves behind; by default its verdict and its extremes.

    Returns
    -------
    Dataset
        Of an archive that is whole, its content.

    Raises
    ------
    SceneError
        If the archive cannot be written, or is of something else.
    Interrupted
        On Ctrl-C, with the runs so far as its ``dataset``; `archive` holds the same and can be resumed.
    """
    selection = read_keep(("extremes",), plan.base) if selection is None else selection
    refuse_unlike(plan)
    asked = "" if selection.names is None else json.dumps(selection.asked)
    expected = {
        **origin_of(plan.base), "swept": plan.swept, "zipped": plan.zipped, "keep": asked, **about,
    }  # fmt: skip

    def work(kept: RunCache | None) -> xr.Dataset:
        try:
            return finish(run_plan(plan, execution, kept, selection))
        except Interrupted as interrupt:
            raise Interrupted("", finish(interrupt.dataset)) from None

    return run_kept(
        execution,
        lambda target: RunCache(target, plan.base, execution.driver, selection),
        work,
        expected,
        scenes=plan.scenes,
        prepared=lambda ds: with_validity(ds, plan.base) if ds.sizes else ds,
    )


def run_plan(
    plan: SweepPlan, execution: Execution, kept: RunCache | None, selection: OutputSelection = EVERYTHING
) -> xr.Dataset:
    """Compute the runs of a sweep.

    Parameters
    ----------
    kept : RunCache, optional
        Where finished runs are taken from, and kept.
    selection : OutputSelection, optional
        What each run leaves behind.

    Raises
    ------
    Interrupted
        On Ctrl-C, with the runs that are finished; the others are marked.
    """
    with sweep_progress(execution.progress, len(plan.scenes), lambda: execution.words(plan.scenes)) as report:
        batch = Batch(plan, execution.backend, report, kept, selection)
        try:
            if kept is not None and kept.count():
                batch.take_kept(kept)
            with execution.computing(batch.left) as executor:
                batch.run(executor, threads=execution.threads())
        except KeyboardInterrupt:
            raise Interrupted("", batch.dataset()) from None
    ds = batch.dataset()
    log_imbalance(ds)
    return ds
