"""Joints of gears: the hubs of all shafts, and the pin of a drive that pushes; what follows from them starts here."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Protocol

from gearidae.errors import SceneError
from gearidae.laws.joint_law import JointLaw
from gearidae.laws.law import SHAFT_NAMES
from gearidae.laws.shaft.hub import HUB
from gearidae.laws.shaft.pin import PIN
from gearidae.records.standing import Holding
from gearidae.torques import torque_law

if TYPE_CHECKING:
    from gearidae.scene.gears import Gears
    from gearidae.scene.scene import GearScene, Scene, TrainScene
    from gearidae.scene.torque import Drive


@dataclass(frozen=True, slots=True)
class Joint:
    """A plain bearing whose surfaces slide as a gear turns.

    Attributes
    ----------
    name : str
        "pinion hub", "gear hub" or "pin"; of a train "hub of SHAFT" or "pin".
    coefficient : float
        Of friction of fresh contacts, which slide [1].
    radius : float
        [m].
    rise : float
        By how much the coefficient grows with the time at rest [1].
    ageing_time : float
        Time at rest in which 63 % of the rise are there [s]; infinite without a rise.
    memory_length : float
        Way of the surfaces on which the rise is forgotten [m]; infinite without one.
    adhesion : float
        Part of the load that adhesion adds [N].
    axial_load, dimple_radius : float
        Load along the axis [N], and radius at which dimples carry it [m].
    """

    name: str
    coefficient: float
    radius: float
    _: KW_ONLY
    rise: float = 0.0
    ageing_time: float = math.inf
    memory_length: float = math.inf
    adhesion: float = 0.0
    axial_load: float = 0.0
    dimple_radius: float = 0.0

    @property
    def law(self) -> JointLaw:
        """Kind of the joint."""
        return PIN if self.name == PIN.name else HUB

    @property
    def arm(self) -> float:
        """Torque of friction of fresh contacts over the load across the axis [m]."""
        return self.coefficient * self.radius

    @property
    def largest(self) -> float:
        """Coefficient after a long rest [1]."""
        return self.coefficient + self.rise

    @property
    def holding_torque(self) -> float:
        """Torque over the coefficient without a load across the axis [N m]."""
        return self.radius * self.adhesion + self.dimple_radius * self.axial_load

    @property
    def sliding_radius(self) -> float:
        """Radius at which the surfaces slide [m]: that of the joint, or of its dimples where it has none."""
        return self.radius if self.radius > 0.0 else self.dimple_radius

    @property
    def chatter_speed(self) -> float:
        """Sliding speed [m/s] below which the coefficient has most of its fall, ``D_c/tau``; 0 without a rise."""
        return self.memory_length / self.ageing_time if self.rise > 0.0 else 0.0

    def aged(self, age: float) -> float:
        """Coefficient of contacts of an age [s], ``mu_d + dmu (1 - exp(-theta/tau))``."""
        return self.coefficient - self.rise * math.expm1(-age / self.ageing_time)

    def sliding_age(self, speed: float) -> float:
        """Age of the contacts [s] in steady sliding at an angular speed [rad/s], ``D_c/v``."""
        way = abs(speed) * self.sliding_radius
        return self.memory_length / way if way > 0.0 else math.inf

    @property
    def axial_torque(self) -> float:
        """Torque of friction of the axial load [N m]."""
        return self.coefficient * self.dimple_radius * self.axial_load

    def of_age(self, age: float) -> Joint:
        """Return a joint whose friction does not age, with the coefficient of contacts of an age [s]."""
        return replace(self, coefficient=self.aged(age), rise=0.0) if self.rise > 0.0 else self

    def torque(self, load: float) -> float:
        """Return the torque [N m] that friction takes, or holds, under a load across the axis [N]."""
        return self.arm * (load + self.adhesion) + self.axial_torque

    @property
    def holding(self) -> Holding:
        """What of the joint may hold a gear."""
        holding = Holding(0)
        if self.largest * self.radius > 0.0:
            holding |= self.law.holders[0].number
        if self.largest * self.dimple_radius * self.axial_load > 0.0:
            holding |= HUB.holders[1].number
        return holding


def has_pin(scene: Scene) -> bool:
    """Whether the drive of a scene pushes with a pin: its torque law has a force."""
    return scene.drive is not None and pushes(scene.drive)


def pushes(drive: Drive) -> bool:
    """Whether a drive has a torque law with a force."""
    return drive.law is not None and torque_law(drive.law.name).has_force


class HubFriction(Protocol):
    """Keys of the friction of a hub, which the gears of a pair have for both, and each shaft of a train has."""

    hub_friction: float
    hub_friction_rise: float
    hub_ageing_time: float | None
    hub_memory_length: float | None


def joints(scene: Scene) -> tuple[Joint, ...]:
    """List the joints of a scene that have a radius, or an axial load on dimples; none of a roller."""
    if scene.drive is None:
        return ()
    if scene.gears is not None:
        return _joints_of(scene.gears, scene.drive)
    if scene.shafts is None:
        return ()
    hubs = [shaft.hub_of(name) for name, shaft in scene.shafts.items()]
    return _there(*(hub for hub in hubs if hub is not None), train_pin(scene))


@lru_cache(maxsize=64)
def _joints_of(gears: Gears, drive: Drive) -> tuple[Joint, ...]:
    return _there(*(hub_in(gears, f"{one} hub", f"{one}_") for one in SHAFT_NAMES), _pin(gears, drive))


def _there(*every: Joint) -> tuple[Joint, ...]:
    return tuple(
        joint for joint in every if joint.radius > 0.0 or joint.dimple_radius * joint.axial_load > 0.0
    )


def train_pin(scene: Scene) -> Joint:
    """Pin of the drive of a train, on the shaft that it drives."""
    assert scene.shafts is not None
    assert scene.drive is not None
    return _pin(scene.shafts[scene.train.shafts[scene.train.drive].name], scene.drive)


def hub_in(table: HubFriction, name: str, prefix: str = "") -> Joint:
    """Return the hub of a shaft whose keys begin with a prefix in a table."""
    numbers = {field: getattr(table, prefix + key) for field, key in HUB_KEYS.items()}
    ageing = _ageing(table.hub_friction_rise, table.hub_ageing_time, table.hub_memory_length)
    return Joint(name, table.hub_friction, **numbers, **ageing)


def _pin(hubs: HubFriction, drive: Drive) -> Joint:
    """Pin with the friction of the hubs, or with its own, which does not grow unless it says so."""
    coefficient, rise = drive.pin_friction, drive.pin_friction_rise
    if rise is None:
        rise = hubs.hub_friction_rise if coefficient is None else 0.0
    times = drive.pin_ageing_time, hubs.hub_ageing_time
    lengths = drive.pin_memory_length, hubs.hub_memory_length
    ageing = _ageing(rise, *(first if first is not None else second for first, second in (times, lengths)))
    coefficient = hubs.hub_friction if coefficient is None else coefficient
    return Joint("pin", coefficient, drive.pin_radius, **ageing)


def _ageing(rise: float, time: float | None, length: float | None) -> dict[str, float]:
    """What a joint ages by; scenes are checked for what a rise needs."""
    if time is None or length is None:
        return {"rise": rise}
    return {"rise": rise, "ageing_time": time, "memory_length": length}


HUB_KEYS = {
    "radius": "hub_radius",
    "adhesion": "hub_adhesion",
    "axial_load": "axial_load",
    "dimple_radius": "dimple_radius",
}
"""Numbers of a hub, and their keys of a shaft of a train, which a pair has for its pinion and its gear."""


def ages(scene: Scene) -> bool:
    """Whether friction of a joint of a scene grows with the time at rest."""
    return any(joint.rise > 0.0 for joint in joints(scene))


def has_joint(scene: Scene, law: JointLaw) -> bool:
    """Whether a joint of a kind has friction in a scene."""
    return any(joint.coefficient > 0.0 and joint.law is law for joint in joints(scene))


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
    _check_ageing("gears", scene.gears)
    _check_pin_ageing(scene.drive, scene.gears)
    gears, there = scene.gears, {joint.name: joint for joint in joints(scene)}
    for shaft in SHAFT_NAMES:
        for load, radius in (("hub_adhesion", "hub_radius"), ("axial_load", "dimple_radius")):
            if getattr(gears, f"{shaft}_{load}") > 0.0 and getattr(gears, f"{shaft}_{radius}") == 0.0:
                raise SceneError(f"gears.{shaft}_{radius}", 0.0, f"must be above 0 with gears.{shaft}_{load}")
    for key in ("hub_friction", "hub_friction_rise"):
        if getattr(gears, key) > 0.0 and not there:
            raise SceneError(
                "gears.pinion_hub_radius",
                0.0,
                f"a hub, a dimple or the pin must have a radius with gears.{key}",
            )
    radii = {"pinion": scene.geometry.base_radius_pinion, "gear": scene.geometry.base_radius_gear}
    for shaft, base in radii.items():
        hub = there.get(f"{shaft} hub")
        if hub is not None and hub.largest * hub.radius >= base:
            limit = base / hub.largest
            reason = f"must be below {limit:.4g} m: the hub locks the {shaft} from there on"
            raise SceneError(f"gears.{shaft}_hub_radius", hub.radius, reason)
    _check_circle(scene, [joint for name, joint in there.items() if name != "gear hub"])


def check_train_joints(scene: TrainScene) -> None:
    """Refuse joints of a train without what they need, and a pin that locks the shaft of the drive.

    Raises
    ------
    SceneError
        Naming the key.
    """
    _check_pin(scene)
    for name, shaft in scene.shafts.items():
        _check_ageing(f"shafts.{name}", shaft)
    name = scene.train.shafts[scene.train.drive].name
    _check_pin_ageing(scene.drive, scene.shafts[name])
    hub, pin = scene.shafts[name].hub_of(name), train_pin(scene)
    _check_circle(scene, [pin] if hub is None else [hub, pin])


def _check_pin(scene: GearScene | TrainScene) -> None:
    """Refuse keys of a pin without a law that has a force, and a load with one."""
    drive, load = scene.drive, scene.load
    if load.law is not None and torque_law(load.law.name).has_force:
        raise SceneError(
            "load.law.name", load.law.name, "has a force, which only a drive has: choose another law"
        )
    values = {
        "orientation": drive.orientation,
        "pin_radius": drive.pin_radius,
        **{key: getattr(drive, key) for key in PIN_KEYS},
    }
    for key, value in values.items():
        if value and not pushes(drive):
            raise SceneError(
                f"drive.{key}",
                value,
                "needs a torque law that has a force, as microengine: a couple has no pin",
            )
    for key in PIN_KEYS:
        if getattr(drive, key) and drive.pin_radius == 0.0:
            raise SceneError("drive.pin_radius", 0.0, f"must be above 0 with drive.{key}")


PIN_KEYS = ("pin_friction", "pin_friction_rise", "pin_ageing_time", "pin_memory_length")
"""Keys of the friction of a pin."""


def _check_ageing(table: str, hubs: HubFriction) -> None:
    """Refuse a rise of the friction of hubs, whose keys stand in a table, without a time and a length."""
    _require_ageing(f"{table}.hub", hubs.hub_friction_rise, hubs.hub_ageing_time, hubs.hub_memory_length)


def _check_pin_ageing(drive: Drive, hubs: HubFriction) -> None:
    """Refuse a rise of a pin's friction without a time and a length, which are those of hubs where it has none."""
    time, length = drive.pin_ageing_time, drive.pin_memory_length
    _require_ageing(
        "drive.pin",
        drive.pin_friction_rise,
        time or hubs.hub_ageing_time,
        length or hubs.hub_memory_length,
    )


def _require_ageing(joint: str, rise: float | None, time: float | None, length: float | None) -> None:
    for name, value in (("ageing_time", time), ("memory_length", length)):
        if rise and value is None:
            raise SceneError(f"{joint}_{name}", "(missing)", f"is required with {joint}_friction_rise")


def _check_circle(scene: GearScene | TrainScene, there: Sequence[Joint]) -> None:
    """Refuse a pin whose force can never turn its shaft; laws name the radius of the pin's circle ``radius``."""
    drive = scene.drive
    circle = None if drive.law is None else (drive.law.model_extra or {}).get("radius")
    taken = sum(joint.largest * joint.radius for joint in there)
    if has_pin(scene) and isinstance(circle, float) and taken >= circle:
        whose = "pinion's" if scene.gears is not None else "driven shaft's"
        raise SceneError(
            "drive.pin_radius",
            drive.pin_radius,
            f"friction of the {whose} hub and of the pin takes {taken:.4g} m of the force's arm, which must be below"
            f" drive.law.radius = {circle:.4g} m",
        )
