"""One scene, one run, one dataset."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from gearidae.errors import Interrupted, SceneError
from gearidae.progress import RunProgress, run_progress
from gearidae.runs.plausibility import log_doubts
from gearidae.runs.running import early_end, prepare, solve

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.scene import Scene

__all__ = ["simulate"]


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
) -> xr.Dataset:
    """Run a scene.

    Parameters
    ----------
    scene : Scene
        What to simulate.
    rtol : float, optional
        Relative tolerance of the solver in place of ``run.rtol`` of the scene.
    t_end : float, optional
        Simulated time [s] in place of ``run.duration``.
    samples : int or str, optional
        Number of uniform samples, their rate ("20 kHz"), or "off", in place of ``run.samples``.
    backend : {'auto', 'native', 'sksundae'}, optional
        Which driver of the solver to use; ``auto`` takes the fastest that works here, or the one that a run to be
        resumed was begun with.
    progress : bool or callable, optional
        True for a progress bar on a terminal or in a notebook, or a function that is told the simulated time
        reached [s] and the number of events so far.
    archive : path-like, optional
        Write to this netCDF4 file while the run goes on. It can be opened at any time, also after a crash.
    overwrite : bool, optional
        Whether `archive` may replace a file.
    resume : bool, optional
        Go on with the run that `archive` holds if it is not at its end; it gives the same samples and events as if
        it had never been interrupted. Without such a file the run begins; an archive of a finished run is returned
        as it is.

    Returns
    -------
    xarray.Dataset
        Samples along ``time``, events along ``event``, all in SI units, with the scene as it was run, provenance,
        solver statistics and (as JSON, see `gearidae.analysis.run_summary`) the account of the run as attributes.
        With `archive`,
        what `open_archive` returns.

    Raises
    ------
    SceneError
        If the scene or a setting is not allowed, or the archive cannot be written or is of another scene; nothing
        has been run then.
    SolverError
        If the solver could not reach the end, or the disk is full. The error carries what was computed until then
        as its ``dataset``, and `archive` holds the same.
    Interrupted
        On Ctrl-C: a `KeyboardInterrupt` that carries what was computed as its ``dataset``. `archive` holds the same
        and can be resumed.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> ds = gd.simulate(scene, archive="low_speed.nc")  # doctest: +SKIP
    """
    scene = prepare(scene, rtol=rtol, t_end=t_end, samples=samples, backend=backend)
    log_doubts(scene)
    # xarray takes a third of a second to import, longer than most runs take: it is not waited for before one
    if archive is not None:
        from gearidae.archive import check_target
        from gearidae.runs.streaming import stream

        target = check_target(archive, overwrite=overwrite or resume)
        return stream(scene, target, backend=backend, progress=progress, resume=resume)
    if resume:
        raise SceneError("resume", resume, "needs the archive to go on from (archive=)")
    with run_progress(progress, scene.run.duration) as report:
        solution = solve(scene, backend, report)

    from gearidae.analysis.run_summary import with_account
    from gearidae.archive import reached, to_dataset

    ds = with_account(to_dataset(scene, solution))
    if solution.status == "interrupted":
        where = f"t = {reached(solution):.4g} s of {scene.run.duration:.4g} s"
        raise Interrupted(f"stopped at {where}; what was computed is the error's dataset", ds)
    if solution.status != "finished":
        raise early_end(ds, reached(solution))
    return ds
