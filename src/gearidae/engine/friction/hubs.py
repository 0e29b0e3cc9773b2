r"""Loads of the joints: of both hubs and of the pin that drives the pinion, on which their friction depends.

Along and across the line of action of the drive flank the mesh forces add up to a vector S that is linear in every
friction. The gear's hub carries :math:`N_2 = |S|`, the pinion's hub :math:`N_1 = |S - P|` with the force P of the pin.
Where a friction is not known beforehand, because its pair is held or hubs and pairs hold the train together, it is
linear in the loads themselves, so that :math:`S = u + N_1 v_1 + N_2 v_2`. Without a pin both loads are one, the
solution of a quadratic equation; with one Newton's method finds them.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from gearidae.compiled import compiled
from gearidae.engine.model.state import DRIVE, PHASE, Floats, Model, U
from gearidae.engine.pairs.shaft_angle import torque_angle
from gearidae.laws.shaft.own import law_force, law_force_rate

_LEAST_DIVISOR = 1e-300
_ROUNDING = 1e-12
_NEWTON: Final = 40
"""Steps of Newton's method: far from hubs that lock three are enough."""


class Mesh(NamedTuple):
    """Sums of the pairs' forces along the line of action and of their friction, of the drive and the coast flank."""

    drive: float
    coast: float
    drive_friction: float
    coast_friction: float


class Loads(NamedTuple):
    """Loads of the hubs of the pinion and of the gear."""

    pinion: float
    gear: float


@compiled(inline=True)
def has_hubs(m: Model) -> bool:
    """Whether any hub has friction that grows with its load."""
    return bool(m.scene.friction.hubs != 0)


@compiled(inline=True)
def across(m: Model, on_coast: bool) -> tuple[float, float]:
    """Direction of the friction of a flank: components along and across the line of action of the drive flank."""
    if on_coast:
        return m.scene.friction.sine, -m.scene.friction.cosine
    return 0.0, 1.0


@compiled(inline=True)
def vector_sum(m: Model, mesh: Mesh) -> tuple[float, float]:
    """Components of the mesh forces along and across the line of action of the drive flank."""
    friction = m.scene.friction
    along = mesh.drive - friction.cosine * mesh.coast + friction.sine * mesh.coast_friction
    return along, mesh.drive_friction - friction.cosine * mesh.coast_friction - friction.sine * mesh.coast


@compiled(inline=True)
def pin_force(m: Model, t: float, y: Floats, surface_speed: float) -> tuple[float, float]:
    """Force of the pin on the pinion, in the components of `vector_sum`; zero for a drive that is a couple.

    Parameters
    ----------
    t : float
        Time over tau.
    y : ndarray, shape (n,)
        State.
    surface_speed : float
        Surface velocity of the pinion.
    """
    if m.scene.friction.forced == 0:
        return 0.0, 0.0
    return _turned(m, law_force(m, DRIVE, t, torque_angle(m, DRIVE, y[U], y[PHASE]), surface_speed))


@compiled(inline=True)
def pin_rate(m: Model, t: float, y: Floats, surface_speed: float, acceleration: float) -> tuple[float, float]:
    """Rate of `pin_force` along the motion."""
    if m.scene.friction.forced == 0:
        return 0.0, 0.0
    angle = torque_angle(m, DRIVE, y[U], y[PHASE])
    return _turned(m, law_force_rate(m, DRIVE, t, angle, surface_speed, acceleration))


@compiled(inline=True)
def _turned(m: Model, force: tuple[float, float]) -> tuple[float, float]:
    """Components of `vector_sum`, scaled, of a force [N] in the axes of the drive."""
    friction = m.scene.friction
    x, y = force
    return friction.pin_sine * x + friction.pin_cosine * y, friction.pin_sine * y - friction.pin_cosine * x


@compiled(inline=True)
def turning_loads(m: Model, mesh: Mesh, pin: tuple[float, float]) -> tuple[Loads, float]:
    """Loads of both hubs, and the force along the line of action of the flank that has more of it.

    Where the mesh forces turn round together, their sum keeps to a line through zero and its modulus has a corner
    there: the load goes on below zero, from the direction ``load_sign`` on, which ``continued`` notes. Where they turn
    round one by one, the sum passes beside zero. With the force of a pin the pinion's load has no corner.
    """
    friction = m.scene.friction
    along, over = vector_sum(m, mesh)
    load = math.hypot(along, over)
    pinion = math.hypot(along - pin[0], over - pin[1])
    if abs(mesh.coast) > abs(mesh.drive):
        along, over = (
            -friction.cosine * along - friction.sine * over,
            friction.sine * along - friction.cosine * over,
        )
    turned = m.state.load_sign * along < 0.0 and abs(over) <= (2.0 * friction.even + _ROUNDING) * abs(along)
    if turned and has_hubs(m):
        load = -load
        m.work.friction.continued = 1
    if pin[0] == 0.0 == pin[1]:
        pinion = load
    return Loads(pinion, load), along


