"""A run whose output goes straight into its archive, and that can be taken up again after anything."""

from __future__ import annotations

import json
import math
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from gearidae import __version__, engine
from gearidae.archive import RunJournal, open_archive, save, to_dataset
from gearidae.archive.definition import LONGEST_WHOLE
from gearidae.archive.disk import DiskError, disk_errors, refuse_too_small
from gearidae.archive.journal import journal_of
from gearidae.archive.unfinished import RESUMABLE, Checkpoint, JournalOfRun
from gearidae.engine.backend import statistics_of
from gearidae.errors import Interrupted, SceneError, SolverError
from gearidae.progress import RunProgress, run_progress
from gearidae.runs.imbalance import log_imbalance
from gearidae.runs.kept_validity import with_validity
from gearidae.runs.running import early_end, unsolved, watched
from gearidae.runs.starting import started_attributes
from gearidae.scene.differences import first_difference
from gearidae.scene.sampled import columns_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray as xr

    from gearidae.engine import Ended
    from gearidae.records import Block, Solution, Statistics
    from gearidae.scene import Scene

Kept = TypeVar("Kept", bound=JournalOfRun)
FREE_SPACE = "free some space and go on with --resume (resume=True)"


def stream(
    scene: Scene,
    target: Path,
    *,
    backend: str,
    progress: bool | RunProgress,
    resume: bool,
    start: engine.Start,
    on_block: engine.OnBlock | None = None,
    compress: bool = True,
) -> xr.Dataset:
    """Run a scene, or go on with a run of it, into an archive.

    Parameters
    ----------
    scene : Scene
        As it is to be run.
    target : Path
        The archive, checked by `gearidae.archive.check_target`.
    backend, progress, resume, on_block, compress
        As for `gearidae.simulate`.
    start : Start
        Where the run begins.

    Returns
    -------
    xarray.Dataset
        The finished archive, as `open_archive` returns it.

    Raises
    ------
    SceneError, SolverError, Interrupted
        As `gearidae.simulate` says.
    """
    beside = journal_of(target)
    if resume and target.exists():
        finished = finished_before(target, scene, start)
        drop(beside)  # a kill may have left one
        return finished
    run = _Run(scene, target, start, backend)
    with run.take_up() if resume and beside.exists() else run.begin() as journal:
        with run_progress(progress, run.end) as report:
            ended = run.follow(journal, report, watched(report, on_block))
        ds = run.leave(journal, ended, compress=compress)
    drop(beside)
    if ds.nbytes > LONGEST_WHOLE:  # it is in the journal no more
        ds = open_archive(target)
    if ended.status not in ("finished", "stopped"):
        raise early_end(ds, ended.end_time)
    return ds


class _Run:
    """One run into one archive."""

    def __init__(self, scene: Scene, target: Path, start: engine.Start, backend: str) -> None:
        self._scene, self._target, self._start = scene, target, start
        self.end = start.time + scene.run.duration
        self._backend = backend

    def begin(self) -> RunJournal:
        """Make the journal, in the place of an archive that may be replaced."""
        self._backend = engine.choose_backend(self._backend, self._scene.run.method)
        skipped, method = engine.outlook(self._scene, self._backend, start=self._start)
        empty = unsolved("running", "the run is not at its end yet")
        statistics = replace(empty.statistics, backend=self._backend, method=method, skipped=skipped)
        ds = self._dataset(replace(empty, statistics=statistics))
        return begun(
            RunJournal, self._target, ds.attrs, len(columns_of(self._scene)) * self._scene.run.sample_count
        )

    def take_up(self) -> RunJournal:
        """Open the journal that is there, and make sure that it is of this very run."""
        journal, self._backend = taken_up(RunJournal, self._target, self._scene, self._start, self._backend)
        return journal

    def follow(
        self, journal: RunJournal, report: RunProgress | None, on_block: engine.OnBlock | None
    ) -> Ended:
        """Run on from the newest checkpoint."""
        reached = self._start.time

        def take(block: Block, statistics: Statistics, wall_time: float) -> None:
            nonlocal reached
            with disk_errors():
                journal.take(block, statistics, wall_time, last=_is_end(block.time, self.end))
            reached = block.time

        try:
            start = self._start
            with disk_errors():
                point = journal.go_back()
            if point is not None:
                reached = point.time
                if _is_end(reached, self.end):  # all that is missing is the final form
                    return self._ended_at(point)
                start = replace(
                    start,
                    checkpoint=point.state,
                    reached=reached,
                    wall_time=point.wall_time,
                    events=point.events,
                    statistics=point.statistics,
                )
            return engine.follow(
                self._scene,
                take,
                backend=self._backend,
                on_progress=report,
                start=start,
                on_block=on_block,
            )
        except DiskError as error:
            raise self._not_written(
                reached, f"the archive {self._target} could not be written ({error})"
            ) from error

    def leave(self, journal: RunJournal, ended: Ended, *, compress: bool) -> xr.Dataset:
        """Write the archive of a run that has ended, and return what is in it.

        Raises
        ------
        SolverError, Interrupted
            If the run was interrupted, or the disk does not take the archive; the journal stays as it is.
        """
        try:
            with disk_errors():
                journal.flush()
                if ended.status == "interrupted":
                    raise KeyboardInterrupt
                ds = with_validity(journal.filled(self._ended(ended)), self._scene)
                log_imbalance(ds)
                if ds.nbytes <= LONGEST_WHOLE:
                    ds.load()
                save(ds, self._target, overwrite=True, compress=compress)
        except KeyboardInterrupt:
            raise self._interrupted() from None
        except (DiskError, SceneError) as error:
            raise self._not_written(ended.end_time, str(error)) from error
        return ds

    def _interrupted(self) -> Interrupted:
        kept = f"the run up to there is in {self._target}; go on with --resume (resume=True)"
        return Interrupted(kept, left_of(self._target))

    def _not_written(self, reached: float, message: str) -> SolverError:
        return early_end(left_of(self._target), reached, message, FREE_SPACE)

    def _ended_at(self, point: Checkpoint) -> Ended:
        """How a run ended of which only the archive's final form was missing."""
        skipped, method = engine.outlook(self._scene, self._backend, point.state, self._start)
        counted = replace(point.statistics, method=method)
        statistics = statistics_of(counted, point.wall_time, self._backend, skipped)
        balance, extremes = engine.kept_at(self._scene, point.state, self._start)
        return engine.Ended(statistics, "finished", "", point.time, balance, extremes, point.state)

    def _ended(self, ended: Ended) -> xr.Dataset:
        """Make the dataset of a run that has ended, without samples and rows."""
        return self._dataset(
            replace(
                unsolved(ended.status, ended.message),
                statistics=ended.statistics,
                reached=ended.end_time,
                balance=ended.balance,
                extremes=ended.extremes,
                checkpoint=ended.checkpoint,
            )
        )

    def _dataset(self, solution: Solution) -> xr.Dataset:
        """Label a solution, and say what the run goes on from."""
        ds = to_dataset(self._scene, replace(solution, start=self._start.time))
        return ds.assign_attrs(started_attributes(self._start))


