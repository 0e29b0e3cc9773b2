"""Accelerations of both shafts with dry friction, and how far it is from letting go of what it holds.

Friction of flanks, hubs and the laws of `gearidae.laws.frictions` are set-valued: each is an element with a direction
of slip, or holds at rest what it can. Between events the directions are constants, so that all forces are smooth. An
element k has the speed ``J_k . (turn, w)`` with the surface velocities of both base circles; a friction f takes
``J_k f`` from the forces at the base circles.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import FRICTION
from gearidae.engine.friction.ageing import OfJoints, joint_friction
from gearidae.engine.friction.hubs import (
    Loads,
    Mesh,
    has_hubs,
    loads_with_friction,
    pin_force,
    turning_loads,
    vector_sum,
)
from gearidae.engine.friction.pairs import (
    RUBS,
    direction,
    lever_rate,
    levers,
    set_limits,
)
from gearidae.engine.model.record_types import AT_REST, HELD_GEAR, HELD_PAIR, HELD_PINION
from gearidae.engine.model.state import COAST, DRIVE, LOAD, PHASE, Floats, Model, U, V, W
from gearidae.engine.pairs.shaft_angle import torque_angle
from gearidae.engine.pairs.tooth_pairs import flank_of_history, pair_gap
from gearidae.laws.frictions import law_limit, resists
from gearidae.laws.joints import PIN
from gearidae.laws.shafts import acting

SEEN: Final = 0.1
"""Of a tolerance of the speeds: a passage of the load beside zero that changes them by less bounds no step."""
RETURN: Final = 0.05
"""Rate at which the sliding that errors have brought about in a pair that rolls is taken out again, over 1/tau."""
NO_FORCE: Final = 1e-12
"""Of the reference load: less than this neither holds a gear nor moves it from rest."""


@compiled(inline=True)
def has_element(m: Model, shaft: int) -> bool:
    """Whether a law of a shaft or a joint may hold it."""
    return bool(resists(m, shaft) or m.scene.friction.rubs[shaft] != 0)


@compiled(inline=True)
def own_limit(m: Model, shaft: int, t: float, y: Floats, speed: float) -> float:
    """Limit of the laws of a shaft, over its base radius; the speed is that of the base circle."""
    return _own_limit(m, shaft, t, y, speed) if resists(m, shaft) else 0.0


@compiled
def _own_limit(m: Model, shaft: int, t: float, y: Floats, speed: float) -> float:
    """That of a shaft that has any; not put into its callers, as most shafts have none."""
    return law_limit(m, shaft, t, torque_angle(m, shaft, y[U], y[PHASE]), speed)


@compiled(inline=True)
def shaft_limit(
    m: Model, shaft: int, t: float, y: Floats, speed: float, joints: OfJoints, pin: tuple[float, float]
) -> float:
    """Limit of what resists a shaft, over its base radius, without what grows with the load of its hub.

    The speed is that of the base circle, `pin` the force of a pin, which drives the pinion.
    """
    limit = own_limit(m, shaft, t, y, speed) + joints[shaft].constant
    return limit + joints[PIN].by_load * math.hypot(pin[0], pin[1]) if shaft == DRIVE else limit


class Shafts(NamedTuple):
    """What two shafts do with friction.

    Attributes
    ----------
    pinion, gear : float
        Accelerations of the base circles.
    held : float
        Friction of the element that is held; 0 if none is, or both gears are.
    margin : float
        How far that is below its limit; infinite if nothing is held, and of no use if both gears are.
    mesh : Mesh
    loads : Loads
        Of the hubs. Where the force turns round, they go on below zero until the event that follows, so that they have
        no corner inside a step.
    pin : tuple of float
        Force of the pin, as `pin_force` has it.
    corner : float
        Falls through zero where that happens; infinite where it cannot.
    """

    pinion: float
    gear: float
    held: float
    margin: float
    mesh: Mesh
    loads: Loads
    pin: tuple[float, float]
    corner: float


class _Pairs(NamedTuple):
    """Sums over all pairs, and the pair that is held.

    Attributes
    ----------
    pinion, gear : float
        Forces at the base circles, less the friction of the pairs that slip.
    mesh : Mesh
    first, second : float
        Levers of the pair that is held; zero if none is.
    limit : float
        Of its friction, with the error of the force of the pair.
    sliding_rate : float
        Rate of its sliding speed with shafts that keep their speeds, and what errors have brought about of it.
    on_coast : bool
        Whether it is of the coast flank.
    """

    pinion: float
    gear: float
    mesh: Mesh
    first: float
    second: float
    limit: float
    sliding_rate: float
    on_coast: bool


@compiled(inline=True)
def _sum_pairs(m: Model, surface_speed: float, w: float, pinion: float, gear: float) -> _Pairs:
    """Sum the forces of all noted pairs, and take their friction from the forces at the base circles."""
    rubbing, state = m.scene.friction, m.state
    drive = coast = drive_friction = coast_friction = 0.0
    held_first = held_second = limit = sliding_rate = 0.0
    coast_held = False
    for i in range(m.work.pair_forces.count):
        noted = m.work.pair_forces.pair[i]
        on_coast = flank_of_history(m, noted.history) == COAST
        if on_coast:
            coast += noted.force
        else:
            drive += noted.force
        if rubbing.flanks == 0:
            continue
        first, second = levers(m, noted.position)
        friction = direction(m, noted) * noted.limit
        pinion -= friction * first
        gear += friction * second
        if on_coast:
            coast_friction += friction
        else:
            drive_friction += friction
        if state.hold == HELD_PAIR and noted.history == state.held_pair:
            held_first, held_second, coast_held = first, second, on_coast
            limit = noted.limit + rubbing.gap_tolerance * abs(noted.slope)
            sliding_rate = lever_rate(m, noted, surface_speed, w) + RETURN * (
                first * surface_speed - second * w
            )
    mesh = Mesh(drive, coast, drive_friction, coast_friction)
    return _Pairs(pinion, gear, mesh, held_first, held_second, limit, sliding_rate, coast_held)


@compiled(inline=True)
def solve_shafts(m: Model, t: float, y: Floats, surface_speed: float, pinion: float, gear: float) -> Shafts:
    """Accelerations with the present directions of slip.

    Parameters
    ----------
    t : float
        Time over tau; the forces of the pairs have been noted there, with their limits.
    y : ndarray, shape (n,)
        State.
    surface_speed : float
        Surface velocity of the pinion.
    pinion, gear : float
        Forces at the base circles without friction.
    """
    friction, state = m.scene.friction, m.state
    pairs = _sum_pairs(m, surface_speed, y[W], pinion, gear)
    mesh, loads, pin, corner = pairs.mesh, Loads(0.0, 0.0), (0.0, 0.0), math.inf
    if friction.joints != 0:
        pin = pin_force(m, t, y, surface_speed)
        if friction.forced != 0:
            m.work.friction.pin[0], m.work.friction.pin[1] = pin
        loads, along = turning_loads(m, mesh, pin)
        if has_hubs(m) and state.hold != AT_REST and state.hold != HELD_PAIR:
            corner = state.load_sign * along + RUBS
    if state.hold == AT_REST:
        return Shafts(0.0, 0.0, 0.0, 0.0, mesh, loads, pin, corner)
    joints = joint_friction(m, t, y)
    a1, a2 = m.scene.pinion_inverse_mass, m.scene.gear_inverse_mass
    first_limit = shaft_limit(m, DRIVE, t, y, surface_speed, joints, pin)
    second_limit = shaft_limit(m, LOAD, t, y, y[W], joints, pin)
    on_pinion = pairs.pinion - state.pinion_slip * first_limit
    on_gear = pairs.gear - state.slip * second_limit
    hub_on_pinion, hub_on_gear = state.pinion_slip * joints[DRIVE].by_load, state.slip * joints[LOAD].by_load
    held, margin = 0.0, math.inf
    if state.hold == HELD_PAIR:
        first, second = a1 * pairs.first, a2 * pairs.second
        inertia = max(first * pairs.first + second * pairs.second, 1e-300)
        held = (first * on_pinion - second * on_gear + pairs.sliding_rate) / inertia
        if friction.joints != 0:
            by_loads = first * hub_on_pinion / inertia, -second * hub_on_gear / inertia
            mesh, loads, held, margin = _with_held(m, pairs, held, by_loads, pin)
        margin = min(margin, pairs.limit - abs(held))
        on_pinion -= held * pairs.first
        on_gear += held * pairs.second
    on_pinion -= hub_on_pinion * loads.pinion
    on_gear -= hub_on_gear * loads.gear
    if state.hold == HELD_GEAR:
        margin = second_limit + joints[LOAD].by_load * loads.gear - abs(pairs.gear)
        return Shafts(a1 * on_pinion, 0.0, pairs.gear, margin, mesh, loads, pin, corner)
    if state.hold == HELD_PINION:
        margin = first_limit + joints[DRIVE].by_load * loads.pinion - abs(pairs.pinion)
        return Shafts(0.0, a2 * on_gear, pairs.pinion, margin, mesh, loads, pin, corner)
    return Shafts(a1 * on_pinion, a2 * on_gear, held, margin, mesh, loads, pin, corner)


@compiled(inline=True)
def _with_held(
    m: Model, pairs: _Pairs, held: float, by_loads: tuple[float, float], pin: tuple[float, float]
) -> tuple[Mesh, Loads, float, float]:
    """Solve for the friction of the pair that is held and for the loads of the hubs, which depend on each other.

    Parameters
    ----------
    held : float
        That friction without loads.
    by_loads : tuple of float
        What it falls by with the loads of the hubs of pinion and gear.
    pin : tuple of float
        Force of the pin.

    Returns
    -------
    mesh, loads, held, margin
        As those of `Shafts`; the margin is that of the solution alone.
    """
    solved = loads_with_friction(m, pairs.on_coast, vector_sum(m, pairs.mesh), held, by_loads, pin)
    held -= by_loads[0] * solved.near.pinion + by_loads[1] * solved.near.gear
    drive, coast, drive_friction, coast_friction = pairs.mesh
    if pairs.on_coast:
        coast_friction += held
    else:
        drive_friction += held
    return Mesh(drive, coast, drive_friction, coast_friction), solved.near, held, solved.room


@compiled(inline=True)
def with_acting(m: Model, t: float, y: Floats, gear: float) -> float:
    """Force at the gear with all that acts on its shaft but friction."""
    if m.scene.torque[LOAD].acts != 0:
        gear = acting(m, LOAD, t, torque_angle(m, LOAD, y[U], y[PHASE]), y[W], gear)
    return gear


@compiled_once(FRICTION)
def rubbed_accelerations(
    m: Model, t: float, y: Floats, surface_speed: float, pinion: float, gear: float
) -> tuple[float, float]:
    """Accelerations of both base circles, see `solve_shafts`; the gear's force is without what acts on its shaft."""
    set_limits(m, t, y[W])
    shafts = solve_shafts(m, t, y, surface_speed, pinion, with_acting(m, t, y, gear))
    return shafts.pinion, shafts.gear


