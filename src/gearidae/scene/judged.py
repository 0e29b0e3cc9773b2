"""The shaft of a train by which a run is judged, and the mesh that drives it, whose pitch counts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearidae.errors import SceneError
from gearidae.scene.group import did_you_mean

if TYPE_CHECKING:
    from gearidae.scene.scene import Scene, TrainScene


def judged_shaft(scene: TrainScene) -> int:
    """Number of the shaft that is judged: ``run.judged``, by default that of the load.

    Raises
    ------
    SceneError
        If there is no shaft of that name.
    """
    name, names = scene.run.judged, [*scene.shafts]
    if name is None:
        return scene.train.load
    if name not in names:
        raise SceneError(
            "run.judged", name, did_you_mean(name, names) or f"must be one of {', '.join(names)}"
        )
    return names.index(name)


def judged_mesh(scene: TrainScene) -> int:
    """Number of the first mesh that drives the judged shaft; of the drive's own shaft, the first that it drives."""
    shaft, meshes = judged_shaft(scene), scene.train.meshes
    driven = [k for k, mesh in enumerate(meshes) if mesh.b == shaft]
    return (driven or [k for k, mesh in enumerate(meshes) if mesh.a == shaft])[0]


def judged_pitch(scene: TrainScene) -> float:
    """Pitch of the judged shaft [rad]: that of its gear in the mesh that counts."""
    mesh = scene.train.meshes[judged_mesh(scene)]
    driven = mesh.b == judged_shaft(scene)
    return 2.0 * math.pi / (mesh.geometry.gear_teeth if driven else mesh.geometry.pinion_teeth)


def refuse_judged(scene: Scene) -> None:
    """Refuse ``run.judged`` in a scene whose shafts have no names.

    Raises
    ------
    SceneError
        If it is given.
    """
    if scene.run.judged is not None:
        raise SceneError("run.judged", scene.run.judged, "is of a train: of a pair the gear is judged")
