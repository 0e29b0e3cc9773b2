"""A run whose output goes straight into its archive, and that can be taken up again after anything."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from gearidae import __version__, engine
from gearidae.archive import GrowingArchive, open_archive, to_dataset
from gearidae.archive.checkpoint import Checkpoint, drop_checkpoints
from gearidae.archive.disk import DiskError
from gearidae.archive.unfinished import RESUMABLE
from gearidae.engine.backend import statistics_of
from gearidae.errors import Interrupted, SceneError, SolverError
from gearidae.progress import RunProgress, run_progress
from gearidae.runs.imbalance import log_imbalance
from gearidae.runs.kept_validity import with_validity
from gearidae.runs.running import early_end, unsolved, watched
from gearidae.runs.starting import started_attributes
from gearidae.scene.differences import first_difference

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.engine import Ended
    from gearidae.records import Block, Solution, Statistics
    from gearidae.scene import Scene

_FREE_SPACE = "free some space and go on with --resume (resume=True)"


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
    unfinished = _found(target, scene, start) if resume and target.exists() else None
    if unfinished is not None and unfinished.attrs["status"] == "finished":
        drop_checkpoints(target)  # a kill may have left one
        return unfinished
    if unfinished is not None:
        backend = _same_backend(backend, str(unfinished.attrs["backend"]))
        unfinished.close()
    run = _Run(scene, target, engine.choose_backend(backend, scene.run.method), start)
    with run.take_up() if unfinished is not None else run.begin() as archive:
        with run_progress(progress, run.end) as report:
            ended = run.follow(archive, report, watched(report, on_block))
        run.leave(archive, ended, compress=compress)
    return open_archive(target)


class _Run:
    """One run into one archive."""

    def __init__(self, scene: Scene, target: Path, backend: str, start: engine.Start) -> None:
        self._scene, self._target, self._backend, self._start = scene, target, backend, start
        self.end = start.time + scene.run.duration
        self._skipped, self._method = engine.outlook(scene, backend, start=start)

    def begin(self) -> GrowingArchive:
        """Make the archive."""
        run = self._scene.run
        try:
            return GrowingArchive.create(self._target, self._template(), run.sample_count, run.duration)
        except DiskError as error:
            raise SolverError(
                f"the archive {self._target} could not be made ({error})",
                time=0.0,
                state={},
                last_event="none",
                advice="free some space, or reduce the number of samples (run.samples)",
            ) from error

    def take_up(self) -> GrowingArchive:
        """Open the archive that is there."""
        try:
            return GrowingArchive(self._target, self._template())
        except DiskError as error:
            raise SceneError("archive", self._target, f"cannot be written ({error})") from error

    def follow(
        self, archive: GrowingArchive, report: RunProgress | None, on_block: engine.OnBlock | None
    ) -> Ended:
        """Run on from the newest checkpoint."""
        reached = self._start.time

        def take(block: Block, statistics: Statistics, wall_time: float) -> None:
            nonlocal reached
            archive.take(block, statistics, wall_time, last=_is_end(block.time, self.end))
            reached = block.time

        try:
            start, point = self._start, archive.go_back()
            if point is not None:
                reached = point.time
                if _is_end(reached, self.end):  # all that is missing is the final form
                    return self._ended_at(point)
                start = replace(
                    start,
                    checkpoint=point.state,
                    reached=reached,
                    wall_time=point.wall_time,
                    events=point.lengths["event"],
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
            raise self._not_written(archive, reached, error) from error

    def leave(self, archive: GrowingArchive, ended: Ended, *, compress: bool) -> None:
        """Put the archive into its final form, or close it as it is for a run that was interrupted.

        Raises
        ------
        SolverError, Interrupted
            If the run did not reach its end.
        """
        if ended.status == "interrupted":
            raise self._interrupted(archive)
        try:
            template = self._template(ended)
            log_imbalance(template)
            archive.finish(template, compress=compress)
        except KeyboardInterrupt:
            raise self._interrupted(archive) from None
        except DiskError as error:
            raise self._not_written(archive, ended.end_time, error) from error
        if ended.status not in ("finished", "stopped"):
            raise early_end(open_archive(self._target), ended.end_time)

    def _interrupted(self, archive: GrowingArchive) -> Interrupted:
        archive.close()
        kept = f"the run up to there is in {self._target}; go on with --resume (resume=True)"
        return Interrupted(kept, self._left())

    def _not_written(self, archive: GrowingArchive, reached: float, error: DiskError) -> SolverError:
        archive.close()
        return early_end(
            self._left(), reached, f"the archive {self._target} could not be written ({error})", _FREE_SPACE
        )

    def _left(self) -> xr.Dataset:
        """Open the archive of a run that has been left; its claim lasts until the error is there."""
        ds = open_archive(self._target)
        ds.attrs |= {"status": "interrupted", "message": f"{ds.attrs['message']}{RESUMABLE}"}
        return ds

    def _ended_at(self, point: Checkpoint) -> Ended:
        """How a run ended of which only the archive's final form was missing."""
        skipped, method = engine.outlook(self._scene, self._backend, point.state, self._start)
        counted = replace(point.statistics, method=method)
        statistics = statistics_of(counted, point.wall_time, self._backend, skipped)
        balance, extremes = engine.kept_at(self._scene, point.state, self._start)
        return engine.Ended(statistics, "finished", "", point.time, balance, extremes, point.state)

    def _template(self, ended: Ended | None = None) -> xr.Dataset:
        """Make the run's dataset, without samples and rows."""
        empty = unsolved("running", "the run is not at its end yet")
        if ended is None:
            statistics = replace(
                empty.statistics, backend=self._backend, method=self._method, skipped=self._skipped
            )
            return self._dataset(replace(empty, statistics=statistics))
        solution = replace(
            empty,
            statistics=ended.statistics,
            status=ended.status,
            message=ended.message,
            reached=ended.end_time,
            balance=ended.balance,
            extremes=ended.extremes,
            checkpoint=ended.checkpoint,
        )
        return self._dataset(solution)

    def _dataset(self, solution: Solution) -> xr.Dataset:
        """Label a solution, and say how far the model holds and what the run goes on from."""
        ds = with_validity(to_dataset(self._scene, replace(solution, start=self._start.time)), self._scene)
        ds.attrs |= started_attributes(self._start)
        return ds


