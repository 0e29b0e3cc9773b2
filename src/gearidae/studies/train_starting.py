"""Starting torque of a train without inertia: what dry loads, adhesion in each mesh and each hub take of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.runs.train_release import TrainRelease
from gearidae.runs.train_statics import starting_torque
from gearidae.studies.bracket import crossing

if TYPE_CHECKING:
    from gearidae.scene import TrainScene


def require_static(scene: TrainScene) -> TrainScene:
    """Refuse trains whose starting torque has no closed form.

    Raises
    ------
    SceneError
        Naming the key.
    """
    if loops := scene.train.loops:
        allowed = "must be left out: a loop shares its load by the compliance of its teeth"
        raise SceneError("meshes", f"(loop {', '.join(loops[0])})", allowed)
    if scene.drive.law is not None:
        allowed = "must be left out: its force would load the hub of the drive"
        raise SceneError("drive.law.name", scene.drive.law.name, allowed)
    return scene


def static_start(scene: TrainScene, impacts: int, lowest: float) -> tuple[float, Floats]:
    """Smallest torque of the drive at which a train passes its mesh exits in slow motion.

    Parameters
    ----------
    scene : Scene
        A train without loops.
    impacts : int
        Exits of each mesh that press its contacts deeper.
    lowest : float
        Smallest torque beyond that of dry loads and hubs that is searched for [N m].

    Returns
    -------
    torque : float
        [N m]; that of dry loads and hubs where adhesion does not hold the train at the lowest torque, infinite where it
        holds it at any, or a hub locks.
    held : ndarray, shape (meshes,)
        Forces with which adhesion holds the driven gear of each mesh [N] at the place where the torque is needed.
    """
    dry, nothing = starting_torque(scene)[0], np.zeros(len(scene.meshes))
    if math.isinf(dry):
        return dry, nothing
    release = TrainRelease(scene, impacts)
    more = crossing(lambda torque: -release.resistance(dry + torque).missing, lowest)
    if more == 0.0 or math.isinf(more):
        return dry + more, nothing
    held = release.resistance(dry + more).held
    return starting_torque(scene, held)[0], held


def part_names(scene: TrainScene) -> list[str]:
    """Names of the parts of a train that take its starting torque, in the order in which they are added up."""
    hubs = [name for name, shaft in scene.shafts.items() if shaft.hub is not None]
    return [
        "dry resistance",
        *(f"adhesion of {name}" for name in scene.meshes),
        *(f"hub of {name}" for name in hubs),
    ]


def train_parts(scene: TrainScene, held: Sequence[float] | Floats) -> Floats:
    """Divide the starting torque of a train into `part_names`.

    Returns
    -------
    ndarray, shape (parts,)
        Torque at the drive that each part adds to those before it [N m]; the sum is the starting torque.
    """
    count, forces = len(scene.meshes), np.asarray(held, dtype=np.float64)
    hubs = [number for number, shaft in enumerate(scene.shafts.values()) if shaft.hub is not None]
    sums = [starting_torque(scene, forces * (np.arange(count) < k), hubs=())[0] for k in range(count + 1)]
    sums += [starting_torque(scene, forces, hubs=hubs[:k])[0] for k in range(1, len(hubs) + 1)]
    return np.diff(np.array(sums), prepend=0.0)
