"""Gears at rest: nothing is integrated, and the time goes on to the next stop or to where they begin to move.

Where friction holds both gears, they are at rest to the last bit. Where a law of its shaft holds the gear alone, the
pinion vibrates on its teeth until damping has ended that. Under a steady drive it then is at rest, too: from where its
vibration is smaller than the tolerance it is put to its equilibrium.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import FRICTION
from gearidae.engine.events.events import ROOT, STOP
from gearidae.engine.events.rest_search import rest_until
from gearidae.engine.events.stops import next_stop
from gearidae.engine.friction.forces import has_element
from gearidae.engine.model.record_types import AT_REST, FREE, HELD_GEAR
from gearidae.engine.model.state import DRIVE, PHASE, Floats, Model, U, V, W
from gearidae.engine.motion.pair_forces import forces_at
from gearidae.engine.pairs.mesh_error import error_at
from gearidae.engine.pairs.shaft_angle import torque_angle
from gearidae.laws.shafts import by_angle, is_steady, pinion_force

_PASSES: Final = 2
"""Newton steps to the equilibrium, each of which is shorter than a tolerance."""


@compiled(inline=True)
def _may_rest(m: Model) -> bool:
    """Whether something holds gears: where nothing rubs, nothing of what follows has been compiled."""
    return bool(m.state.hold != FREE and m.scene.friction.may_stick != 0)


@compiled(inline=True)
def comes_to_rest(m: Model, t: float, y: Floats) -> bool:
    """Whether gears that have moved up to an accepted time are at rest from there on."""
    if not _may_rest(m) or y[W] != 0.0:
        return False
    if abs(y[V]) * m.rows[m.scene.error_weights_at + V] >= 1.0:
        return False
    return is_at_rest(m, t, y)


@compiled_once(FRICTION)
def is_at_rest(m: Model, t: float, y: Floats) -> bool:
    """Whether nothing moves, or nothing by more than a tolerance."""
    if y[W] != 0.0 or m.scene.orbit != 0.0:  # the force of the drive carries teeth at rest along each other
        return False
    if m.state.hold == AT_REST:
        return y[V] == 0.0
    if not (_holds_gear(m) and is_steady(m, DRIVE, t)):
        return False
    u, v = y[U], y[V]
    settled = _settle(m, t, y)
    y[U], y[V] = u, v
    return settled


@compiled
def _holds_gear(m: Model) -> bool:
    """Whether the gear is held at rest, and the pinion by nothing but its teeth, whose bodies are rigid."""
    bare = m.scene.friction.flanks == 0 and not has_element(m, DRIVE)
    return bool(m.state.hold == HELD_GEAR and bare and m.scene.nodes == 0)


@compiled
def _settle(m: Model, t: float, y: Floats) -> bool:
    """Stop the pinion and put it to its equilibrium; whether either takes less than a tolerance."""
    first, v = m.scene.error_weights_at, y[V]
    if abs(v) * m.rows[first + V] >= 1.0:
        return False
    y[V] = 0.0
    for _ in range(_PASSES):
        step = _step_to_equilibrium(m, t, y, v)
        if not abs(step) * m.rows[first + U] < 1.0:
            return False
        if m.scene.population.flanks == 0:  # a step might join an asperity
            y[U] += step
    return True


@compiled
def _step_to_equilibrium(m: Model, t: float, y: Floats, v: float) -> float:
    """Newton step of a stopped pinion that has moved at `v`; infinite without an equilibrium that draws it back."""
    mesh = forces_at(m, t, y)
    share = 1.0 - error_at(m, y[U], y[PHASE]).pinion
    angle = torque_angle(m, DRIVE, y[U], y[PHASE])
    push = pinion_force(m, t, angle, 0.0) - share * mesh.force
    stiffness = share * mesh.force_u
    if m.scene.torque[DRIVE].takes_angle != 0:
        stiffness -= by_angle(m, DRIVE, angle, 0.0, -0.0) * m.scene.torque[DRIVE].angle_unit
    if stiffness > 0.0:
        return push / stiffness
    return 0.0 if push == 0.0 == v else np.inf


@compiled
def begin_rest(m: Model, t: float, y: Floats) -> bool:
    """Whether gears are at rest at a start, where what is left of their motion is stopped."""
    return _may_rest(m) and put_to_rest(m, t, y)


@compiled_once(FRICTION)
def put_to_rest(m: Model, t: float, y: Floats) -> bool:
    """`begin_rest` of gears that something holds."""
    resting = is_at_rest(m, t, y)
    if resting and m.state.hold != AT_REST:
        _settle(m, t, y)
    return resting


@compiled_once(FRICTION)
def rest_step(m: Model, t: float, y: Floats) -> tuple[float, int]:
    """Pass a time at rest.

    Returns
    -------
    time : float
        Reached, over tau.
    flag : int
        `STOP`, `ROOT` where the gears begin to move, or 0.
    """
    stop = next_stop(m)
    time, moves = rest_until(m, t, y, stop)
    if moves:
        return time, ROOT
    return time, STOP if time >= stop else 0


@compiled
def longest_step(m: Model) -> float:
    """Longest step of an integration that starts with what is held now; 0 for any.

    Registered laws bound none: what is known of them is the duration of a run, on which its steps must not depend.
    """
    longest, search_step = m.scene.longest_step, m.scene.rest_search_step
    if m.state.hold != FREE and search_step < np.inf and m.scene.rest_margin_curvature < np.inf:
        return min(longest, search_step) if longest > 0.0 else search_step
    return longest
