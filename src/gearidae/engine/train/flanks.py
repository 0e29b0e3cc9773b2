"""Friction of flanks in a train: of pairs that slide, by their stored directions, and of what is at rest beside them.

A pair of the shafts a and b slides at ``v = r1 w_a - r2 w_b``. Its friction f takes ``r1 f`` from the torque of shaft a
and gives ``r2 f`` to that of shaft b; it pushes the hub of a by f across the line of action, and that of b back. A pair
that slides has its limit for f. Pairs that roll, and then shafts that stand, have the frictions together that keep all
of them as they are. The loads of hubs depend on these, and the friction of hubs that turn acts back on them.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.arrays import Floats
from gearidae.compiled import compiled
from gearidae.engine.friction.forces import RETURN
from gearidae.engine.friction.pairs import lever_rate, levers, set_limits
from gearidae.engine.model.record_types import STUCK
from gearidae.engine.model.state import COAST, Model, Record, W
from gearidae.engine.pairs.tooth_pairs import flank_of_history
from gearidae.engine.train.box import (
    BEFORE,
    FREE_ACCELERATION,
    FRICTION,
    LIMIT,
    SMALL,
    UNIT,
    solve_box,
    solve_held,
)
from gearidae.engine.train.layout import OF_MESH, OF_SHAFT, OF_TRAIN, TrainModel

NO_FORCE: Final = 1e-12
"""Of a mesh's reference load: as `gearidae.engine.friction.forces.NO_FORCE`."""
PASSES: Final = 100
"""Of loads of hubs and the frictions that depend on them; each takes the error to a share that is the closer to 1 the
nearer a hub is to locking."""
NO_CHANGE: Final = 1e-14
NO_CONVERGENCE: Final = -4
"""IDA's flag for an iteration without an end."""


@compiled
def slide_of(m: Model, noted: Record) -> int:
    """Direction of sliding of a noted pair: -1, 1, `STUCK`, or 0 where nothing rubs."""
    h = m.state.history[noted.history]
    return int(h.slide) if h.pair == noted.pair else 0


@compiled
def pair_speeds(tm: TrainModel, k: int, m: Model, noted: Record, y: Floats) -> tuple[float, float, float]:
    """Levers r1 and r2 of a noted pair [m], and the speed of its sliding [m/s]."""
    mesh, n = tm.meshes[k], len(tm.shafts)
    first, second = levers(m, noted.position)
    r1, r2 = first * mesh.driver_radius, second * mesh.driven_radius
    return r1, r2, r1 * y[n + mesh.a] - r2 * y[n + mesh.b]


@compiled
def add_flank_friction(tm: TrainModel, k: int, m: Model, t: float, y: Floats) -> tuple[float, float, float]:
    """Add the friction of the pairs of a mesh that slide, and list those that roll; the forces have just been noted.

    Returns
    -------
    into, out : float
        Torques that it takes from the driver and gives to the driven gear [N m].
    power : float
        [W].
    """
    mesh, n = tm.meshes[k], len(tm.shafts)
    set_limits(m, t / mesh.time_unit, tm.own[W])
    to_own = mesh.time_unit / mesh.length_unit
    surface_speed = mesh.driver_radius * y[n + mesh.a] * to_own
    into = out = power = across_x = across_y = 0.0
    for i in range(m.work.pair_forces.count):
        noted = m.work.pair_forces.pair[i]
        slide = slide_of(m, noted)
        if slide == 0:
            continue
        r1, r2, speed = pair_speeds(tm, k, m, noted, y)
        x, z = mesh.rub_x, mesh.rub_y
        if flank_of_history(m, noted.history) == COAST:
            x, z = mesh.coast_rub_x, mesh.coast_rub_y
        if slide == STUCK:
            number = tm.train[0].elements
            element = tm.elements[number]
            element.mesh, element.history, element.a, element.b = k, noted.history, mesh.a, mesh.b
            element.first, element.second, element.x, element.y = r1, -r2, x, z
            acceleration = (
                lever_rate(m, noted, surface_speed, tm.own[W]) * mesh.length_unit / mesh.time_unit**2
            )
            element.acceleration = acceleration + RETURN * speed / mesh.time_unit
            tm.box[LIMIT, number] = noted.limit * mesh.force_unit
            tm.box[UNIT, number] = NO_FORCE * mesh.force_unit
            tm.train[0].elements += 1
            continue
        friction = slide * noted.limit * mesh.force_unit
        into += friction * r1
        out += friction * r2
        power += friction * speed
        across_x += friction * x
        across_y += friction * z
    _push(tm, mesh.a, mesh.b, across_x, across_y)
    return into, out, power


@compiled
def _push(tm: TrainModel, a: int, b: int, x: float, y: float) -> None:
    """Push the hub of one shaft, and that of the other back."""
    tm.shafts[a].load_x += x
    tm.shafts[a].load_y += y
    tm.shafts[b].load_x -= x
    tm.shafts[b].load_y -= y


