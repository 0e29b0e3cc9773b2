"""What is recorded of a train: samples, extremes, and energies, in SI units."""

from __future__ import annotations

import math
from typing import Final

from gearidae.arrays import Floats
from gearidae.compiled import compiled
from gearidae.engine.laws.pairs import stored_energy
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import PHASE, U
from gearidae.engine.observers.adhesion_loss import total_adhesion_lag
from gearidae.engine.pairs.tooth_pairs import flank_gaps, rigid_separation
from gearidae.engine.train.formula import state_at
from gearidae.engine.train.layout import OF_MESH, OF_SHAFT, TrainModel
from gearidae.engine.train.motion import mesh_state, motion
from gearidae.records.train_results import MESH_SAMPLES, SHAFT_SAMPLES

_SHAFT_COLUMNS: Final = len(SHAFT_SAMPLES)
_MESH_COLUMNS: Final = len(MESH_SAMPLES)
NEAR: Final = 0.01
"""Share by which the force of a stage may lie beside that of the step's polynomial, at most: within this of an extreme
so far a step is looked at closely."""
FORCE_SAMPLES: Final = 9
"""Times of a step at which the force is then evaluated, before its extreme is bracketed."""
HALVINGS: Final = 40
"""Of the bracket by the golden section."""
_GOLDEN: Final = 0.5 * (math.sqrt(5.0) - 1.0)


@compiled
def shaft_angle(tm: TrainModel, i: int, y: Floats) -> float:
    """Angle of a shaft since the start [rad]."""
    train, shaft = tm.train[0], tm.shafts[i]
    turned = (train.whole_pitches + y[train.load]) / train.per_radian
    departure = 0.0 if i == train.load else y[i] - shaft.begin
    return float(shaft.ratio * turned + departure)


@compiled
def observe_train(tm: TrainModel, t: float, y: Floats, row: Floats) -> None:
    """Write one sample at a time [s], with the histories as they are; see `gearidae.records.train_results`."""
    train, n, at = tm.train[0], len(tm.shafts), 0
    motion(tm, t, y, tm.rates[15])
    for i in range(n):
        shaft = tm.shafts[i]
        row[at], row[at + 1] = y[n + i], shaft_angle(tm, i, y)
        row[at + 2], row[at + 3] = shaft.hub, math.atan2(shaft.load_y, shaft.load_x)
        row[at + 4] = tm.joints[i].friction
        at += _SHAFT_COLUMNS
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        m = model_at(mesh.address)
        mesh_state(tm, k, m, y, tm.own)
        drive, coast, touching = flank_gaps(m, tm.own)
        row[at], row[at + 1] = mesh.force, mesh.error
        row[at + 2], row[at + 3] = drive * mesh.length_unit, coast * mesh.length_unit
        row[at + 4] = touching
        at += _MESH_COLUMNS
    shaft = tm.shafts[train.load]
    resistance = train.load_limit * shaft.slip
    if shaft.slip == 0.0 and shaft.rubs != 0:
        resistance = min(max(shaft.torque, -train.load_limit), train.load_limit)
    row[at], row[at + 1], row[at + 2] = train.drive_torque, resistance - train.drags, train.pin
    row[at + 3] = tm.joints[n].friction


# -- extremes --------------------------------------------------------------------------------------------------------


@compiled
def _force_at(tm: TrainModel, k: int, share: float, h: float) -> float:
    """Force of a mesh at a share of the step whose polynomial is known."""
    state_at(tm, share, 2 * len(tm.shafts), tm.between)
    motion(tm, tm.train[0].time + share * h, tm.between, tm.rates[15])
    return float(tm.meshes[k].force)


@compiled
def _extreme_force(tm: TrainModel, k: int, end: float, h: float, sign: float) -> tuple[float, float]:
    """Extreme of the force of a mesh times a sign in a step up to a share of it, and its share."""
    best, best_share = -math.inf, 0.0
    for i in range(FORCE_SAMPLES):
        share = end * i / (FORCE_SAMPLES - 1)
        value = sign * _force_at(tm, k, share, h)
        if value > best:
            best, best_share = value, share
    part = end / (FORCE_SAMPLES - 1)
    low, high = max(best_share - part, 0.0), min(best_share + part, end)
    a, b = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_a, at_b = sign * _force_at(tm, k, a, h), sign * _force_at(tm, k, b, h)
    for _ in range(HALVINGS):
        if at_a > at_b:
            high, b, at_b = b, a, at_a
            a = high - _GOLDEN * (high - low)
            at_a = sign * _force_at(tm, k, a, h)
        else:
            low, a, at_a = a, b, at_b
            b = low + _GOLDEN * (high - low)
            at_b = sign * _force_at(tm, k, b, h)
    middle = 0.5 * (low + high)
    value = sign * _force_at(tm, k, middle, h)
    return (value, middle) if value > best else (best, best_share)


@compiled
def wants_polynomial(tm: TrainModel) -> bool:
    """Whether a step may hold an extreme of a mesh's force, by the forces of its stages."""
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        if mesh.step_high + NEAR * abs(mesh.step_high) > mesh.largest:
            return True
        if mesh.step_low - NEAR * abs(mesh.step_low) < mesh.smallest:
            return True
    return False


