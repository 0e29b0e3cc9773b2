"""One run of a train of several meshes: solved, judged by its shaft, labelled, written."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from gearidae.archive.disk import DiskError, disk_errors
from gearidae.archive.journal import journal_of
from gearidae.engine import AT_ONCE, Start
from gearidae.errors import Interrupted, SceneError, SolverError
from gearidae.progress import RunProgress, run_progress
from gearidae.records.train_results import sample_columns
from gearidae.runs.plausibility import log_doubts
from gearidae.runs.running import early_end
from gearidae.runs.starting import started_attributes

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.archive.train.journal import TrainJournal
    from gearidae.engine.train import OnTrainBlock
    from gearidae.records.train_results import TrainBlock, TrainSolution
    from gearidae.scene import TrainScene


def simulate_train(
    scene: TrainScene,
    *,
    backend: str,
    progress: bool | RunProgress,
    archive: str | os.PathLike[str] | None,
    overwrite: bool,
    resume: bool,
    start: Start,
    on_block: OnTrainBlock | None,
    compress: bool,
) -> xr.Dataset:
    """Run a train; see `gearidae.simulate`.

    Parameters
    ----------
    scene : Scene
        Exactly as it is to be run.
    start : Start
        Where the run begins.
    on_block : callable, optional
        Called with each `gearidae.records.train_results.TrainBlock`.

    Raises
    ------
    SceneError
        If a setting is not for a train, or the archive cannot be written or is of another run.
    SolverError
        If the solver could not reach the end: it carries what was computed, and `archive` holds the same.
    Interrupted
        On Ctrl-C, likewise.
    """
    log_doubts(scene)
    if archive is not None:
        from gearidae.archive.target import claims_output

        with claims_output(archive, overwrite=overwrite or resume) as target:
            return _stream(scene, target, backend, progress, resume, start, on_block, compress)
    if resume:
        raise SceneError("resume", resume, "needs the archive to go on from (archive=)")
    return _ended(_run(scene, backend, progress, start, (), on_block))


def _run(
    scene: TrainScene,
    backend: str,
    progress: bool | RunProgress,
    start: Start,
    blocks: Sequence[TrainBlock],
    on_block: OnTrainBlock | None,
) -> xr.Dataset:
    from gearidae.engine.train import solve_train

    with run_progress(progress, start.time + scene.run.duration) as report:
        solution = solve_train(
            scene, backend=backend, on_progress=report, start=start, blocks=blocks, on_block=on_block
        )
    from gearidae.analysis.verdict.train import judge_chain
    from gearidae.archive.train import judged_view, train_dataset
    from gearidae.runs.imbalance import log_imbalance

    solution, verdict = judge_chain(scene, solution, start.verdict)
    ds = train_dataset(scene, solution, verdict=verdict).assign_attrs(started_attributes(start))
    log_imbalance(judged_view(ds))
    return ds


def _stream(
    scene: TrainScene,
    target: Path,
    backend: str,
    progress: bool | RunProgress,
    resume: bool,
    start: Start,
    on_block: OnTrainBlock | None,
    compress: bool,
) -> xr.Dataset:
    """Run a train, or go on with a run of it, into an archive."""
    from gearidae.archive import open_archive, save
    from gearidae.archive.train.journal import TrainJournal
    from gearidae.runs.streaming import FREE_SPACE, drop, finished_before, left_of, taken_up

    beside = journal_of(target)
    if resume and target.exists():
        finished = finished_before(target, scene, start)
        drop(beside)  # a kill may have left one
        return finished
    if resume and beside.exists():
        journal, backend = taken_up(TrainJournal, target, scene, start, backend)
    else:
        journal, backend = _begun(scene, target, start, backend)
    with journal:

        def take(block: TrainBlock) -> object:
            with disk_errors():
                journal.take(block)
            return None if on_block is None else on_block(block)

        try:
            ds = _run(scene, backend, progress, start, journal.blocks(), take)
            with disk_errors():
                journal.flush()
                if ds.attrs["status"] == "interrupted":
                    raise KeyboardInterrupt
            try:
                save(ds, target, overwrite=True, compress=compress)
            except SceneError as error:
                raise _not_written(left_of(target), target, error, FREE_SPACE) from error
        except KeyboardInterrupt:
            kept = f"the run up to there is in {target}; go on with --resume (resume=True)"
            raise Interrupted(kept, left_of(target)) from None
        except DiskError as error:
            raise _not_written(left_of(target), target, error, FREE_SPACE) from error
        except SceneError:
            if not journal.blocks():
                drop(beside)  # refused before its first step
            raise
    drop(beside)
    return _ended(open_archive(target))


def _begun(scene: TrainScene, target: Path, start: Start, backend: str) -> tuple[TrainJournal, str]:
    """Make the journal of a run, with the driver that runs it."""
    from gearidae.archive.provenance import provenance
    from gearidae.archive.train.journal import TrainJournal
    from gearidae.engine.train import driver_of_train
    from gearidae.runs.streaming import begun

    driver, train = driver_of_train(backend), scene.train
    attributes = {
        **provenance(scene, "begun"),
        "status": "running",
        "backend": driver,
        **({"start_time": start.time} if start.time else {}),
        **started_attributes(start),
    }
    numbers = sample_columns(len(train.shafts), len(train.meshes)) * scene.run.sample_count
    return begun(TrainJournal, target, attributes, numbers), driver


def _not_written(left: xr.Dataset, target: Path, error: Exception, advice: str) -> SolverError:
    """Error of a run whose archive the disk does not take; the journal keeps what there is of it."""
    reached = float(left["reached"])
    message = f"the archive {target} could not be written ({error})"
    return _early_end(left, reached, message, advice)


def _early_end(ds: xr.Dataset, reached: float, *words: str) -> SolverError:
    """Error of a run that has ended early, with its dataset; see `gearidae.runs.running.early_end`."""
    from gearidae.archive.train import judged_view

    error = early_end(judged_view(ds), reached, *words)
    error.dataset = ds
    return error


def run_train(
    scene: TrainScene,
    backend: str,
    on_progress: Callable[[float, int], None] | None = None,
    *,
    start: Start = AT_ONCE,
) -> TrainSolution:
    """Run a train and judge it, with a status that says how it ended."""
    from gearidae.engine.train import solve_train  # what reads results does without it

    solution = solve_train(scene, backend=backend, on_progress=on_progress, start=start)
    from gearidae.analysis.verdict.train import judge_chain

    return judge_chain(scene, solution, start.verdict)[0]


def _ended(ds: xr.Dataset) -> xr.Dataset:
    """Return a run that is finished; raise what ended it early, with its dataset."""
    status, reached = ds.attrs["status"], float(ds["reached"])
    if status == "interrupted":
        where = f"t = {reached:.4g} s of {ds.attrs['t_end']:.4g} s"
        raise Interrupted(f"stopped at {where}; what was computed is the error's dataset", ds)
    if status not in ("finished", "stopped"):
        raise _early_end(ds, reached)
    return ds
