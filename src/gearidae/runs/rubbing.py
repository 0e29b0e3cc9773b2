"""What friction of the flanks and the joints takes, estimated in closed form for a scene, and where it locks them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.mesh.friction import hub_share, locking_coefficients, loss_fraction
from gearidae.mesh.pair_contact import pair_contact
from gearidae.scene.friction import friction_values, has_flank_friction
from gearidae.scene.joints import Joint, has_pin, joints
from gearidae.scene.validity_row import ValidityRow
from gearidae.torques import torque_law

if TYPE_CHECKING:
    from gearidae.scene import GearScene, Scene


_ANGLES: Final = 360
"""Angles in a turn at which the force of a torque law is looked at."""


def flank_coefficient(scene: Scene, load: float) -> float:
    """Friction of a pair of flanks over the force that presses them together.

    Parameters
    ----------
    scene : Scene
        A gear pair.
    load : float
        Force of the pair [N].

    Returns
    -------
    float
        Of materials with different coefficients, the mean by the forces that they carry at the pair's resting gap, 0 or
        more; by their shares where no gap carries the load. Of the law ``shear``, strength times area over the force
        there; NaN where no gap carries the load.
    """
    if not has_flank_friction(scene):
        return 0.0
    values, contact = friction_values(scene), pair_contact(scene)
    shear, there = scene.contact.friction_law == "shear", [values[part.name] for part in contact.parts]
    if not shear and len(set(there)) == 1:
        return there[0]
    gap = contact.resting_gap(load)
    if math.isnan(gap):
        return math.nan if shear else sum(values[part.name] * part.share for part in contact.parts)
    counted = contact.part_areas(gap) if shear else contact.part_forces(gap)
    return max(sum(value * amount for value, amount in zip(there, counted, strict=True)) / load, 0.0)


def flank_loss(scene: Scene, load: float) -> float:
    """Share of the drive's work that friction of the flanks takes at a constant force [N]; NaN if nothing is known."""
    coefficient = flank_coefficient(scene, load)
    return loss_fraction(scene.geometry, coefficient) if coefficient != 0.0 else 0.0


def rested(scene: Scene) -> tuple[Joint, ...]:
    """List the joints with the coefficients that they have after ``initial.rest_time``."""
    age = scene.initial.rest_time if scene.initial is not None else 0.0
    return tuple(joint.of_age(age) for joint in joints(scene))


def sliding(scene: GearScene, gear_speed: float) -> tuple[Joint, ...]:
    """List the joints with the coefficients that they have in steady sliding at a speed of the gear [rad/s]."""
    ratio = scene.gears.gear_teeth / scene.gears.pinion_teeth
    return tuple(
        joint.of_age(joint.sliding_age(gear_speed * (1.0 if joint.name == "gear hub" else ratio)))
        for joint in joints(scene)
    )


def hub_arms(there: Iterable[Joint]) -> tuple[float, float]:
    """Coefficients times radii of the hubs of pinion and gear [m]."""
    arms = {joint.name: joint.arm for joint in there}
    return arms.get("pinion hub", 0.0), arms.get("gear hub", 0.0)


def hub_constants(there: Iterable[Joint]) -> tuple[float, float]:
    """Torques of the hubs of pinion and gear without a load of the teeth: of adhesion and axial loads [N m]."""
    taken = {joint.name: joint.torque(0.0) for joint in there}
    return taken.get("pinion hub", 0.0), taken.get("gear hub", 0.0)


def joint_loads(scene: GearScene, force: float) -> list[tuple[Joint, float]]:
    """List the joints with their mean loads over a turn [N], at a constant force of the teeth [N].

    The force of a pin is that of the torque law at the end of the run.
    """
    pins = _pin_forces(scene)
    line = scene.geometry.pressure_angle + scene.drive.orientation
    on_pinion = pins - force * np.array([math.sin(line), math.cos(line)])
    loads = {
        "pinion hub": float(np.hypot(*on_pinion.T).mean()),
        "gear hub": force,
        "pin": float(np.hypot(*pins.T).mean()),
    }
    return [(joint, loads[joint.name]) for joint in joints(scene)]


def _pin_forces(scene: GearScene) -> Floats:
    """Forces of the drive's law on the pinion at angles all around, shape (n, 2) [N]; zero for a couple."""
    angles = np.linspace(0.0, 2.0 * math.pi, _ANGLES, endpoint=False)
    if not has_pin(scene):
        return np.zeros((1, 2))
    assert scene.drive.law is not None
    law, numbers = torque_law(scene.drive.law.name), np.array(scene.drive.law.numbers())
    function, end = getattr(law.function, "py_func", law.function), scene.run.duration
    values = [
        function(end, angle, 0.0, numbers) if law.takes_angle else function(end, 0.0, numbers)
        for angle in angles
    ]
    return np.array(values, np.float64)[:, 1:]


def transmitted_share(scene: GearScene, load: float, there: Iterable[Joint]) -> float:
    """Share of the drive's work that friction leaves, at a constant force of the teeth and with given joints.

    Returns
    -------
    float
        What the flanks leave times what the hubs leave, 0 or more; flanks of the law ``shear`` count as without
        friction where no gap carries the force.
    """
    loss = flank_loss(scene, load)
    left = 1.0 if math.isnan(loss) else max(1.0 - loss, 0.0)
    return left * hub_share(scene.geometry, 1.0, hub_arms(there))


_NEAR_LOCKING: Final = 0.5
"""Share of the coefficient that locks teeth or hubs, up to which friction changes forces by less than double."""


def locking_rows(scene: GearScene) -> Iterator[ValidityRow]:
    """Compare coefficients of friction with those that lock the teeth or a hub; nothing where they are zero."""
    gears, geometry, values = scene.gears, scene.geometry, friction_values(scene)
    where = max(
        (values[material.name] for material in scene.materials() if material.share > 0.0), default=0.0
    )
    if has_flank_friction(scene) and scene.contact.friction_law == "coulomb":
        locks = min(locking_coefficients(geometry))
        yield _near_locking("locking_teeth", "coefficient of friction of the flanks", where, locks, "teeth")
    bases = {"pinion hub": geometry.base_radius_pinion, "gear hub": geometry.base_radius_gear}
    ratios = [joint.radius / bases[joint.name] for joint in joints(scene) if joint.name in bases]
    highest = gears.hub_friction + gears.hub_friction_rise
    if highest > 0.0 and any(ratios):
        quantity, coefficient = "coefficient of friction of the hubs", highest
        yield _near_locking("locking_hubs", quantity, coefficient, 1.0 / max(ratios), "hubs")


def _near_locking(name: str, quantity: str, coefficient: float, locks: float, what: str) -> ValidityRow:
    holds = coefficient <= _NEAR_LOCKING * locks
    verdict = (
        f"the {what} are far from locking"
        if holds
        else f"near self-locking: the {what} can carry {1.0 / (1.0 - coefficient / locks):.2g} times their load"
    )
    limit = f"{_NEAR_LOCKING * locks:.3g}, half of that which can lock the {what}"
    bound = _NEAR_LOCKING * locks
    return ValidityRow(name, quantity, f"{coefficient:g}", limit, verdict, holds, coefficient, bound, "1")
