"""One scene, one run, one dataset."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from gearidae import engine
from gearidae.archive import check_target, save, to_dataset
from gearidae.progress import RunProgress, run_progress
from gearidae.running import early_end, prepare

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.scene import Scene

__all__ = ["simulate"]


def simulate(
    scene: Scene,
    *,
    rtol: float | None = None,
    t_end: float | None = None,
    samples: int | None = None,
    backend: str = "auto",
    progress: bool | RunProgress = False,
    archive: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
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
    samples : int, optional
        Number of uniform samples in place of ``run.samples``.
    backend : {'auto', 'native', 'sksundae'}, optional
        Which driver of the solver to use; ``auto`` takes the fastest that works here.
    progress : bool or callable, optional
        True for a progress bar on a terminal, or a function that is told the simulated time reached [s] and
        the number of events so far.
    archive : path-like, optional
        Also write the dataset to this netCDF4 file.
    overwrite : bool, optional
        Whether `archive` may replace a file.

    Returns
    -------
    xarray.Dataset
        Samples along ``time``, events along ``event``, all in SI units, with the scene as it was run,
        provenance and solver statistics as attributes.

    Raises
    ------
    SceneError
        If the scene or a setting is not allowed, or the archive cannot be written; nothing has been run then.
    SolverError
        If the solver could not reach the end. The error carries what was computed until then as its
        ``dataset``, and `archive` holds the same.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> ds = gd.simulate(scene, archive="low_speed.nc")  # doctest: +SKIP
    """
    scene = prepare(scene, rtol=rtol, t_end=t_end, samples=samples, backend=backend)
    if archive is not None:
        check_target(archive, overwrite=overwrite)
    with run_progress(progress, scene.run.duration) as report:
        solution = engine.solve(scene, backend=backend, on_progress=report)
    ds = to_dataset(scene, solution)
    if archive is not None:
        save(ds, archive, overwrite=overwrite)
    if solution.status == "interrupted":
        raise KeyboardInterrupt(
            *([] if archive is None else [f"the run up to there is in {os.fspath(archive)}"])
        )
    if solution.status != "finished":
        raise early_end(solution, ds)
    return ds
