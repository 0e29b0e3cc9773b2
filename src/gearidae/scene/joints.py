"""Joints of a gear pair: both hubs, and the pin of a drive that pushes; what follows from them starts here."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING

from gearidae.errors import SceneError
from gearidae.records.standing import Holding
from gearidae.torques import torque_law

if TYPE_CHECKING:
    from gearidae.scene.gears import Gears
    from gearidae.scene.scene import GearScene, Scene
    from gearidae.scene.torque import Drive


@dataclass(frozen=True, slots=True)
class Joint:
    """A plain bearing whose surfaces slide as a gear turns.

    Attributes
    ----------
    name : str
        "pinion hub", "gear hub" or "pin".
    coefficient : float
        Of friction [1].
    radius : float
        [m].
    adhesion : float
        Part of the load that adhesion adds [N].
    axial_load, dimple_radius : float
        Load along the axis [N], and radius at which dimples carry it [m].
    """

    name: str
    coefficient: float
    radius: float
    _: KW_ONLY
    adhesion: float = 0.0
    axial_load: float = 0.0
    dimple_radius: float = 0.0

    @property
    def arm(self) -> float:
        """Torque of friction over the load across the axis [m]."""
        return self.coefficient * self.radius

    @property
    def axial_torque(self) -> float:
        """Torque of friction of the axial load [N m]."""
        return self.coefficient * self.dimple_radius * self.axial_load

    def torque(self, load: float) -> float:
        """Return the torque [N m] that friction takes, or holds, under a load across the axis [N]."""
        return self.arm * (load + self.adhesion) + self.axial_torque

    @property
    def holding(self) -> Holding:
        """What of the joint may hold a gear."""
        holding = Holding(0)
        if self.arm > 0.0:
            holding |= Holding.PIN_FRICTION if self.name == "pin" else Holding.HUB_FRICTION
        if self.axial_torque > 0.0:
            holding |= Holding.AXIAL_LOAD
        return holding


def has_pin(scene: Scene) -> bool:
    """Whether the drive of a scene pushes with a pin: its torque law has a force."""
    return scene.drive is not None and pushes(scene.drive)


def pushes(drive: Drive) -> bool:
    """Whether a drive has a torque law with a force."""
    return drive.law is not None and torque_law(drive.law.name).has_force


def joints(scene: Scene) -> tuple[Joint, ...]:
    """List the joints of a scene that have a radius, or an axial load on dimples; none of a roller."""
    gears, drive = scene.gears, scene.drive
    if gears is None or drive is None:
        return ()
    hubs = (_hub(gears, "pinion"), _hub(gears, "gear"))
    coefficient = gears.hub_friction if drive.pin_friction is None else drive.pin_friction
    every = (*hubs, Joint("pin", coefficient, drive.pin_radius))
    return tuple(
        joint for joint in every if joint.radius > 0.0 or joint.dimple_radius * joint.axial_load > 0.0
    )


def _hub(gears: Gears, shaft: str) -> Joint:
    keys = {name: getattr(gears, f"{shaft}_{key}") for name, key in _HUB_KEYS.items()}
    return Joint(f"{shaft} hub", gears.hub_friction, **keys)


_HUB_KEYS = {
    "radius": "hub_radius",
    "adhesion": "hub_adhesion",
    "axial_load": "axial_load",
    "dimple_radius": "dimple_radius",
}
"""Numbers of a hub, and the ends of their keys."""


def has_joint_friction(scene: Scene) -> bool:
    """Whether a joint of a scene has friction."""
    return any(joint.holding for joint in joints(scene))


def check_joints(scene: GearScene) -> None:
    """Refuse joints without what they need, and those that lock.

    Raises
    ------
    SceneError
        Naming the key.
    """
    _check_pin(scene)
    gears, there = scene.gears, {joint.name: joint for joint in joints(scene)}
    for shaft in ("pinion", "gear"):
        for load, radius in (("hub_adhesion", "hub_radius"), ("axial_load", "dimple_radius")):
            if getattr(gears, f"{shaft}_{load}") > 0.0 and getattr(gears, f"{shaft}_{radius}") == 0.0:
                raise SceneError(f"gears.{shaft}_{radius}", 0.0, f"must be above 0 with gears.{shaft}_{load}")
    if gears.hub_friction > 0.0 and not there:
        raise SceneError(
            "gears.pinion_hub_radius",
            0.0,
            "a hub, a dimple or the pin must have a radius with gears.hub_friction",
        )
    radii = {"pinion": scene.geometry.base_radius_pinion, "gear": scene.geometry.base_radius_gear}
    for shaft, base in radii.items():
        hub = there.get(f"{shaft} hub")
        if hub is not None and hub.arm >= base:
            limit = base / hub.coefficient
            reason = f"must be below {limit:.4g} m: the hub locks the {shaft} from there on"
            raise SceneError(f"gears.{shaft}_hub_radius", hub.radius, reason)
    _check_circle(scene, there)


def _check_pin(scene: GearScene) -> None:
    """Refuse keys of a pin without a law that has a force, and a load with one."""
    drive, load = scene.drive, scene.load
    if load.law is not None and torque_law(load.law.name).has_force:
        raise SceneError(
            "load.law.name", load.law.name, "has a force, which only a drive has: choose another law"
        )
    values = {
        "orientation": drive.orientation,
        "pin_radius": drive.pin_radius,
        "pin_friction": drive.pin_friction,
    }
    for key, value in values.items():
        if value and not pushes(drive):
            raise SceneError(
                f"drive.{key}",
                value,
                "needs a torque law that has a force, as microengine: a couple has no pin",
            )
    if drive.pin_friction and drive.pin_radius == 0.0:
        raise SceneError("drive.pin_radius", 0.0, "must be above 0 with drive.pin_friction")


def _check_circle(scene: Scene, there: dict[str, Joint]) -> None:
    """Refuse a pin whose force can never turn the pinion; laws name the radius of the pin's circle ``radius``."""
    drive = scene.drive
    circle = (
        (drive.law.model_extra or {}).get("radius") if drive is not None and drive.law is not None else None
    )
    taken = sum(joint.arm for name, joint in there.items() if name != "gear hub")
    if has_pin(scene) and isinstance(circle, float) and taken >= circle:
        raise SceneError(
            "drive.pin_radius",
            there["pin"].radius if "pin" in there else 0.0,
            f"friction of the pinion's hub and of the pin takes {taken:.4g} m of the force's arm, which must be below"
            f" drive.law.radius = {circle:.4g} m",
        )
