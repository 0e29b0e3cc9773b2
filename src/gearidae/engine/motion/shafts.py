"""Forces at both shafts and what follows of them: one assembly, and one set of slopes for all that solves equations."""

from __future__ import annotations

import math
from typing import NamedTuple

from gearidae.compiled import compiled, compiled_once, name_type
from gearidae.engine.compiling import FRICTION
from gearidae.engine.friction.forces import (
    Slopes,
    friction_slopes,
    own_limit,
    rubbed_accelerations,
    solve_shafts,
    with_acting,
)
from gearidae.engine.friction.pairs import direction, levers, set_limits
from gearidae.engine.laws.pairs import mesh_by_rate, mesh_force
from gearidae.engine.model.record_types import AT_REST, FREE, HELD_GEAR, HELD_PAIR
from gearidae.engine.model.state import DRIVE, LOAD, PHASE, Floats, Model, U, V, W
from gearidae.engine.motion.pair_forces import forces_at
from gearidae.engine.pairs.mesh_error import MeshError, speed_and_error
from gearidae.engine.pairs.pair_force import MeshForces
from gearidae.engine.pairs.shaft_angle import torque_angle
from gearidae.laws.shafts import by_angle, by_speed, pinion_force

name_type(Slopes(*(0.0,) * 11), "Slopes")


class Shafts(NamedTuple):
    """Both shafts at a state, without friction and without what acts on the gear's shaft.

    Attributes
    ----------
    surface_speed : float
        Surface velocity of the pinion.
    pinion, gear : float
        Forces at the base circles.
    error : MeshError
        Of the mesh.
    """

    surface_speed: float
    pinion: float
    gear: float
    error: MeshError


@compiled(inline=True)
def shafts_at(m: Model, t: float, y: Floats, mesh: MeshForces) -> Shafts:
    """Put the forces of the mesh, its damping and the torques on the pinion on both shafts."""
    force = mesh_force(m, y[V], mesh.force)
    surface_speed, e = speed_and_error(m, y)
    drive = pinion_force(m, t, torque_angle(m, DRIVE, y[U], y[PHASE]), surface_speed)
    return Shafts(surface_speed, drive - (1.0 - e.pinion) * force, (1.0 + e.gear) * force + mesh.relief, e)


@compiled(inline=True)
def resisting_force(m: Model, t: float, y: Floats) -> float:
    """What resists the gear over R2, scaled: what acts on its shaft, and its laws' limit against its slip (Eq. 2)."""
    return m.state.slip * own_limit(m, LOAD, t, y, y[W]) - with_acting(m, t, y, -0.0)


@compiled(inline=True)
def accelerations(m: Model, t: float, y: Floats, s: Shafts) -> tuple[float, float]:
    """Accelerations of both base circles, with friction and the resistance at the gear."""
    if m.scene.friction.any_friction != 0:
        return rubbed_accelerations(m, t, y, s.surface_speed, s.pinion, s.gear)
    pinion, gear = m.scene.pinion_inverse_mass * s.pinion, 0.0
    if m.state.hold == FREE:
        gear = m.scene.gear_inverse_mass * (s.gear - resisting_force(m, t, y))
    elif m.state.hold == AT_REST:
        pinion = 0.0
    return pinion, gear


# -- slopes ----------------------------------------------------------------------------------------------------------


class AccelerationSlopes(NamedTuple):
    """Partial derivatives of the accelerations of both base circles in u, v, phase and w, and in forces on them.

    Attributes
    ----------
    by_pinion, by_both, by_gear : float
        Inverse mass matrix of what is free to move: entries of the pinion, off the diagonal, and of the gear.
    pinion_by_speed : float
        Slope in the pinion's own speed of the torque on it, which is in both its slopes.
    gear_by_travel : float
        Slope of the gear's acceleration in its travel, of the laws of its shaft; the slope in the phase contains it.
    """

    pinion_u: float
    pinion_v: float
    pinion_phase: float
    pinion_w: float
    gear_u: float
    gear_v: float
    gear_phase: float
    gear_w: float
    by_pinion: float
    by_both: float
    by_gear: float
    pinion_by_speed: float
    gear_by_travel: float


@compiled_once(FRICTION)
def _friction_slopes(m: Model, y: Floats) -> Slopes:
    """Slopes of the friction of the forces that have been noted last, whose limits have been set."""
    return friction_slopes(m, y)


@compiled_once(FRICTION)
def note_limits(m: Model, t: float, y: Floats) -> None:
    """Set the limits of friction of the forces that have been noted last."""
    set_limits(m, t, y[W])


