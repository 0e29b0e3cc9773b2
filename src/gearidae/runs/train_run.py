"""One run of a train of several meshes: solved, judged by its shaft, labelled, written."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from gearidae.errors import Interrupted, SceneError
from gearidae.progress import RunProgress, run_progress
from gearidae.runs.plausibility import log_doubts
from gearidae.runs.running import early_end

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.records.train_results import TrainSolution
    from gearidae.scene import TrainScene


def simulate_train(
    scene: TrainScene,
    *,
    backend: str,
    progress: bool | RunProgress,
    archive: str | os.PathLike[str] | None,
    overwrite: bool,
    compress: bool,
    others: dict[str, Any],
) -> xr.Dataset:
    """Run a train; see `gearidae.simulate`.

    Parameters
    ----------
    scene : Scene
        Exactly as it is to be run.
    others : dict
        Arguments of `gearidae.simulate` that trains do not have, by name; refused unless they are None or False.

    Raises
    ------
    SceneError
        If a setting is not for a train, or the archive cannot be written.
    SolverError
        If the solver could not reach the end: it carries what was computed, and `archive` holds the same.
    Interrupted
        On Ctrl-C, likewise.
    """
    for name, value in others.items():
        if value is not None and value is not False:
            raise SceneError(name, type(value).__name__, "is not for a train of several meshes: leave it out")
    log_doubts(scene)
    if archive is None:
        return _ended(_run(scene, backend, progress))
    from gearidae.archive.target import claims_output

    with claims_output(archive, overwrite=overwrite) as target:
        ds = _run(scene, backend, progress)
        from gearidae.archive import open_archive, save

        save(ds, target, overwrite=overwrite, compress=compress)
        return _ended(open_archive(target))


def _run(scene: TrainScene, backend: str, progress: bool | RunProgress) -> xr.Dataset:
    with run_progress(progress, scene.run.duration) as report:
        solution = run_train(scene, backend, report)
    from gearidae.archive.train import judged_view, train_dataset
    from gearidae.runs.imbalance import log_imbalance

    ds = train_dataset(scene, solution)
    log_imbalance(judged_view(ds))
    return ds


def run_train(
    scene: TrainScene, backend: str, on_progress: Callable[[float, int], None] | None = None
) -> TrainSolution:
    """Run a train and judge it, with a status that says how it ended."""
    from gearidae.engine.train import solve_train  # what reads results does without it

    solution = solve_train(scene, backend=backend, on_progress=on_progress)
    from gearidae.analysis.verdict.train import judge_train

    return judge_train(scene, solution)


def _ended(ds: xr.Dataset) -> xr.Dataset:
    """Return a run that is finished; raise what ended it early, with its dataset."""
    status, reached = ds.attrs["status"], float(ds["reached"])
    if status == "interrupted":
        where = f"t = {reached:.4g} s of {ds.attrs['t_end']:.4g} s"
        raise Interrupted(f"stopped at {where}; what was computed is the error's dataset", ds)
    if status != "finished":
        from gearidae.archive.train import judged_view

        error = early_end(judged_view(ds), reached)
        error.dataset = ds
        raise error
    return ds