@compiled
def follow_forces(tm: TrainModel, end: float, h: float) -> None:
    """Take the extremes of the meshes' forces in a step up to a share of it, whose polynomial is known."""
    train = tm.train[0]
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        high, low = mesh.step_high, mesh.step_low
        if high + NEAR * abs(high) > mesh.largest:
            value, share = _extreme_force(tm, k, end, h, 1.0)
            if value > mesh.largest:
                mesh.largest, mesh.largest_time = value, train.time + share * h
        if low - NEAR * abs(low) < mesh.smallest:
            value, share = _extreme_force(tm, k, end, h, -1.0)
            if -value < mesh.smallest:
                mesh.smallest, mesh.smallest_time = -value, train.time + share * h


@compiled
def note_forces(tm: TrainModel, t: float) -> None:
    """Take the forces of the meshes at a time [s] at which the motion has been evaluated last."""
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        if mesh.force > mesh.largest:
            mesh.largest, mesh.largest_time = mesh.force, t
        if mesh.force < mesh.smallest:
            mesh.smallest, mesh.smallest_time = mesh.force, t


@compiled
def _extreme_between(h: float, w: float, rate: float, later: float, later_rate: float) -> float:
    """Speed where the cubic through two speeds with their rates has its extreme, of rates of opposite sign."""
    change = (later - w) / h
    # of the cubic over its way s the slope is rate + 2 b s + a s^2
    a, b = 3.0 * (rate + later_rate - 2.0 * change), 3.0 * change - 2.0 * rate - later_rate
    root = math.sqrt(max(b * b - a * rate, 0.0))
    s = -rate / (b + math.copysign(root, b)) if b != 0.0 or root != 0.0 else 0.5
    if not 0.0 < s < 1.0:
        s = -(b + math.copysign(root, b)) / a if a != 0.0 else 0.5
    s = min(max(s, 0.0), 1.0)
    return w + h * s * (rate + s * (b + s * a / 3.0))


@compiled
def follow_shafts(tm: TrainModel, h: float) -> None:
    """Take the extremes of the speeds and the smallest distances in a step of the length h, at its end."""
    n = len(tm.shafts)
    for i in range(n):
        shaft, before, after = tm.shafts[i], tm.y[n + i], tm.new[n + i]
        rate, later = tm.rates[0, n + i], tm.rates[12, n + i]
        between = _extreme_between(h, before, rate, after, later) if rate * later < 0.0 else after
        shaft.min_speed = min(shaft.min_speed, after, between)
        shaft.max_speed = max(shaft.max_speed, after, between)
    note_separation(tm, tm.new)


@compiled
def note_separation(tm: TrainModel, y: Floats) -> None:
    """Take the smallest distances of the flanks at a state: a gap that turns round is an accepted time."""
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        m = model_at(mesh.address)
        mesh_state(tm, k, m, y, tm.own)
        distance = rigid_separation(m, tm.own[U], tm.own[PHASE]) * mesh.length_unit
        mesh.separation = min(mesh.separation, distance)


@compiled
def begin_extremes(tm: TrainModel, t: float, y: Floats) -> None:
    """Begin the extremes at a start, of which the motion has been evaluated."""
    n = len(tm.shafts)
    for i in range(n):
        tm.shafts[i].min_speed = tm.shafts[i].max_speed = y[n + i]
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        mesh.largest = mesh.smallest = mesh.force
        mesh.largest_time = mesh.smallest_time = t
        mesh.separation = math.inf
    note_separation(tm, y)


# -- energies --------------------------------------------------------------------------------------------------------


@compiled
def kinetic_energy_of(tm: TrainModel, y: Floats) -> float:
    """Kinetic energy of all shafts [J]."""
    energy, n = 0.0, len(tm.shafts)
    for i in range(n):
        energy += 0.5 * tm.shafts[i].inertia * y[n + i] * y[n + i]
    return energy


@compiled
def account(tm: TrainModel, y: Floats, new: Floats) -> None:
    """Add what has been exchanged in a step."""
    train, n = tm.train[0], len(tm.shafts)
    kinetic, first = kinetic_energy_of(tm, new), 2 * n
    for i in range(n):
        for j in (0, 2, 3):
            at = first + OF_SHAFT * i + j
            train.throughput += abs(new[at] - y[at])
    first += OF_SHAFT * n
    for k in range(len(tm.meshes)):
        for j in range(3):
            at = first + OF_MESH * k + j
            train.throughput += abs(new[at] - y[at])
    first += OF_MESH * len(tm.meshes)
    for at in range(first, y.size):  # of the train, and of flanks with friction
        train.throughput += abs(new[at] - y[at])
    train.throughput += abs(kinetic - train.kinetic)
    train.peak_kinetic, train.kinetic = max(train.peak_kinetic, kinetic), kinetic


@compiled
def write_stored(tm: TrainModel, y: Floats, out: Floats) -> None:
    """Write for each mesh the energy that its contacts store, the adhesion loss and the radius work so far [J]."""
    last = 2 * len(tm.shafts) + OF_SHAFT * len(tm.shafts)
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        m, unit = model_at(mesh.address), mesh.force_unit * mesh.length_unit
        mesh_state(tm, k, m, y, tm.own)
        (stored, pending), adhesion_lag = stored_energy(m, tm.own), total_adhesion_lag(m)
        out[3 * k] = (stored - pending) * unit
        out[3 * k + 1] = (m.state.energy.adhesion_loss + pending - adhesion_lag) * unit
        radius = m.state.energy.radius_work - (adhesion_lag if mesh.radius_power != 0 else 0.0)
        out[3 * k + 2] = y[last + OF_MESH * k + 2] + radius * unit