@compiled(inline=True)
def acceleration_slopes(m: Model, y: Floats, mesh: MeshForces) -> AccelerationSlopes:
    """Slopes of the accelerations, from the slopes of the forces that `mesh_forces` has just summed.

    The slopes of the mesh's error are left out: it is small, and these only steer Newton's iteration. So are the slopes
    of a torque in angle and speed where its law says none: a shaft takes many steps to follow a mild law, and each
    iteration reduces what is left by the ratio of a step to that time.
    """
    f = Slopes(
        m.scene.pinion_inverse_mass,
        0.0,
        m.scene.gear_inverse_mass if m.state.hold == FREE else 0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    )
    if m.scene.friction.any_friction != 0:
        f = _friction_slopes(m, y)
    surface_speed, damping = y[V] + y[W], mesh_by_rate(m, 0.0)
    pinion_u, pinion_phase = f.pinion_u - mesh.force_u, f.pinion_phase - mesh.force_phase
    angle = torque_angle(m, DRIVE, y[U], y[PHASE])
    own_speed = by_speed(m, DRIVE, angle, surface_speed, -0.0)
    pinion_v, pinion_w = own_speed - (damping + mesh.force_v), own_speed - mesh.force_w
    gear_u = f.gear_u + mesh.force_u + mesh.relief_u
    gear_phase = f.gear_phase + mesh.force_phase + mesh.relief_phase
    gear_v = damping + mesh.force_v + mesh.relief_v
    if m.scene.torque[DRIVE].takes_angle != 0:
        of_travel = by_angle(m, DRIVE, angle, surface_speed, -0.0) * m.scene.torque[DRIVE].angle_unit
        pinion_u += of_travel
        pinion_phase += of_travel / m.scene.phase_rate
    angle = torque_angle(m, LOAD, y[U], y[PHASE])
    gear_w = by_speed(m, LOAD, angle, y[W], mesh.force_w + mesh.relief_w)
    own_travel = 0.0
    if m.scene.torque[LOAD].takes_angle != 0:
        own_travel = by_angle(m, LOAD, angle, y[W], -0.0) * m.scene.torque[LOAD].angle_unit
        gear_phase += own_travel / m.scene.phase_rate
    a, b, c = f.by_pinion, f.by_both, f.by_gear
    return AccelerationSlopes(
        a * pinion_u + b * gear_u,
        a * pinion_v + b * gear_v + f.pinion_v,
        a * pinion_phase + b * gear_phase,
        a * pinion_w + b * gear_w + f.pinion_w,
        b * pinion_u + c * gear_u,
        b * pinion_v + c * gear_v + f.gear_v,
        b * pinion_phase + c * gear_phase,
        b * pinion_w + c * gear_w + f.gear_w,
        a,
        b,
        c,
        own_speed,
        c * own_travel,
    )


# -- with friction ---------------------------------------------------------------------------------------------------


@compiled
def forces_at_shafts(m: Model, t: float, y: Floats) -> tuple[float, float, float]:
    """Surface velocity of the pinion, and the forces at both base circles without friction.

    The forces of the pairs are noted, with the limits of their friction.
    """
    s = shafts_at(m, t, y, forces_at(m, t, y))
    set_limits(m, t, y[W])
    return s.surface_speed, s.pinion, with_acting(m, t, y, s.gear)


@compiled_once(FRICTION)
def friction_at_gear(m: Model, t: float, y: Floats) -> tuple[float, float, tuple[float, float, float]]:
    """Force of the flanks' friction on the gear, what resists it besides its hub, and the loads of hubs and pin.

    What acts on its shaft and its set-valued laws resist it. At rest, where the shares of several elements are not
    unique, the flanks' friction is zero and the laws take what they can.
    """
    surface_speed, pinion, gear = forces_at_shafts(m, t, y)
    shafts = solve_shafts(m, t, y, surface_speed, pinion, gear)
    loads = shafts.loads.pinion, shafts.loads.gear, math.hypot(shafts.pin[0], shafts.pin[1])
    friction = 0.0
    for i in range(m.work.pair_forces.count if m.scene.friction.flanks != 0 else 0):
        noted = m.work.pair_forces.pair[i]
        second = levers(m, noted.position)[1]
        friction += direction(m, noted) * noted.limit * second
        if m.state.hold == HELD_PAIR and noted.history == m.state.held_pair:
            friction += shafts.held * second
    if m.state.hold == AT_REST or m.state.hold == HELD_GEAR:
        limit = own_limit(m, LOAD, t, y, y[W])
        held = min(max(gear + friction, -limit), limit)
        return friction, held - with_acting(m, t, y, -0.0), loads
    return friction, resisting_force(m, t, y), loads
