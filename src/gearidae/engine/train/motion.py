"""Equations of motion of a train: forces of its meshes on its shafts, loads of its hubs, and the powers of all.

    I_i phi_i'' = T_i + sum_{k: b=i} R_kb (F_k + c_k u_k' + Fs_k) - sum_{k: a=i} (R_ka - e_k') (F_k + c_k u_k')
                  - h_i s_i

with the torques T of drive, load and drags, and the direction s in which a shaft slips; one that is held keeps its
place. A mesh pushes its driven gear with its drive and coast flanks by the vector S, and its driver by -S. Hubs carry

    N_i = | P_i + sum_{k: b=i} S_k - sum_{k: a=i} S_k |

with the force P of the drive's pin, and h is what may resist: dry resistance, and the friction of hub and pin. Friction
of flanks comes beside these (`gearidae.engine.train.flanks`).
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.arrays import Floats
from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import TRAIN
from gearidae.engine.laws.pairs import mesh_force, radius_power
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import DRIVE, LOAD, PHASE, Model, U, V, W
from gearidae.engine.motion.pair_forces import forces_at
from gearidae.engine.pairs.mesh_error import MeshError, error_at
from gearidae.engine.pairs.shaft_angle import torque_angle
from gearidae.engine.train.ageing import set_joint_friction
from gearidae.engine.train.flanks import add_flank_friction, hold_elements, set_limit
from gearidae.engine.train.layout import OF_MESH, OF_SHAFT, OF_TRAIN, TrainModel, is_at_rest
from gearidae.laws.frictions import law_limit, resists
from gearidae.laws.shaft.own import law_force
from gearidae.laws.shafts import acting, driving_force, is_constant, pinion_force

SETTLED: Final = 1e-15
"""Change of an error of a mesh over the unit of length at which its iteration ends: each step takes it to some 1e-3."""
MOST: Final = 30
"""Its steps at most."""


@compiled
def mesh_state(tm: TrainModel, k: int, m: Model, y: Floats, out: Floats) -> MeshError:
    """Write the state of a mesh's pair (u, its rate, the phase, the driven gear's surface velocity), in its own units.

    The error of the mesh is returned.
    """
    mesh, n = tm.meshes[k], len(tm.shafts)
    a, b, load = mesh.a, mesh.b, tm.train[0].load
    first = 0.0 if a == load else y[a]
    second = 0.0 if b == load else y[b]
    length = mesh.length_unit
    along = (mesh.driver_radius * first - mesh.driven_radius * second - mesh.offset) / length
    turned = second - tm.shafts[b].begin
    out[PHASE] = mesh.phase + mesh.ratio * y[load] + mesh.per_radian * turned
    out[U] = along
    e = error_at(m, along, out[PHASE])
    if m.scene.has_error != 0:
        for _ in range(MOST):
            u = along - e.value
            change = u - out[U]
            out[U] = u
            if abs(change) <= SETTLED * max(1.0, abs(u)):
                break
            e = error_at(m, u, out[PHASE])
    to_own = mesh.time_unit / length
    surface_speed, w = mesh.driver_radius * y[n + a] * to_own, mesh.driven_radius * y[n + b] * to_own
    out[W] = w
    out[V] = (1.0 - e.pinion) * surface_speed - (1.0 + e.gear) * w
    return e


@compiled
def _pushes(m: Model) -> tuple[float, float, float]:
    """Forces of the drive and the coast flanks that have been noted last, and the power that films take; scaled."""
    drive = coast = film = 0.0
    for i in range(m.work.pair_forces.count):
        noted = m.work.pair_forces.pair[i]
        if noted.history >= m.scene.slots:
            coast += noted.force
        else:
            drive += noted.force
        # of the laws that a mesh of a train may have, a film alone knows the rate of the gap, and is linear in it
        film -= noted.damping * noted.gap_rate * noted.gap_rate
    return drive, coast, film


@compiled
def _add_mesh(tm: TrainModel, k: int, t: float, y: Floats, dy: Floats) -> None:
    """Put the forces of a mesh on its shafts and their hubs, and write its powers."""
    mesh, n, shafts, own = tm.meshes[k], len(tm.shafts), tm.shafts, tm.own
    m = model_at(mesh.address)
    e = mesh_state(tm, k, m, y, own)
    sums = forces_at(m, t / mesh.time_unit, own)
    drive, coast, film = _pushes(m)
    total, unit = mesh_force(m, own[V], sums.force), mesh.force_unit
    a, b = mesh.a, mesh.b
    into = (1.0 - e.pinion) * mesh.driver_radius * total * unit
    out = mesh.driven_radius * ((1.0 + e.gear) * total + sums.relief) * unit
    rubbed = 0.0
    if mesh.flanks != 0:
        taken, given, rubbed = add_flank_friction(tm, k, m, t, y)
        into += taken
        out += given
    shafts[a].torque -= into
    shafts[b].torque += out
    x = (drive * mesh.drive_x + coast * mesh.coast_x) * unit
    z = (drive * mesh.drive_y + coast * mesh.coast_y) * unit
    shafts[a].load_x -= x
    shafts[a].load_y -= z
    shafts[b].load_x += x
    shafts[b].load_y += z
    mesh.force, mesh.error = total * unit, own[U] * mesh.length_unit
    if tm.train[0].balance != 0:
        power, first = unit * mesh.length_unit / mesh.time_unit, 2 * n + OF_SHAFT * n + OF_MESH * k
        dy[first] = (total - sums.force) * own[V] * power
        dy[first + 1] = film * power
        dy[first + 3] = into * y[n + a]
        dy[first + 4] = out * y[n + b]
        dy[first + 2] = (
            radius_power(m, t / mesh.time_unit, own, 0.0)[0] * power if mesh.radius_power != 0 else 0.0
        )
        if tm.train[0].flanks != 0:
            dy[2 * n + OF_SHAFT * n + OF_MESH * len(tm.meshes) + OF_TRAIN + k] = rubbed


@compiled
def _add_torques(tm: TrainModel, t: float, y: Floats) -> None:
    """Put the torques of drive and load on their shafts, and the force of the pin on its hub."""
    train, n, shafts, own = tm.train[0], len(tm.shafts), tm.shafts, tm.own
    mesh = tm.meshes[train.drive_mesh]
    m = model_at(mesh.address)
    mesh_state(tm, train.drive_mesh, m, y, own)
    time, angle = t / mesh.time_unit, torque_angle(m, DRIVE, own[U], own[PHASE])
    speed = mesh.driver_radius * y[n + train.drive] * mesh.time_unit / mesh.length_unit
    unit = mesh.force_unit * mesh.driver_radius
    shaft = shafts[train.drive]
    train.drive_torque = driving_force(m, DRIVE, time, angle, speed) * unit
    shaft.torque += pinion_force(m, time, angle, speed) * unit
    train.pin = 0.0
    if train.pushes != 0:
        x, z = law_force(m, DRIVE, time, angle, speed)
        shaft.load_x += train.cosine * x - train.sine * z
        shaft.load_y += train.sine * x + train.cosine * z
        train.pin = math.hypot(x, z)
    mesh = tm.meshes[train.load_mesh]
    m = model_at(mesh.address)
    mesh_state(tm, train.load_mesh, m, y, own)
    time, angle = t / mesh.time_unit, torque_angle(m, LOAD, own[U], own[PHASE])
    unit = mesh.force_unit * mesh.driven_radius
    train.load_limit = law_limit(m, LOAD, time, angle, own[W]) * unit if resists(m, LOAD) else 0.0
    train.drags = 0.0
    if m.scene.torque[LOAD].acts != 0:
        train.drags = acting(m, LOAD, time, angle, own[W], -0.0) * unit
    shafts[train.load].torque += train.drags


@compiled_once(TRAIN)
def motion(tm: TrainModel, t: float, y: Floats, dy: Floats) -> None:
    """Rates of a train's state at a time [s], and the powers of all works.

    What the shafts, meshes and the train have there stays in their records; histories stay as they are.
    """
    train, shafts, n = tm.train[0], tm.shafts, len(tm.shafts)
    train.evaluations += 1
    train.elements = 0
    if train.ages != 0:
        set_joint_friction(tm, t, y)
    for i in range(n):
        shaft, w = shafts[i], y[n + i]
        shaft.torque = -(shaft.viscous + shaft.drag * abs(w)) * w
        shaft.load_x = shaft.load_y = 0.0
    for k in range(len(tm.meshes)):
        _add_mesh(tm, k, t, y, dy)
    _add_torques(tm, t, y)
    if train.flanks != 0:
        hold_elements(tm, y, dy)
    for i in range(n):
        shaft, w = shafts[i], y[n + i]
        hub = set_limit(tm, i)
        free = not is_at_rest(shaft)
        dy[n + i] = (shaft.torque - shaft.slip * shaft.limit) / shaft.inertia if free else 0.0
        dy[i] = w - shaft.ratio * y[n + train.load]
        if train.balance != 0:
            first, slid = 2 * n + OF_SHAFT * i, shaft.slip * w
            dy[first] = hub * slid
            dy[first + 1] = shaft.hub * tm.joints[i].radius * abs(w)
            dy[first + 2] = shaft.resistance * slid
            dy[first + 3] = (shaft.viscous + shaft.drag * abs(w)) * w * w
    dy[train.load] = train.per_radian * y[n + train.load]
    if train.balance != 0:
        last = 2 * n + OF_SHAFT * n + OF_MESH * len(tm.meshes)
        dy[last] = train.drive_torque * y[n + train.drive]
        dy[last + 1] = train.load_limit * shafts[train.load].slip * y[n + train.load]
        dy[last + 2] = -train.drags * y[n + train.load]
        dy[last + 3] = tm.joints[-1].by_load * train.pin * shafts[train.drive].slip * y[n + train.drive]


@compiled
def torque_slopes(tm: TrainModel, t: float, y: Floats) -> tuple[float, float]:
    """By how much the torques of drive and load [N m] differ at speeds that differ by 1 rad/s.

    Differences are taken over the unit of speed of their meshes.
    """
    train, n, own = tm.train[0], len(tm.shafts), tm.own
    mesh = tm.meshes[train.drive_mesh]
    m, drive, load = model_at(mesh.address), 0.0, 0.0
    if not is_constant(m, DRIVE):
        mesh_state(tm, train.drive_mesh, m, y, own)
        time, angle = t / mesh.time_unit, torque_angle(m, DRIVE, own[U], own[PHASE])
        radius = mesh.driver_radius * mesh.time_unit / mesh.length_unit
        speed = radius * y[n + train.drive]
        faster = driving_force(m, DRIVE, time, angle, speed + 1.0)
        change = abs(faster - driving_force(m, DRIVE, time, angle, speed))
        drive = change * radius * mesh.force_unit * mesh.driver_radius
    mesh = tm.meshes[train.load_mesh]
    m = model_at(mesh.address)
    if not is_constant(m, LOAD):
        mesh_state(tm, train.load_mesh, m, y, own)
        time, angle = t / mesh.time_unit, torque_angle(m, LOAD, own[U], own[PHASE])
        radius = mesh.driven_radius * mesh.time_unit / mesh.length_unit
        faster = driving_force(m, LOAD, time, angle, own[W] + 1.0)
        change = abs(faster - driving_force(m, LOAD, time, angle, own[W]))
        load = change * radius * mesh.force_unit * mesh.driven_radius
    return drive, load
