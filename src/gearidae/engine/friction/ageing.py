"""Friction of the joints of a pair at a state: hubs and pin, whose coefficients grow with the age of their contacts.

The law is that of `gearidae.laws.joint_law`. An age is no state of the solver, whose equations stay the four of the
motion, but a function of the state and of what was at the last accepted time, as the turning gap of a pair is. The way
of a joint is a state already; between both ends of a step it is the cubic with their speeds, and the exponentials are
integrated by Lobatto's rule. An error of order five in a step is left, below that of the motion, and none at constant
speed; no step is made shorter for it.
"""

from __future__ import annotations

from typing import TypeAlias

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import FRICTION
from gearidae.engine.model.state import DRIVE, LOAD, PHASE, Floats, Model, U, W
from gearidae.engine.pairs.mesh_error import pinion_speed
from gearidae.laws.friction_law import slip_of
from gearidae.laws.joint_law import (
    JointFriction,
    aged_friction,
    fresh_friction,
    friction_rate,
    later_age,
    rise_at,
)
from gearidae.laws.joints import PIN, SHAFT_OF_JOINT

OfJoints: TypeAlias = tuple[JointFriction, JointFriction, JointFriction]
"""Of the hubs, by their shafts, and of the pin."""


@compiled(inline=True)
def joint_friction(m: Model, t: float, y: Floats) -> OfJoints:
    """Friction of the joints at a state; of joints that do not age that of the scene."""
    if m.scene.friction.ages != 0:
        return _of_rises(m, _rises(m, t, y))
    return fresh_friction(m, DRIVE), fresh_friction(m, LOAD), fresh_friction(m, PIN)


@compiled
def _of_rises(m: Model, rises: tuple[float, float, float]) -> OfJoints:
    """Friction of the joints for what their coefficients have risen by."""
    return (
        aged_friction(m, DRIVE, rises[DRIVE]),
        aged_friction(m, LOAD, rises[LOAD]),
        aged_friction(m, PIN, rises[PIN]),
    )


@compiled
def joint_friction_rate(m: Model, t: float, y: Floats) -> OfJoints:
    """Rate of `joint_friction` along the motion; zero of joints that do not age."""
    still = JointFriction(0.0, 0.0)
    if m.scene.friction.ages == 0:
        return still, still, still
    motion = _base_circles(m, y)
    ages, speeds = _ages(m, t, motion), _ways(m, motion)[1]
    return (
        friction_rate(m, DRIVE, ages[DRIVE], speeds[DRIVE]),
        friction_rate(m, LOAD, ages[LOAD], speeds[LOAD]),
        friction_rate(m, PIN, ages[PIN], speeds[DRIVE]),
    )


@compiled_once(FRICTION)
def coefficients(m: Model, t: float, y: Floats) -> tuple[float, float, float]:
    """Coefficients of friction of the joints."""
    joint, rises = m.scene.friction.joint, _rises(m, t, y)
    return (
        joint[DRIVE].coefficient + rises[DRIVE],
        joint[LOAD].coefficient + rises[LOAD],
        joint[PIN].coefficient + rises[PIN],
    )


@compiled_once(FRICTION)
def _rises(m: Model, t: float, y: Floats) -> tuple[float, float, float]:
    """By how much the coefficients of the joints have risen."""
    joint, ages = m.scene.friction.joint, _ages(m, t, _base_circles(m, y))
    return (
        rise_at(joint[DRIVE], ages[DRIVE]),
        rise_at(joint[LOAD], ages[LOAD]),
        rise_at(joint[PIN], ages[PIN]),
    )


@compiled_once(FRICTION)
def follow_ageing(m: Model, t: float, y: Floats) -> None:
    """Take the ages of an accepted time over, with the directions of slip that the step had."""
    motion = _base_circles(m, y)
    ages = _ages(m, t, motion)
    for joint in range(len(SHAFT_OF_JOINT)):
        m.state.ageing.age[joint] = ages[joint]
    _note(m, t, motion)


@compiled_once(FRICTION)
def begin_ageing(m: Model, t: float, y: Floats) -> None:
    """Note ways and speeds of a state whose ages are known."""
    _note(m, t, _base_circles(m, y))


@compiled(inline=True)
def _note(m: Model, t: float, motion: tuple[float, float, float, float]) -> None:
    ageing = m.state.ageing
    ageing.time = t
    ageing.way[0], ageing.way[1], ageing.speed[0], ageing.speed[1] = motion


@compiled
def _base_circles(m: Model, y: Floats) -> tuple[float, float, float, float]:
    """Ways and speeds of the base circles of pinion and gear."""
    gear = y[PHASE] / m.scene.phase_rate
    surface_speed, e = pinion_speed(m, y)
    return gear + y[U] + e.value, gear, surface_speed, y[W]


@compiled
def _ways(
    m: Model, motion: tuple[float, float, float, float]
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Ways since the last accepted time and speeds, of pinion and gear in their directions of slip; 0 of what is held.

    Just behind a reversal that is still to be found a way is below zero, so that nothing has a corner there.
    """
    x, z, surface_speed, w = motion
    slip, gear_slip, ageing = m.state.pinion_slip, m.state.slip, m.state.ageing
    ways = slip * (x - ageing.way[0]), gear_slip * (z - ageing.way[1])
    return ways, (slip * surface_speed, gear_slip * w)


@compiled
def _ages(m: Model, t: float, motion: tuple[float, float, float, float]) -> tuple[float, float, float]:
    """Ages of the contacts of the joints."""
    ways, speeds = _ways(m, motion)
    return (
        _age(m, DRIVE, t, ways[DRIVE], speeds[DRIVE]),
        _age(m, LOAD, t, ways[LOAD], speeds[LOAD]),
        _age(m, PIN, t, ways[DRIVE], speeds[DRIVE]),
    )


@compiled
def _age(m: Model, joint: int, t: float, way: float, speed: float) -> float:
    """Age of the contacts of a joint, for way and speed of its shaft's base circle."""
    ageing, shaft = m.state.ageing, SHAFT_OF_JOINT[joint]
    before, forgetting = slip_of(m, shaft) * ageing.speed[shaft], m.scene.friction.joint[joint].forgetting
    return later_age(ageing.age[joint], t - ageing.time, way, before, speed, forgetting)
