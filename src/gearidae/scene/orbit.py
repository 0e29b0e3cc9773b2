r"""Orbit of the pinion in its hub: a drive that pushes carries the pinion's centre round in the clearance.

The centre stands at the clearance c in the direction of the force P, as long as a journal follows its load: while
:math:`\sqrt{|P|/(m c)}`, with the mass m of the pinion, is well above the speed at which the force turns.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.scene.group import shorten
from gearidae.scene.joints import pushes
from gearidae.scene.pitch_errors import errors_range
from gearidae.torques import torque_law

if TYPE_CHECKING:
    from gearidae.scene.scene import GearScene, Scene

KEY: Final = "gears.pinion_hub_clearance"
_TIMES: Final = 129
"""Times in a run at which the force of the drive is looked at."""
_OTHERS: Final = ((1.0, 0.0), (2.5, 0.0), (0.0, 1e3), (0.0, -1e3))
"""Angles [rad] and speeds [rad/s] at which its direction must be the same."""
_SAME: Final = 1e-9
"""Difference of two directions that is rounding [rad]."""
_APART: Final = 1e-6
"""Of the time between two looks, by which a direction is looked at to either side of a time."""
_SMOOTH: Final = 1e-3
"""Change of the speed of the direction at a knot, over the largest, from which it is a kink."""


def has_orbit(scene: Scene) -> bool:
    """Whether the pinion of a scene orbits in its hub."""
    return scene.gears is not None and scene.gears.pinion_hub_clearance > 0.0


def _force(scene: GearScene, t: float, angle: float = 0.0, speed: float = 0.0) -> tuple[float, float]:
    """Force of the drive's law [N] in its axes, at a time, an angle and a speed of the pinion."""
    law = scene.drive.law
    assert law is not None
    declared, numbers = torque_law(law.name), np.array(law.numbers())
    of_motion = (angle, speed) if declared.takes_angle else (speed,)
    _, x, y = declared.function(t, *of_motion, numbers)
    return float(x), float(y)


def play_at_start(scene: GearScene) -> float:
    """By how much the orbit of the pinion opens the coast gaps at the start [m]; 0 without one."""
    if not has_orbit(scene):
        return 0.0
    (x, y), turned = _force(scene, 0.0), scene.drive.orientation
    along = (x * math.cos(turned) - y * math.sin(turned)) / math.hypot(x, y)
    return -2.0 * scene.gears.pinion_hub_clearance * math.sin(scene.geometry.pressure_angle) * along


def _turned(first: tuple[float, float], second: tuple[float, float]) -> float:
    """Angle from one direction to another [rad]."""
    return math.atan2(
        first[0] * second[1] - first[1] * second[0], first[0] * second[0] + first[1] * second[1]
    )


def _speed(scene: GearScene, t: float, ahead: float) -> float:
    """Angular speed of the direction of the force to one side of a time [rad/s]."""
    at, near, far = (_force(scene, t + k * ahead) for k in range(3))
    return (2.0 * _turned(at, near) - 0.5 * _turned(at, far)) / ahead


def _times(scene: GearScene, begin: float) -> Floats:
    return np.linspace(begin, begin + scene.run.duration, _TIMES)


def fastest_rotation(scene: GearScene, begin: float = 0.0) -> float:
    """Largest angular speed of the direction of the drive's force that looks at a run find [rad/s].

    Parameters
    ----------
    scene : Scene
        Whose pinion orbits.
    begin : float, optional
        Time at which the run begins [s].
    """
    times = _times(scene, begin)
    ahead = _APART * (times[1] - times[0])
    return max(abs(_speed(scene, float(t), -ahead if t > begin else ahead)) for t in times)


def journal_speeds(scene: GearScene) -> tuple[float, float]:
    """Natural angular speed of the journal under the least force, and the fastest turn of that force [rad/s].

    The pinion's mass is that of a solid disc as large as its pitch circle, ``2 I1 cos(alpha)^2 / R1^2``.
    """
    gears, geometry = scene.gears, scene.geometry
    radius = geometry.base_radius_pinion / math.cos(geometry.pressure_angle)
    mass = 2.0 * gears.pinion_inertia / radius**2
    least = min(math.hypot(*_force(scene, float(t))) for t in _times(scene, 0.0))
    return math.sqrt(least / (mass * gears.pinion_hub_clearance)), fastest_rotation(scene)


def check_orbit(scene: GearScene) -> None:
    """Refuse a clearance without a force that turns smoothly, and one in which the teeth would jam.

    Raises
    ------
    SceneError
        Naming ``gears.pinion_hub_clearance``.
    """
    if not has_orbit(scene):
        return
    clearance, drive = scene.gears.pinion_hub_clearance, scene.drive
    shown = shorten(clearance)
    if not pushes(drive) or drive.law is None:
        raise SceneError(
            KEY,
            shown,
            "needs a drive whose law has a force, as microengine: a couple leaves the pinion where it is",
        )
    nearer = 2.0 * clearance * math.sin(scene.geometry.pressure_angle)
    room = scene.mesh.backlash - errors_range(scene)
    if nearer >= room:
        raise SceneError(
            KEY,
            shown,
            f"teeth would jam: the orbit takes {nearer:.4g} m of the backlash, 2 c sin(alpha), and must leave some of"
            f" the {room:.4g} m that the errors of the teeth leave",
        )
    law = drive.law.name
    if torque_law(law).switch is not None:
        raise SceneError(
            KEY, shown, f"the force of the law {law} may jump where it switches: choose another law"
        )
    for t in _times(scene, 0.0).tolist():
        force = _force(scene, t)
        if not math.hypot(*force) > 0.0:
            raise SceneError(
                KEY, shown, f"the force of the drive vanishes at {t:.4g} s, and pushes to no side then"
            )
        for angle, speed in _OTHERS:
            if abs(_turned(force, _force(scene, t, angle, speed))) > _SAME:
                raise SceneError(
                    KEY,
                    shown,
                    f"the direction of the force of the law {law} changes with angle or speed of the pinion, as that of"
                    " springs does: it must depend on time alone",
                )
    _check_knots(scene, shown)


def _check_knots(scene: GearScene, shown: object) -> None:
    """Refuse a law whose direction has a jump or a kink at one of its knots."""
    assert scene.drive.law is not None
    knots, duration = torque_law(scene.drive.law.name).knots, scene.run.duration
    if knots is None:
        return
    times = np.array(knots(np.array(scene.drive.law.numbers()), duration), dtype=np.float64).ravel()
    ahead, fastest = _APART * duration / (_TIMES - 1), fastest_rotation(scene)
    for t in times[(times > 2.0 * ahead) & (times < duration - 2.0 * ahead)].tolist():
        before, behind = _speed(scene, t, -ahead), _speed(scene, t, ahead)
        jumps = (
            abs(_turned(_force(scene, t - ahead), _force(scene, t + ahead))) > 4.0 * ahead * fastest + _SAME
        )
        if jumps or abs(behind - before) > _SMOOTH * fastest + _SAME / ahead:
            raise SceneError(
                KEY,
                shown,
                f"the direction of the drive's force must turn smoothly, and has a jump or a kink at {t:.4g} s",
            )