def begun(kind: type[Kept], target: Path, attributes: Mapping[Any, Any], numbers: int) -> Kept:
    """Make the journal of a run, in the place of an archive that may be replaced; the run has so many samples in all.

    Raises
    ------
    SolverError
        If the disk does not take it.
    """
    try:
        refuse_too_small(target.parent, 8 * numbers)
        journal = kind.create(target, attributes)
        target.unlink(missing_ok=True)
    except OSError as error:
        raise SolverError(
            f"the archive {target} could not be made ({error.strerror or error})",
            time=0.0,
            state={},
            last_event="none",
            advice="free some space, or reduce the number of samples (run.samples)",
        ) from error
    return journal


def taken_up(
    kind: type[Kept], target: Path, scene: Scene, start: engine.Start, backend: str
) -> tuple[Kept, str]:
    """Open the journal that is there, and make sure that it is of this very run; with the driver it was begun with.

    Raises
    ------
    SceneError
        If it is of another run, or damaged, or the driver is another.
    """
    beside = journal_of(target)
    try:
        journal = kind(beside, "a")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        allowed = (
            f"cannot be resumed from {beside.name} ({reason}): start anew with --overwrite (overwrite=True)"
        )
        raise SceneError("archive", target, allowed) from error
    try:
        _refuse_other(target, journal.attributes, scene, start)
        backend = _same_backend(backend, str(journal.attributes["backend"]))
        engine.choose_backend(backend, scene.run.method)
    except BaseException:
        journal.close()
        raise
    return journal, backend


def left_of(target: Path) -> xr.Dataset:
    """Read the journal of a run that has been left; its claim lasts until the error is there."""
    ds = open_archive(target)
    ds.attrs |= {"status": "interrupted", "message": f"{ds.attrs['message']}{RESUMABLE}"}
    return ds


def _is_end(time: float, duration: float) -> bool:
    """Whether a run's time, which went through its time unit and back, is the end of it."""
    return math.isclose(time, duration, rel_tol=1e-12)


def finished_before(target: Path, scene: Scene, start: engine.Start) -> xr.Dataset:
    """Open the archive of this very run, which is at its end; refuse any other."""
    ds = open_archive(target)
    try:
        _refuse_other(target, ds.attrs, scene, start)
        if (status := ds.attrs["status"]) != "finished":
            allowed = f"has ended early ({status}): there is nothing to go on with"
            raise SceneError("archive", target, allowed)
    except BaseException:
        ds.close()
        raise
    return ds


def _refuse_other(target: Path, attributes: Mapping[str, Any], scene: Scene, start: engine.Start) -> None:
    """Refuse to resume a run with another scene, start or version, by the attributes of what is there."""
    differing = first_difference(json.loads(attributes["scene"]), scene.to_dict())
    refusal = ""
    if differing or "swept" in attributes:
        what = f"of another scene ({differing[0]} differs)" if differing else ""
        what = "of a sweep" if "swept" in attributes else what
        refusal = f"is {what}: resume with the scene it was begun with, or name another archive"
    elif attributes["status"] == "running" and attributes["product_version"] != __version__:
        refusal = f"was begun by gearidae {attributes['product_version']}, which alone can go on with it"
    elif attributes.get("started_from", "") != started_attributes(start).get("started_from", ""):
        refusal = "began elsewhere: resume with the run that it went on from (--start, start=)"
    if refusal:
        raise SceneError("archive", target, refusal)


def drop(beside: Path) -> None:
    """Delete a journal that nobody needs any more; Windows keeps one that somebody reads."""
    with suppress(PermissionError):
        beside.unlink(missing_ok=True)


def _same_backend(backend: str, begun: str) -> str:
    """Go on with the backend that the run was begun with: another would take other steps."""
    if backend not in ("auto", begun):
        raise SceneError("backend", backend, f"the run was begun with {begun}, and goes on with nothing else")
    return begun
