r"""Transmission error of the gears as they are made, and how it couples their motions.

The error E of a mesh is the sum of the static error and the runout of the pinion, functions of its angle, of the runout
of the gear, a function of its own, and of what the orbit of the pinion in its hub adds, a function h of time
(`gearidae.engine.pairs.orbit`). With :math:`u = R_1 \varphi_1 - R_2 \varphi_2 - E` the arms of a force along
the line of action are :math:`R_1 - \partial E/\partial\varphi_1` and :math:`R_2 + \partial E/\partial\varphi_2`, so
that

.. math::

    \dot u = (1 - e_1) \dot x_1 - (1 + g_1) \dot x_2 - \dot h, \qquad
    \ddot u = (1 - e_1) \ddot x_1 - e_2 \dot x_1^2 - (1 + g_1) \ddot x_2 - g_2 \dot x_2^2 - \ddot h

with the travels :math:`x = R \varphi` of both base circles.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gearidae.compiled import compiled, compiled_once, name_type
from gearidae.engine.compiling import SOLVER
from gearidae.engine.model.state import PHASE, Floats, Model, U, V, W

ANGLE_PHASE = 1e-9
"""Error of the pinion's angle, as a phase of the static error's highest harmonic [rad], below which it is settled; far
above what rounding leaves of an order of 1e5."""
ANGLE_STEPS = 60
"""Steps of Newton's method for it, at most."""


class MeshError(NamedTuple):
    """Error of the mesh at a state, scaled.

    Attributes
    ----------
    angle : float
        Of the pinion [rad]; 0 in a mesh without errors, where nobody asks for it.
    value : float
        E over the unit of length.
    pinion, pinion_curvature : float
        Its first two derivatives in the pinion's angle, over R1 and R1^2.
    gear, gear_curvature : float
        Its first two derivatives in the gear's angle, over R2 and R2^2.
    rate, acceleration : float
        Its first two derivatives in time at fixed angles, which the orbit of the pinion in its hub makes.
    """

    angle: float
    value: float
    pinion: float
    pinion_curvature: float
    gear: float
    gear_curvature: float
    rate: float
    acceleration: float


NO_ERROR = MeshError(*(0.0,) * 8)
name_type(NO_ERROR, "MeshError")


@compiled(inline=True)
def error_at(m: Model, u: float, phase: float) -> MeshError:
    """Error of the mesh; all zeros in one without errors."""
    return mesh_error(m, u, phase) if m.scene.has_error != 0 else NO_ERROR


@compiled_once(SOLVER)
def mesh_error(m: Model, u: float, phase: float) -> MeshError:
    """Error of a mesh that has one.

    ``R1 phi1 - E(phi1, phi2) = u + R2 phi2`` is solved for the pinion's angle by Newton's method: E is small against
    R1. Four steps are enough where E is smooth over its own size; a ripple of high order may take more. The observers
    ask for it at an accepted state one after the other: the last evaluation is kept.
    """
    s, last, orbit = m.scene, m.work.mesh_error, m.work.orbit
    if (
        last.known != 0
        and last.u == u
        and last.phase == phase
        and last.whole_pitches == m.state.whole_pitches
    ):
        return MeshError(
            last.angle,
            last.value,
            last.pinion,
            last.pinion_curvature,
            last.gear,
            last.gear_curvature,
            orbit.error_rate,
            orbit.error_acceleration,
        )
    radius = s.pinion_radius / s.length_unit
    runout = gear = gear_curvature = 0.0
    if s.gear_runout != 0.0:
        turned = (
            2.0 * math.pi * ((m.state.whole_pitches % s.gear_teeth + phase) / s.gear_teeth)
            + s.gear_runout_phase
        )
        runout, gear_radius = s.gear_runout * math.cos(turned), s.gear_radius / s.length_unit
        gear = -s.gear_runout * math.sin(turned) / gear_radius
        gear_curvature = -runout / (gear_radius * gear_radius)
    others = runout + orbit.error  # than those of the pinion's angle
    revolutions = (m.state.whole_pitches % s.pinion_teeth + phase) / s.pinion_teeth
    rigid = 2.0 * math.pi * revolutions + (u + others) / radius
    angle = rigid
    e = e1 = e2 = 0.0
    count, first = s.error_count, s.error_at
    steps, phase_step = 0, math.inf
    while count and (steps < 4 or (phase_step > ANGLE_PHASE and steps < ANGLE_STEPS)):
        steps += 1
        e = e1 = e2 = highest = 0.0
        for k in range(count):
            order, amplitude = m.tables[first + 3 * k], m.tables[first + 3 * k + 1]
            highest = max(highest, order)
            shift = m.tables[first + 3 * k + 2]
            c = amplitude * math.cos(order * angle + shift)
            sine = amplitude * math.sin(order * angle + shift)
            e += c
            e1 -= order * sine / radius
            e2 -= order * order * c / (radius * radius)
        step = (angle - rigid - e / radius) / (1.0 - e1)
        angle -= step
        phase_step = highest * abs(step)  # e and its derivatives are those before the step
    last.known, last.u, last.phase, last.whole_pitches = 1, u, phase, m.state.whole_pitches
    last.angle, last.value, last.pinion, last.pinion_curvature = angle, e + others, e1, e2
    last.gear, last.gear_curvature = gear, gear_curvature
    return MeshError(
        angle, e + others, e1, e2, gear, gear_curvature, orbit.error_rate, orbit.error_acceleration
    )


# -- motions ---------------------------------------------------------------------------------------------------------


@compiled(inline=True)
def surface_speed_of(e: MeshError, v: float, w: float) -> float:
    """Surface velocity of the pinion, for the rate of u and the surface velocity of the gear."""
    return (v + (1.0 + e.gear) * w + e.rate) / (1.0 - e.pinion)


@compiled(inline=True)
def rate_of(e: MeshError, surface_speed: float, w: float) -> float:
    """Rate of u, for the surface velocities of both gears."""
    return surface_speed * (1.0 - e.pinion) - (1.0 + e.gear) * w - e.rate


@compiled(inline=True)
def pinion_acceleration(e: MeshError, surface_speed: float, w: float, v_rate: float, w_rate: float) -> float:
    """Acceleration of the pinion's surface, for the rates of both."""
    curved = e.pinion_curvature * surface_speed * surface_speed + e.gear_curvature * w * w + e.acceleration
    return (v_rate + (1.0 + e.gear) * w_rate + curved) / (1.0 - e.pinion)


@compiled(inline=True)
def acceleration_of(e: MeshError, surface_speed: float, w: float, pinion: float, gear: float) -> float:
    """Rate of the rate of u, for the speeds and accelerations of both surfaces."""
    curved = e.pinion_curvature * surface_speed * surface_speed + e.gear_curvature * w * w + e.acceleration
    return (1.0 - e.pinion) * pinion - (1.0 + e.gear) * gear - curved


@compiled(inline=True)
def speed_and_error(m: Model, y: Floats) -> tuple[float, MeshError]:
    """Surface velocity of the pinion at a state, and the error of the mesh."""
    surface_speed, e = y[V] + y[W], NO_ERROR
    if m.scene.has_error != 0:  # most scenes have none, and this is in every evaluation
        e = mesh_error(m, y[U], y[PHASE])
        surface_speed = surface_speed_of(e, y[V], y[W])
    return surface_speed, e


@compiled
def pinion_speed(m: Model, y: Floats) -> tuple[float, MeshError]:
    """`speed_and_error` for what asks now and then."""
    return speed_and_error(m, y)