@compiled_once(FRICTION)
def load_pace(m: Model, speed_weight: float) -> float:
    """Rate at which the load of a hub changes, over that load, where it passes beside zero; 0 elsewhere.

    Where the forces of two pairs, or of two materials, turn round one by one, their vector sum S passes zero at the
    distance ``d = |S x S'| / |S'|``. Its modulus then turns within the time d / |S'|, which a step of high order passes
    over without a large estimate of its error; and it is as wrong at each passage, since the modulus is missed where
    it is least. A sum on a line through zero has d = 0: there the load goes on below zero, see `turning_loads`. The hub
    of a pinion that a pin pushes with P bears S - P, which passes beside zero where S turns round on its line, too; P
    changes little meanwhile.

    Parameters
    ----------
    speed_weight : float
        One over the tolerance of the speeds.
    """
    friction = m.scene.friction
    if m.state.hold == AT_REST or m.state.hold == HELD_PAIR:
        return 0.0
    drive = coast = drive_friction = coast_friction = 0.0
    drive_rate = coast_rate = drive_friction_rate = coast_friction_rate = 0.0
    for i in range(m.work.pair_forces.count):
        noted = m.work.pair_forces.pair[i]
        slip = direction(m, noted) if friction.flanks != 0 else 0.0
        if flank_of_history(m, noted.history) == COAST:
            coast += noted.force
            coast_rate += noted.force_rate
            coast_friction += slip * noted.limit
            coast_friction_rate += slip * noted.limit_rate
        else:
            drive += noted.force
            drive_rate += noted.force_rate
            drive_friction += slip * noted.limit
            drive_friction_rate += slip * noted.limit_rate
    x, z = vector_sum(m, Mesh(drive, coast, drive_friction, coast_friction))
    x_rate, z_rate = vector_sum(m, Mesh(drive_rate, coast_rate, drive_friction_rate, coast_friction_rate))
    on_pinion = m.scene.pinion_inverse_mass * friction.joint[DRIVE].by_load
    on_gear = m.scene.gear_inverse_mass * friction.joint[LOAD].by_load
    if friction.forced == 0:
        return _pace_beside(x, z, x_rate, z_rate, (on_pinion + on_gear) * speed_weight)
    pin = m.work.friction.pin
    pinion = _pace_beside(x - pin[0], z - pin[1], x_rate, z_rate, on_pinion * speed_weight)
    return max(pinion, _pace_beside(x, z, x_rate, z_rate, on_gear * speed_weight))


