r"""Outlines of all gears of a train, placed by the centres of their shafts.

Each gear is that of one of its meshes (the one that drives it, if there is one), as `gearidae.plot.tooth_shape` lays it
out: with the pitch point as origin, the driver above it, turning counter-clockwise. A mesh whose driver turns clockwise
is the mirror image of that about its line of centres, which is then turned to its angle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearidae.arrays import Floats
from gearidae.plot.tooth_shape import gear_picture
from gearidae.scene.train import Train, TrainMesh

_MARK = 2.0
"""Modules below its tip at which tooth 0 is marked."""


@dataclass(frozen=True, slots=True)
class PlacedGear:
    """A gear of a train in the frame of the train, as it stands unturned; lengths in m.

    Attributes
    ----------
    name : str
    shaft : int
        Number of its shaft.
    plane : int
        Gears that mesh lie in one plane; those of a shaft with several lie in several.
    centre : ndarray, shape (2,)
        Of its shaft.
    points : ndarray, shape (n, 2)
        Outline about the centre, tooth 0 first, all teeth alike.
    teeth : int
    mark : ndarray, shape (2,)
        Foot of tooth 0.
    pitch_radius, tip_radius : float
    sense : int
        1 counter-clockwise, -1 clockwise.
    """

    name: str
    shaft: int
    plane: int
    centre: Floats
    points: Floats
    teeth: int
    mark: Floats
    pitch_radius: float
    tip_radius: float
    sense: int

    def outline(self, angle: float) -> Floats:
        """Outline after the shaft has turned by an angle [rad] in its own forward sense, shape (n, 2) [m]."""
        return self._turned(self.points, angle)

    def mark_at(self, angle: float) -> Floats:
        """Foot of tooth 0 then, shape (2,) [m]."""
        return self._turned(self.mark, angle)

    def _turned(self, points: Floats, angle: float) -> Floats:
        turned: Floats = self.centre + points @ _rotation(self.sense * angle)
        return turned


def train_gears(train: Train, errors: Floats) -> tuple[PlacedGear, ...]:
    """Lay out the gears of a train, those of one plane after those of another.

    Parameters
    ----------
    train : Train
    errors : ndarray, shape (meshes,)
        Transmission errors with all shafts unturned [m].

    Returns
    -------
    tuple of PlacedGear
    """
    planes = _planes(train)
    placed: dict[str, PlacedGear] = {}
    for driven in (True, False):
        for mesh, error in zip(train.meshes, errors, strict=True):
            name = mesh.driven if driven else mesh.driver
            if name not in placed:
                placed[name] = _placed(train, mesh, float(error), planes[name], driven=driven)
    return tuple(sorted(placed.values(), key=lambda gear: gear.plane))


def errors_before_turning(train: Train, angles: Floats, errors: Floats) -> Floats:
    """Transmission errors that a train has with all its shafts unturned, as its outlines need them.

    Parameters
    ----------
    angles : ndarray, shape (shafts,)
        At any time [rad].
    errors : ndarray, shape (meshes,)
        Transmission errors at that time [m].

    Returns
    -------
    ndarray, shape (meshes,)
        [m].
    """
    unturned: Floats = errors - [
        mesh.geometry.base_radius_pinion * angles[mesh.a] - mesh.geometry.base_radius_gear * angles[mesh.b]
        for mesh in train.meshes
    ]
    return unturned


def pitch_point(train: Train, mesh: TrainMesh) -> Floats:
    """Where the pitch circles of a mesh touch, in the frame of the train, shape (2,) [m]."""
    radius = 0.5 * mesh.geometry.module * mesh.geometry.pinion_teeth
    along = np.array([math.cos(mesh.angle), math.sin(mesh.angle)])
    point: Floats = np.array(train.shafts[mesh.a].centre) + radius * along
    return point


def _placed(train: Train, mesh: TrainMesh, error: float, plane: int, *, driven: bool) -> PlacedGear:
    geometry = mesh.geometry
    # half of the backlash each: a gear that is driven in one mesh drives in another, and its phases count on it
    sizes = mesh.mesh.backlash, mesh.mesh.tip_relief_radius, mesh.surface.roughness
    picture = gear_picture(geometry, sizes, of_gear=0.5)
    wheel = picture.gear if driven else picture.pinion
    shaft = mesh.b if driven else mesh.a
    turned = picture.turned(mesh.phase * geometry.base_pitch, error)[driven]
    points = wheel.outline(turned) - np.array([0.0, wheel.centre])
    mirrored = points * np.array([train.shafts[mesh.a].sense, 1.0])
    # the driver, which stands above the pitch point, comes to stand behind it
    points = mirrored @ _rotation(mesh.angle + 0.5 * math.pi)
    tip = points[len(wheel.tooth) // 2]
    return PlacedGear(
        name=mesh.driven if driven else mesh.driver,
        shaft=shaft,
        plane=plane,
        centre=np.array(train.shafts[shaft].centre),
        points=points,
        teeth=wheel.teeth,
        mark=tip * (1.0 - _MARK * geometry.module / wheel.tip_radius),
        pitch_radius=abs(wheel.centre),
        tip_radius=wheel.tip_radius,
        sense=train.shafts[shaft].sense,
    )


def _planes(train: Train) -> dict[str, int]:
    """Number of the plane of each gear: that of the first mesh which it is joined with."""
    plane: dict[str, int] = {}
    for number, mesh in enumerate(train.meshes):
        known = {plane[name] for name in (mesh.driver, mesh.driven) if name in plane}
        common = min(known, default=number)
        plane |= {name: common for name, before in plane.items() if before in known}
        plane |= dict.fromkeys((mesh.driver, mesh.driven), common)
    return plane


def _rotation(angle: float) -> Floats:
    """Matrix by which rows of points are turned counter-clockwise."""
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, sin], [-sin, cos]])
