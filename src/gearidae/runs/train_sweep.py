"""Runs of trains beside each other: which of them can be put into one dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.errors import SceneError
from gearidae.scene import TrainScene, is_long_train

if TYPE_CHECKING:
    from gearidae.runs.sweep_plan import SweepPlan


def refuse_unlike(plan: SweepPlan) -> None:
    """Refuse runs of trains that cannot be stacked.

    Raises
    ------
    SceneError
        If they differ in names of shafts and meshes, or in the shaft that is driven, loaded or judged.
    """
    if not is_long_train(plan.base):
        return
    layouts = {_layout(scene) for scene in plan.scenes if isinstance(scene, TrainScene)}
    if len(layouts) > 1:
        allowed = "must leave the shafts, the meshes and which shaft is driven, loaded and judged as they are"
        raise SceneError("over", ", ".join(key for axis in plan.axes for key in axis), allowed)


def _layout(scene: TrainScene) -> tuple[object, ...]:
    train = scene.train
    meshes = tuple((mesh.name, mesh.driver, mesh.driven) for mesh in train.meshes)
    return (*scene.shafts, *meshes, train.drive, train.load, scene.run.judged)
