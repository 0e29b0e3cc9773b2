"""What can be said of a gear pair on paper, before anything is simulated."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.laws.frictions import mean_limit
from gearidae.laws.law import DRIVE, LOAD
from gearidae.laws.shafts import is_held, slowing
from gearidae.mesh.pair_contact import PairContact, pair_contact
from gearidae.runs.rubbing import hub_constants, sliding, transmitted_share
from gearidae.scene import GearScene, Knots, RollerScene, Scene, require_gears
from gearidae.scene.joints import joints

_PASSES = 200  # to a speed whose friction depends on it
_INNERMOST = -8.0  # a gap in roughnesses: teeth pressed deeper do not rest on their asperities
TURNS_NOTHING = "must turn the gear, or initial.gear_speed be positive"
"""What a drive must do whose mesh exits are waited for."""


@dataclass(frozen=True, slots=True)
class Rest:
    """The contact that estimates are made for: a resting pair of teeth, or a roller at its closest approach.

    Attributes
    ----------
    contact : PairContact
        Of the pair at the pitch point, or of the roller.
    gap : float
        Where it rests under the mean torque, or the roller has come to [m]; NaN where nothing holds it.
    load : float
        Its force there [N].
    mass : float
        What oscillates [kg].
    """

    contact: PairContact
    gap: float
    load: float
    mass: float


def rest_of(scene: Scene, error: float = 1e-12) -> Rest:
    """Find the contact that estimates are made for, its gap to an error in roughnesses; bodies are rigid."""
    contact = pair_contact(scene)
    if isinstance(scene, RollerScene):
        roller = scene.roller
        gap = contact.closest_gap(roller.height, 0.5 * roller.mass * roller.speed**2)
        return Rest(contact, gap, math.nan if math.isnan(gap) else float(contact.force(gap)), roller.mass)
    load = mean_force(require_gears(scene))
    return Rest(contact, contact.resting_gap(load, error), load, effective_mass(scene))


def effective_mass(scene: Scene) -> float:
    """Mass that the transmission error moves.

    Parameters
    ----------
    scene : Scene
        A gear pair.

    Returns
    -------
    float
        ``1 / (R1^2/I1 + R2^2/I2)`` [kg].

    Raises
    ------
    SceneError
        If the scene has no gears.
    """
    gears, geometry = require_gears(scene).gears, scene.geometry
    pinion = geometry.base_radius_pinion**2 / gears.pinion_inertia
    return 1.0 / (pinion + geometry.base_radius_gear**2 / gears.gear_inertia)


def steady_speed(scene: Scene) -> float:
    """Speed of the gear at which the mean torques over the run balance, if nothing sticks.

    Parameters
    ----------
    scene : Scene
        A gear pair.

    Returns
    -------
    float
        w2 of ``(M1 + g (w - w2 R2/R1)) R2/R1 = M2 + c w2 + alpha w2^2`` [rad/s], with the constants and the means of
        the schedules as torques M1 and M2, the viscous drag c and a drive that holds the mean speed w with the gain g;
        0 if the drive does not overcome the dry resistance, infinite if nothing slows the gear down. Friction leaves
        the gear `transmitted_share` of the left side, and takes `hub_constants` besides; friction that ages is that
        of steady sliding, and the highest speed that balances counts. Harmonics and laws are left out. (Teodorescu et
        al. 2009, Eq. 3, prints the ratio upside down.)

    Raises
    ------
    SceneError
        If the scene has no gears.
    """
    scene = require_gears(scene)
    drive = scene.drive
    return balanced_speed(scene, float(_over_run(scene, drive.torque, drive.schedule).mean()))


def waiting_speed(scene: GearScene) -> float:
    """Speed [rad/s] by which a study counts how long mesh exits take: `steady_speed`, or the initial one without any.

    Raises
    ------
    SceneError
        If neither turns the gear on.
    """
    speed = steady_speed(scene)
    if not 0.0 < speed < math.inf:
        speed = scene.initial.gear_speed
    if speed <= 0.0:
        raise SceneError("drive.torque", scene.drive.torque, TURNS_NOTHING)
    return speed


def balanced_speed(scene: GearScene, torque: float) -> float:
    """Speed of the gear [rad/s] at which a constant torque of the pinion [N m] is balanced, see `steady_speed`."""
    load, speed = mean_force(scene), math.inf
    # friction falls with the speed, so that the speeds fall towards the highest that balances
    for _ in range(_PASSES):
        there, before = sliding(scene, speed), speed
        speed = _balance(scene, torque, transmitted_share(scene, load, there), hub_constants(there))
        if speed == before or all(joint.rise == 0.0 for joint in joints(scene)):
            break
    return speed


def _balance(
    scene: GearScene, torque: float, transmitted: float, taken: tuple[float, float] = (0.0, 0.0)
) -> float:
    gears, drive = scene.gears, scene.drive
    ratio = gears.gear_teeth / gears.pinion_teeth
    (at_pinion, _), (at_gear, drag) = slowing(scene, DRIVE), slowing(scene, LOAD)
    held = _mean_size(_over_run(scene, 0.0, drive.speed_knots()))
    driven = torque + drive.speed_gain * held - taken[0] - mean_limit(scene, DRIVE, mean_over_run)
    surplus = driven * ratio * transmitted - mean_limit(scene, LOAD, mean_over_run) - taken[1]
    if surplus <= 0.0 or is_held(scene):
        return 0.0
    linear = at_gear + at_pinion * ratio**2 * transmitted
    slope = linear + math.sqrt(linear**2 + 4.0 * drag * surplus)
    return 2.0 * surplus / slope if slope > 0.0 else math.inf


def mean_over_run(scene: Scene, constant: float, knots: Knots) -> float:
    """Mean size of a constant plus a schedule over the run."""
    return _mean_size(_over_run(scene, constant, knots))


def _over_run(scene: Scene, constant: float, knots: Knots) -> Floats:
    """Return a constant plus a schedule at even times of run or cycle; cubics are taken for straight lines."""
    if not knots:
        return np.array([constant])
    span = min(scene.run.duration, knots.repeat or scene.run.duration)
    table = np.array(knots.during(0.0, span))
    # Between knots the schedule is a straight line: what is off the mean of 4001 values lies below a thousandth.
    times = np.linspace(0.0, span, 4001)
    return np.asarray(constant + np.interp(times, table[:, 0], table[:, 1]), np.float64)


def _mean_size(values: Floats) -> float:
    return float(np.abs(values).mean())


def resting_gap(scene: Scene) -> float:
    """Mean gap at which a single pair, met at the pitch point, carries the mean drive torque of the run.

    Approaching surfaces, no bulk deflection (Teodorescu et al. 2009, Eqs. 12-15).

    Parameters
    ----------
    scene : Scene
        A gear pair.

    Returns
    -------
    float
        Gap [m], the outermost if adhesion allows several; NaN if there is no drive torque to carry or it
        presses the teeth deeper than eight roughnesses.

    Raises
    ------
    SceneError
        If the scene has no gears.
    """
    gap = rest_of(require_gears(scene)).gap
    return gap if gap >= _INNERMOST * scene.surface.roughness else math.nan


def mean_drive_torque(scene: GearScene) -> float:
    """Mean size of the drive torque over the run, harmonics left out.

    Parameters
    ----------
    scene : Scene
        A gear pair.

    Returns
    -------
    float
        Mean over ``run.duration`` of the size of the constant part plus the schedule [N m]; of a drive that holds a
        speed, what the load takes at that speed without friction; of one with a law, at least what the load takes at
        the initial speed.

    Raises
    ------
    SceneError
        If the scene has no gears.
    """
    gears, drive = scene.gears, scene.drive
    mean = _mean_size(_over_run(scene, drive.torque, drive.schedule))
    if drive.speed is None and drive.law is None:
        return mean
    speed = abs(scene.initial.gear_speed) if drive.speed is None else _balance(scene, mean, 1.0)
    linear, quadratic = slowing(scene, LOAD)
    resistance = mean_limit(scene, LOAD, mean_over_run) + speed * (linear + quadratic * speed)
    taken = resistance * gears.pinion_teeth / gears.gear_teeth
    return taken if drive.law is None else max(mean, taken)


def mean_force(scene: GearScene) -> float:
    """Force of the teeth [N] under the `mean_drive_torque`."""
    return mean_drive_torque(scene) / scene.gears.pinion_base_radius