@compiled
def set_limit(tm: TrainModel, i: int) -> float:
    """Set the load of a shaft's hub, and the limit of all that may hold the shaft; the part of its hub is returned."""
    train, shaft, joint = tm.train[0], tm.shafts[i], tm.joints[i]
    shaft.hub = math.hypot(shaft.load_x, shaft.load_y)
    hub = joint.by_load * shaft.hub + joint.constant
    shaft.limit = shaft.resistance + hub
    if i == train.load:
        shaft.limit += train.load_limit
    if i == train.drive:
        shaft.limit += tm.joints[-1].by_load * train.pin
    return hub


@compiled
def hold_elements(tm: TrainModel, y: Floats, dy: Floats) -> None:
    """Find the frictions that keep all pairs rolling and all held shafts at rest, and add those of the pairs."""
    train, n = tm.train[0], len(tm.shafts)
    if train.elements == 0:
        return
    for i in range(n):
        shaft = tm.shafts[i]
        shaft.moving_torque, shaft.moving_x, shaft.moving_y = shaft.torque, shaft.load_x, shaft.load_y
        if shaft.rubs != 0 and shaft.slip == 0.0:
            number = train.elements
            element = tm.elements[number]
            element.mesh, element.history, element.a, element.b = -1, -1, i, i
            element.first, element.second, element.acceleration, element.x, element.y = (
                1.0,
                0.0,
                0.0,
                0.0,
                0.0,
            )
            tm.box[UNIT, number] = shaft.no_torque
            train.elements += 1
    fill_gram(tm)
    if not balance_frictions(tm, False):
        train.error = NO_CONVERGENCE
    last = 2 * n + OF_SHAFT * n
    for j in range(train.elements):
        element, friction = tm.elements[j], tm.box[FRICTION, j]
        if element.mesh < 0:
            continue
        into, out = element.first * friction, -element.second * friction
        tm.shafts[element.a].torque -= into
        tm.shafts[element.b].torque += out
        if train.balance != 0:
            first = last + OF_MESH * element.mesh
            taken, given = into * y[n + element.a], out * y[n + element.b]
            dy[first + 3] += taken
            dy[first + 4] += given
            dy[last + OF_MESH * len(tm.meshes) + OF_TRAIN + element.mesh] += taken - given


@compiled
def fill_gram(tm: TrainModel) -> None:
    """Fill the matrix of relative accelerations per friction of the elements."""
    for j in range(tm.train[0].elements):
        one = tm.elements[j]
        for k in range(j + 1):
            other = tm.elements[k]
            both = 0.0
            if one.a == other.a:
                both += one.first * other.first / tm.shafts[one.a].inertia
            if one.a == other.b:
                both += one.first * other.second / tm.shafts[one.a].inertia
            if one.b == other.a:
                both += one.second * other.first / tm.shafts[one.b].inertia
            if one.b == other.b:
                both += one.second * other.second / tm.shafts[one.b].inertia
            tm.gram[j, k] = tm.gram[k, j] = both


@compiled
def balance_frictions(tm: TrainModel, within: bool) -> bool:
    """Find frictions of the elements and loads of hubs that depend on each other.

    Parameters
    ----------
    within : bool
        Whether the frictions are those within their limits; otherwise those that hold all elements.

    Returns
    -------
    bool
        Whether they have been found.
    """
    train, n = tm.train[0], len(tm.shafts)
    count = train.elements
    for j in range(count):
        tm.box[FRICTION, j] = 0.0
    for _ in range(PASSES):
        for i in range(n):
            tm.shafts[i].load_x, tm.shafts[i].load_y = tm.shafts[i].moving_x, tm.shafts[i].moving_y
        for j in range(count):
            element, friction = tm.elements[j], tm.box[FRICTION, j]
            _push(tm, element.a, element.b, friction * element.x, friction * element.y)
        for i in range(n):
            set_limit(tm, i)
        for j in range(count):
            element = tm.elements[j]
            a, b = tm.shafts[element.a], tm.shafts[element.b]
            free = element.acceleration + element.first * (a.moving_torque - a.slip * a.limit) / a.inertia
            free += element.second * (b.moving_torque - b.slip * b.limit) / b.inertia
            tm.box[FREE_ACCELERATION, j] = free
            if element.mesh < 0:
                tm.box[LIMIT, j] = a.limit
            tm.box[BEFORE, j] = tm.box[FRICTION, j]
        if within:
            if not solve_box(count, tm.gram, tm.work, tm.box):
                return False
        else:
            train.rank = solve_held(count, tm.gram, tm.work, tm.box)
        if train.hubs == 0:
            return True
        changed = False
        for j in range(count):
            change = abs(tm.box[FRICTION, j] - tm.box[BEFORE, j])
            changed |= not change <= NO_CHANGE * abs(tm.box[BEFORE, j]) + SMALL * tm.box[UNIT, j]
        if not changed:
            return True
    return False
