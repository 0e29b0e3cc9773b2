"""Runs of a sweep over trains: each is a dataset of its own, until all are stacked."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import as_completed
from typing import TYPE_CHECKING

from gearidae.archive.train.stack import stack_trains, unfinished
from gearidae.errors import Interrupted, SceneError
from gearidae.progress import sweep_progress
from gearidae.runs.running import is_halted
from gearidae.runs.train_run import run_train
from gearidae.scene import TrainScene

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.runs.execution import Execution
    from gearidae.runs.sweep_plan import SweepPlan


def refuse_unlike(plan: SweepPlan, execution: Execution) -> None:
    """Refuse sweeps over trains that cannot be stacked, and settings that trains do not have.

    Raises
    ------
    SceneError
        If the runs differ in names of shafts and meshes, or in the shaft that is driven, loaded or judged; with
        ``resume``.
    """
    if execution.resume:
        allowed = "is not for trains of several meshes: their runs are kept when all are there"
        raise SceneError("resume", True, allowed)
    layouts = {_layout(scene) for scene in _scenes(plan)}
    if len(layouts) > 1:
        allowed = "must leave the shafts, the meshes and which shaft is driven, loaded and judged as they are"
        raise SceneError("over", ", ".join(key for axis in plan.axes for key in axis), allowed)


def _layout(scene: TrainScene) -> tuple[object, ...]:
    train = scene.train
    meshes = tuple((mesh.name, mesh.driver, mesh.driven) for mesh in train.meshes)
    return (*scene.shafts, *meshes, train.drive, train.load, scene.run.judged)


def run_trains(plan: SweepPlan, execution: Execution) -> xr.Dataset:
    """Compute the runs of a sweep over trains.

    Raises
    ------
    Interrupted
        On Ctrl-C, with the finished runs; the others are marked as unfinished.
    KeyboardInterrupt
        On Ctrl-C before any run is finished.
    """
    scenes = _scenes(plan)
    members: dict[int, xr.Dataset] = {}
    try:
        _compute(scenes, execution, members)
    except KeyboardInterrupt:
        if not members:
            raise
        like = next(iter(members.values()))
        runs = [
            members[number] if number in members else unfinished(like, scene)
            for number, scene in enumerate(scenes)
        ]
        raise Interrupted("", stack_trains(plan.base, plan.axes, scenes, runs)) from None
    return stack_trains(plan.base, plan.axes, scenes, [members[number] for number in range(len(scenes))])


def _scenes(plan: SweepPlan) -> list[TrainScene]:
    return [scene for scene in plan.scenes if isinstance(scene, TrainScene)]


def _compute(scenes: Sequence[TrainScene], execution: Execution, members: dict[int, xr.Dataset]) -> None:
    """Run all scenes; `members` gets each finished run by its number, and keeps these at Ctrl-C."""
    with (
        sweep_progress(execution.progress, len(scenes), lambda: "") as report,
        execution.computing(len(scenes)) as executor,
    ):
        if executor is None:
            for number, scene in enumerate(scenes):
                members[number] = train_member(scene, execution.backend)
                report(len(members), len(scenes))
        else:
            pending = {
                executor.submit(train_member, scene, execution.backend): number
                for number, scene in enumerate(scenes)
            }
            for future in as_completed(pending):
                members[pending[future]] = future.result()
                report(len(members), len(scenes))


def train_member(scene: TrainScene, backend: str) -> xr.Dataset:
    """Run one train of a sweep; the status of a run that could not go on says why."""

    def look(time: float, events: int) -> None:
        if is_halted():
            raise KeyboardInterrupt

    ds = run_train(scene, backend, look)
    if ds.attrs["status"] == "interrupted":
        raise KeyboardInterrupt
    return ds
