"""Starting torque of a train without inertia: what dry loads, adhesion in each mesh and each hub take of it.

What a simulated start needs to know of a train besides is its `pitch_of_train`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.runs.train_release import TrainRelease
from gearidae.runs.train_statics import hubs_at_rest, ratios, resistances, starting_torque
from gearidae.scene.judged import judged_shaft
from gearidae.scene.train_pair import rubbing_mesh
from gearidae.studies.bracket import crossing
from gearidae.studies.starting_ramp import Pitch

if TYPE_CHECKING:
    from gearidae.scene import TrainScene


def require_no_loop(scene: TrainScene) -> TrainScene:
    """Refuse trains whose mesh exits cannot be followed in slow motion, as loops share the load.

    Raises
    ------
    SceneError
        Naming the key.
    """
    if loops := scene.train.loops:
        allowed = (
            "must be left out: a loop shares its load by the compliance of its teeth; simulated torques have no such "
            "limit"
        )
        raise SceneError("meshes", f"(loop {', '.join(loops[0])})", allowed)
    return scene


def require_startable(scene: TrainScene) -> TrainScene:
    """Refuse trains whose starting torque is not one number.

    Raises
    ------
    SceneError
        Naming the key.
    """
    if (name := rubbing_mesh(scene)) is not None:
        allowed = f"must be 0 ({name}): what friction of flanks holds is not unique, and a run with a slow ramp tells"
        raise SceneError("contact.friction", scene.contact.friction, allowed)
    if scene.drive.law is not None:
        allowed = "must be left out: its force would load the hub of the drive"
        raise SceneError("drive.law.name", scene.drive.law.name, allowed)
    return scene


def static_start(scene: TrainScene, impacts: int, lowest: float) -> tuple[float, Floats]:
    """Smallest torque of the drive at which a train passes its mesh exits in slow motion.

    Parameters
    ----------
    scene : Scene
        A train.
    impacts : int
        Exits of each mesh that press its contacts deeper.
    lowest : float
        Smallest torque beyond that of dry loads and hubs that is searched for [N m].

    Returns
    -------
    torque : float
        [N m]; that of dry loads and hubs where adhesion does not hold the train at the lowest torque, infinite where it
        holds it at any, or a hub locks; NaN of a train with loops, see `require_no_loop`.
    held : ndarray, shape (meshes,)
        Forces with which adhesion holds the driven gear of each mesh [N] at the place where the torque is needed.
    """
    nothing = np.zeros(len(scene.meshes))
    if scene.train.loops:
        return math.nan, nothing
    dry = starting_torque(scene)[0]
    if math.isinf(dry):
        return dry, nothing
    release = TrainRelease(scene, impacts)
    more = crossing(lambda torque: -release.resistance(dry + torque).missing, lowest)
    if more == 0.0 or math.isinf(more):
        return dry + more, nothing
    held = release.resistance(dry + more).held
    return starting_torque(scene, held)[0], held


def pitch_of_train(scene: TrainScene) -> Pitch:
    """Return the pitch of a train, at its judged shaft, of the mesh that turns slowest beside it."""
    train = scene.train
    ratio = ratios(train)
    over = ratio / ratio[judged_shaft(scene)]
    angle = max(2.0 * math.pi / (mesh.geometry.gear_teeth * over[mesh.b]) for mesh in train.meshes)
    inertia = float(np.array([shaft.inertia for shaft in train.shafts]) @ over**2)
    _, viscous, drag = resistances(scene)
    return Pitch(
        angle=angle,
        inertia=inertia,
        ratio=float(over[train.drive]),
        dry=starting_torque(scene)[0],
        viscous=float(viscous @ over**2),
        drag=float(drag @ over**3),
    )


def part_names(scene: TrainScene) -> list[str]:
    """Names of the parts of a train that take its starting torque, in the order in which they are added up."""
    hubs = [name for name, hub in zip(scene.shafts, hubs_at_rest(scene), strict=True) if hub is not None]
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
    hubs = [number for number, hub in enumerate(hubs_at_rest(scene)) if hub is not None]
    sums = [starting_torque(scene, forces * (np.arange(count) < k), hubs=())[0] for k in range(count + 1)]
    sums += [starting_torque(scene, forces, hubs=hubs[:k])[0] for k in range(1, len(hubs) + 1)]
    return np.diff(np.array(sums), prepend=0.0)