@compiled(inline=True)
def _pace_beside(x: float, z: float, x_rate: float, z_rate: float, weight: float) -> float:
    """Return the rate of a vector over it, unless its passage beside zero changes speeds by less than is `SEEN`.

    The weight is by how much it accelerates the shafts, over the tolerance of their speeds.
    """
    load, rate = math.hypot(x, z), math.hypot(x_rate, z_rate)
    if load == 0.0 or rate == 0.0:
        return 0.0
    beside = abs(x * z_rate - z * x_rate) / rate
    return rate / load if weight * beside * beside > SEEN * rate else 0.0


class Slopes(NamedTuple):
    """What an acceleration changes by with forces and states.

    Attributes
    ----------
    by_pinion, by_both, by_gear : float
        Inverse mass matrix of what is free to move: entries of the pinion, off the diagonal, and of the gear.
    pinion_u, pinion_phase, gear_u, gear_phase : float
        Slopes of the friction of flanks in the forces at the base circles.
    pinion_v, pinion_w, gear_v, gear_w : float
        Slopes of the accelerations in the speeds, of a pair that rolls.
    """

    by_pinion: float
    by_both: float
    by_gear: float
    pinion_u: float
    pinion_phase: float
    gear_u: float
    gear_phase: float
    pinion_v: float
    pinion_w: float
    gear_v: float
    gear_w: float