class Solutions(NamedTuple):
    """Loads that solve ``S = u + N1 v1 + N2 v2`` with ``N1 = |S - P|`` and ``N2 = |S|``.

    Attributes
    ----------
    near, far : Loads
        The smaller and the larger ones; equal where there is one solution only.
    room : float
        Below zero if there is none; the loads then are those nearest to a solution. Infinite where there always is one.
    """

    near: Loads
    far: Loads
    room: float


@compiled(inline=True)
def loads_with_friction(
    m: Model,
    on_coast: bool,
    total: tuple[float, float],
    friction: float,
    falls: tuple[float, float],
    pin: tuple[float, float],
) -> Solutions:
    """Solve for the loads of both hubs where the friction of one pair falls with them.

    Parameters
    ----------
    on_coast : bool
        Whether the pair is of the coast flank.
    total : tuple of float
        `vector_sum` without that friction.
    friction : float
        Without loads.
    falls : tuple of float
        What it falls by with the loads of the hubs of pinion and gear.
    pin : tuple of float
        As `pin_force` has it.
    """
    x, z = across(m, on_coast)
    u = (total[0] + friction * x, total[1] + friction * z)
    return consistent_loads(u, (-falls[0] * x, -falls[0] * z), (-falls[1] * x, -falls[1] * z), pin)


@compiled
def consistent_loads(
    u: tuple[float, float],
    by_pinion: tuple[float, float],
    by_gear: tuple[float, float],
    pin: tuple[float, float],
) -> Solutions:
    """Solve for the loads of both hubs where a friction depends on them.

    Parameters
    ----------
    u, by_pinion, by_gear, pin : tuple of float
        Vectors u, v1, v2 and P of `Solutions`.
    """
    v = (by_pinion[0] + by_gear[0], by_pinion[1] + by_gear[1])
    square = v[0] * v[0] + v[1] * v[1] - 1.0
    half = u[0] * v[0] + u[1] * v[1]
    whole = u[0] * u[0] + u[1] * u[1]
    root = math.sqrt(max(half * half - square * whole, 0.0))
    if square <= 0.0:
        near = (
            whole / max(root - half, _LEAST_DIVISOR)
            if half <= 0.0
            else (half + root) / max(-square, _LEAST_DIVISOR)
        )
        far, room = near, math.inf
    else:
        near, far = whole / max(root + abs(half), _LEAST_DIVISOR), (root + abs(half)) / square
        room = -half - math.sqrt(square * whole)
    if pin[0] == 0.0 == pin[1]:
        return Solutions(Loads(near, near), Loads(far, far), room)
    first, missed = _beside_pin(u, by_pinion, by_gear, pin, near)
    if square <= 0.0:
        return Solutions(first, first, -missed if missed > 0.0 else math.inf)
    second, other = _beside_pin(u, by_pinion, by_gear, pin, far)
    return Solutions(first, second, -max(missed, other) if max(missed, other) > 0.0 else math.inf)


@compiled
def _beside_pin(
    u: tuple[float, float],
    by_pinion: tuple[float, float],
    by_gear: tuple[float, float],
    pin: tuple[float, float],
    load: float,
) -> tuple[Loads, float]:
    """Loads beside the force of a pin, by Newton's method from equal ones; and what they miss, 0 within rounding."""
    n1, n2, missed = load, load, math.inf
    for _ in range(_NEWTON):
        x, z = u[0] + n1 * by_pinion[0] + n2 * by_gear[0], u[1] + n1 * by_pinion[1] + n2 * by_gear[1]
        pinion, gear = math.hypot(x - pin[0], z - pin[1]), math.hypot(x, z)
        f, g = pinion - n1, gear - n2
        missed = max(abs(f), abs(g))
        if missed <= _ROUNDING * (pinion + gear):
            return Loads(pinion, gear), 0.0
        p, q = (x - pin[0]) / max(pinion, _LEAST_DIVISOR), (z - pin[1]) / max(pinion, _LEAST_DIVISOR)
        r, s = x / max(gear, _LEAST_DIVISOR), z / max(gear, _LEAST_DIVISOR)
        a, b = p * by_pinion[0] + q * by_pinion[1] - 1.0, p * by_gear[0] + q * by_gear[1]
        c, d = r * by_pinion[0] + s * by_pinion[1], r * by_gear[0] + s * by_gear[1] - 1.0
        determinant = a * d - b * c
        if determinant == 0.0:
            break
        n1, n2 = max(n1 - (f * d - b * g) / determinant, 0.0), max(n2 - (a * g - c * f) / determinant, 0.0)
    return Loads(n1, n2), missed