def _is_end(time: float, duration: float) -> bool:
    """Whether a run's time, which went through its time unit and back, is the end of it."""
    return math.isclose(time, duration, rel_tol=1e-12)


def _found(target: Path, scene: Scene, start: engine.Start) -> xr.Dataset:
    """Open the archive to be resumed and make sure that it is of this very run."""
    ds = open_archive(target)
    theirs = json.loads(ds.attrs["scene"])
    differing = first_difference(theirs, scene.to_dict())
    refusal = ""
    if differing or "swept" in ds.attrs:
        what = f"of another scene ({differing[0]} differs)" if differing else ""
        what = "of a sweep" if "swept" in ds.attrs else what
        refusal = f"is {what}: resume with the scene it was begun with, or name another archive"
    elif ds.attrs["status"] in ("running", "interrupted") and ds.attrs["product_version"] != __version__:
        refusal = f"was begun by gearidae {ds.attrs['product_version']}, which alone can go on with it"
    elif ds.attrs["status"] not in ("finished", "running", "interrupted"):
        refusal = f"has ended early ({ds.attrs['status']}): there is nothing to go on with"
    elif ds.attrs.get("started_from", "") != started_attributes(start).get("started_from", ""):
        refusal = "began elsewhere: resume with the run that it went on from (--start, start=)"
    if refusal:
        ds.close()
        raise SceneError("archive", target, refusal)
    return ds


def _same_backend(backend: str, begun: str) -> str:
    """Go on with the backend that the run was begun with: another would take other steps."""
    if backend not in ("auto", begun):
        raise SceneError("backend", backend, f"the run was begun with {begun}, and goes on with nothing else")
    return begun