@compiled(inline=True)
def friction_slopes(m: Model, y: Floats) -> Slopes:
    """Slopes for the forces that have been noted last."""
    state, a1, a2 = m.state, m.scene.pinion_inverse_mass, m.scene.gear_inverse_mass
    by_pinion, by_both, by_gear = a1, 0.0, a2
    pinion_u = pinion_phase = gear_u = gear_phase = pinion_v = pinion_w = gear_v = gear_w = 0.0
    for i in range(m.work.pair_forces.count if m.scene.friction.flanks != 0 else 0):
        noted = m.work.pair_forces.pair[i]
        flank = flank_of_history(m, noted.history)
        first, second = levers(m, noted.position)
        if state.hold == HELD_PAIR and noted.history == state.held_pair:
            inertia = max(a1 * first**2 + a2 * second**2, 1e-300)
            by_pinion -= (a1 * first) ** 2 / inertia
            by_both = a1 * first * a2 * second / inertia
            by_gear -= (a2 * second) ** 2 / inertia
            back, forth = a1 * first * RETURN / inertia, a2 * second * RETURN / inertia
            pinion_v, pinion_w = -back * first, -back * (first - second)
            gear_v, gear_w = forth * first, forth * (first - second)
        by_gap = direction(m, noted) * noted.limit_slope
        if by_gap == 0.0:
            continue
        slope = pair_gap(m, flank, noted.pair, y[U], y[V], y[PHASE], y[W])[2]
        gap_u = 2.0 * flank - 1.0
        gap_phase = -gap_u * slope / m.scene.phase_rate
        pinion_u -= by_gap * gap_u * first
        pinion_phase -= by_gap * gap_phase * first
        gear_u += by_gap * gap_u * second
        gear_phase += by_gap * gap_phase * second
    if state.hold == AT_REST:
        by_pinion = by_gear = 0.0
    elif state.hold == HELD_GEAR:
        by_gear = 0.0
    elif state.hold == HELD_PINION:
        by_pinion = 0.0
    return Slopes(
        by_pinion,
        by_both,
        by_gear,
        pinion_u,
        pinion_phase,
        gear_u,
        gear_phase,
        pinion_v,
        pinion_w,
        gear_v,
        gear_w,
    )
