"""One scene, one run, one dataset."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from gearidae.errors import Interrupted, SceneError
from gearidae.progress import RunProgress, run_progress
from gearidae.runs.plausibility import log_doubts
from gearidae.runs.running import SomeScene, early_end, prepare, solve, watched, with_samples
from gearidae.runs.starting import started_attributes, started_from
from gearidae.scene.scene import is_long_train

if TYPE_CHECKING:
    from collections.abc import Callable

    import xarray as xr

    from gearidae.scene import Scene


def simulate(
    scene: Scene,
    *,
    rtol: float | None = None,
    t_end: float | None = None,
    samples: int | str | None = None,
    backend: str = "auto",
    progress: bool | RunProgress = False,
    archive: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    resume: bool = False,
    start: xr.Dataset | str | os.PathLike[str] | None = None,
    on_block: Callable[[Any], object] | None = None,
    compress: bool = True,
) -> xr.Dataset:
    """Run a scene.

    Parameters
    ----------
    scene : Scene
        What to simulate.
    rtol : float, optional
        Relative tolerance of the solver in place of ``run.rtol`` of the scene.
    t_end : float, optional
        Time at which the run ends [s], in place of what ``run.duration`` makes it.
    samples : int or str, optional
        Number of uniform samples, their rate ("20 kHz"), or "off", in place of ``run.samples``.
    backend : {'auto', 'native', 'sksundae'}, optional
        Which driver of the solver to use; ``auto`` takes the fastest that works here, or the one that a run to be
        resumed was begun with.
    progress : bool or callable, optional
        True for a progress bar on a terminal or in a notebook, or a function of the simulated time
        reached [s] and the number of events so far.
    archive : path-like, optional
        netCDF4 file to write. While the run goes on, what there is of it is in a journal beside it
        (``OUT.nc.journal``), which `gearidae.open` reads by the name of the archive at any time, also after a crash.
    overwrite : bool, optional
        Whether `archive` may replace a file.
    resume : bool, optional
        Go on with the run that `archive` holds if it is not at its end; it gives the same samples and events as if
        it had never been interrupted. Without such a file the run begins; an archive of a finished run is returned
        as it is.
    start : xarray.Dataset or path-like, optional
        Another run to go on from, in memory or on disk: with its motion, histories, energy balance and time, where it
        ended (an unfinished one: at its newest checkpoint). The run then lasts ``run.duration`` from there; torques and
        schedules are those of the time that goes on. The scene may differ in ``drive``, ``load``, ``coating``, ``run``
        and ``name``; its ``initial`` says nothing.
    on_block : callable, optional
        Called with each block (`gearidae.records.Block`: samples, events, the time reached; of a train
        `gearidae.records.train_results.TrainBlock`) as soon as it is there; by returning True it ends the run, which
        keeps its data, with the status ``stopped``.
    compress : bool, optional
        Whether the finished `archive` is compressed, as for `gearidae.save`.

    Returns
    -------
    xarray.Dataset
        Samples along ``time``, events along ``event``, all in SI units, with the scene as it was run, provenance,
        solver statistics and (as JSON, see `gearidae.archive.run_summary`) the run summary as attributes.
        With `archive`,
        what `open_archive` returns.

    Raises
    ------
    SceneError
        If the scene or a setting is not allowed, or the archive cannot be written or is of another scene; nothing
        has been run then.
    SolverError
        If the solver could not reach the end, or the disk is full. The error carries what was computed until then
        as its ``dataset``, and `archive` or its journal holds the same.
    Interrupted
        On Ctrl-C: a `KeyboardInterrupt` that carries what was computed as its ``dataset``. The journal holds the same
        and can be resumed.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> ds = gd.simulate(scene, archive="low_speed.nc")  # doctest: +SKIP
    """
    scene = prepare(scene, rtol=rtol, samples=samples, backend=backend, trains=True)
    begin = started_from(start, scene)
    if begin.scene is not None and begin.scene.initial is not None:  # where angles and phases count from
        phase = {"initial.mesh_phase": begin.scene.initial.mesh_phase}
        scene = scene.replace(
            {"initial": begin.scene.to_dict()["initial"]} if is_long_train(scene) else phase
        )
    if t_end is not None:
        scene = _ending(scene, t_end, begin.time)
    if is_long_train(scene):
        from gearidae.runs.train_run import simulate_train  # which few runs need

        return simulate_train(
            scene,
            backend=backend,
            progress=progress,
            archive=archive,
            overwrite=overwrite,
            resume=resume,
            start=begin,
            compress=compress,
            on_block=on_block,
        )
    scene = with_samples(scene)
    log_doubts(scene)
    # xarray takes a third of a second to import, longer than most runs take: it is not waited for before one
    if archive is not None:
        from gearidae.archive.target import claims_output
        from gearidae.runs.streaming import stream

        with claims_output(archive, overwrite=overwrite or resume) as target:
            return stream(
                scene,
                target,
                backend=backend,
                progress=progress,
                resume=resume,
                start=begin,
                on_block=on_block,
                compress=compress,
            )
    if resume:
        raise SceneError("resume", resume, "needs the archive to go on from (archive=)")
    with run_progress(progress, begin.time + scene.run.duration) as report:
        solution = solve(scene, backend, report, start=begin, on_block=watched(report, on_block))

    from gearidae.archive import reached, to_dataset
    from gearidae.runs.imbalance import log_imbalance

    ds = to_dataset(scene, solution)
    log_imbalance(ds)
    ds.attrs |= started_attributes(begin)
    if solution.status == "interrupted":
        where = f"t = {reached(solution):.4g} s of {scene.run.duration:.4g} s"
        raise Interrupted(f"stopped at {where}; what was computed is the error's dataset", ds)
    if solution.status not in ("finished", "stopped"):
        raise early_end(ds, reached(solution))
    return ds


def _ending(scene: SomeScene, t_end: float, begin: float) -> SomeScene:
    """Let a run that begins at a time end at another."""
    if begin == 0.0:
        return scene.replace({"run.duration": t_end})
    if not isinstance(t_end, int | float) or not t_end > begin:
        raise SceneError("t_end", t_end, f"must lie after {begin:g} s, where the run begins")
    return scene.replace({"run.duration": t_end - begin})
