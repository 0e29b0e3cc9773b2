"""From a scene with several meshes to a train: a pair of gears for each mesh, and what joins them."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Final

import numpy as np

from gearidae.engine.compiling import TRAIN, make_part_ready
from gearidae.engine.events.sliding import AT_ONCE as CREEPS
from gearidae.engine.events.sliding import STILL
from gearidae.engine.model.addresses import Addresses
from gearidae.engine.model.state import DRIVE, LOAD, Floats, Model, Record
from gearidae.engine.pairs.mesh_error import mesh_error
from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.checkpoint import scene_digest
from gearidae.engine.setup.problem import Problem
from gearidae.engine.setup.start import AT_ONCE, Start
from gearidae.engine.train.flanks import NO_FORCE
from gearidae.engine.train.layout import TrainModel, blank_train
from gearidae.engine.train.loop import LOOKS
from gearidae.engine.train.observe import kinetic_energy_of, write_stored
from gearidae.engine.train.start import begin_train
from gearidae.laws.frictions import resists
from gearidae.records import first_sample
from gearidae.scene import Drive, GearScene, Load
from gearidae.scene.joints import PIN_KEYS, Joint, pushes, train_pin
from gearidae.scene.judged import judged_shaft
from gearidae.scene.pitch_errors import error_on_path
from gearidae.scene.scene import TrainScene
from gearidae.scene.train import Train

TURNS_LOW: Final = 16.0
"""Pitches of the load's gear that are taken out of its angle at once, at least."""


@dataclass(slots=True)
class TrainProblem:
    """A train that is ready to run; a driver changes its models in place.

    Attributes
    ----------
    scene : TrainScene
    model : TrainModel
    problems : tuple of Problem
        Of the meshes, as pairs.
    addresses : tuple of Addresses
        Of their models, which they keep alive.
    energies : ndarray, shape (3 meshes,)
        At the start, see `gearidae.engine.train.observe.write_stored`.
    kinetic : float
        Kinetic energy at the start [J].
    digest : tuple of four floats
        Identifies this scene's checkpoints.
    """

    scene: TrainScene
    model: TrainModel
    problems: tuple[Problem, ...]
    addresses: tuple[Addresses, ...]
    energies: Floats = field(init=False)
    kinetic: float = field(init=False)
    digest: tuple[float, ...] = field(init=False)

    def __post_init__(self) -> None:
        """Note the energies at the start, and what tells the scene from others."""
        self.digest = scene_digest(json.dumps(self.scene.to_dict(), sort_keys=True, default=str))
        self.energies = np.zeros(3 * len(self.problems))
        write_stored(self.model, self.model.y, self.energies)
        self.kinetic = float(kinetic_energy_of(self.model, self.model.y))


def make_train(scene: TrainScene, start: Start = AT_ONCE) -> TrainProblem:
    """Lay a train out and set it to its start.

    Parameters
    ----------
    scene : Scene
    start : Start, optional
        Of a run that goes on from another, whose time alone is used.
    """
    make_part_ready(TRAIN)
    train = scene.train
    pairs, problems = _pairs(scene, train, Start(start.time))
    addresses = tuple(_alone(problem.model) for problem in problems)
    rubbing = [problem.model.scene for problem in problems if problem.model.scene.friction.flanks != 0]
    histories = sum(int(s.histories) for s in rubbing)
    tm = blank_train(len(train.shafts), len(train.meshes), histories)
    _add_meshes(tm, scene, train, problems, addresses)
    _add_shafts(tm, scene, train)
    _add_train(tm, scene, train, problems, start.time)
    _set_start(tm, scene, train, pairs, problems)
    begin_train(tm)
    return TrainProblem(scene, tm, problems, addresses)


# -- pairs -----------------------------------------------------------------------------------------------------------


def _ends(train: Train) -> tuple[int, int]:
    """Numbers of the meshes whose pairs have the torques of the drive and of the load."""
    drive = next(k for k, mesh in enumerate(train.meshes) if mesh.a == train.drive)
    load = next(k for k, mesh in enumerate(train.meshes) if mesh.b == train.load)
    return drive, load


_NO_PIN: Final = dict.fromkeys(PIN_KEYS)


def _pairs(scene: TrainScene, train: Train, start: Start) -> tuple[list[GearScene], tuple[Problem, ...]]:
    """Every mesh as a pair of gears: the first at the drive with its torques, the first at the load with those.

    What a pair takes for small depends on its torques; of the others that is the torque of the drive as a rigid train
    would hand it on.
    """
    first, last = _ends(train)
    # the pin is the train's
    drive = scene.drive.model_copy(update={"shaft": None, "orientation": 0.0, "pin_radius": 0.0, **_NO_PIN})
    load = scene.load.model_copy(update={"shaft": None})
    shares = [float(train.shafts[mesh.a].ratio / train.shafts[train.drive].ratio) for mesh in train.meshes]
    pairs, problems = {}, {}
    for k in {first, last}:
        pairs[k] = _pair(scene, train, k, drive if k == first else Drive(), load if k == last else Load())
        problems[k] = make_problem(pairs[k], start=start)
    # the largest torque of the drive's shaft that either end stands for
    torque = max(
        float(problem.model.scene.force_unit) * train.meshes[k].geometry.base_radius_pinion * shares[k]
        for k, problem in problems.items()
    )
    for k, share in enumerate(shares):
        if k not in problems:
            pairs[k] = _pair(scene, train, k, Drive(torque=torque / share), Load())
            problems[k] = make_problem(pairs[k], start=start)
    order = range(len(train.meshes))
    return [pairs[k] for k in order], tuple(problems[k] for k in order)


def _pair(scene: TrainScene, train: Train, k: int, drive: Drive, load: Load) -> GearScene:
    """One mesh of a train with torques; its run keeps nothing, and its bodies are rigid."""
    pair = scene.pair(train.meshes[k].name)
    run = pair.run.model_copy(update={"checkpoints": (), "impacts": False, "passages": False, "stop": "time"})
    bodies = pair.contact.model_copy(update={"bodies": "rigid"})
    tables = {name: getattr(pair, name) for name in ("gears", "mesh", "surface", "coating", "initial")}
    return GearScene(name=pair.name, drive=drive, load=load, contact=bodies, run=run, **tables)


def _alone(m: Model) -> Addresses:
    """Have the model of a pair be one of a mesh: friction is that of the train's shafts, and forces are noted."""
    m.scene.friction.may_stick = m.scene.friction.any_friction = 0
    m.scene.noting = 1
    return Addresses(m)


# -- constants -------------------------------------------------------------------------------------------------------


def _add_meshes(
    tm: TrainModel,
    scene: TrainScene,
    train: Train,
    problems: tuple[Problem, ...],
    addresses: tuple[Addresses, ...],
) -> None:
    """Set the constants of the meshes."""
    load = _teeth_at(train, train.load)
    for mesh, record, problem, address in zip(train.meshes, tm.meshes, problems, addresses, strict=True):
        s, geometry = problem.model.scene, mesh.geometry
        record["address"], record["a"], record["b"] = address.base, mesh.a, mesh.b
        for unit in ("time_unit", "length_unit", "force_unit"):
            record[unit] = s[unit]
        record["driver_radius"], record["driven_radius"] = (
            geometry.base_radius_pinion,
            geometry.base_radius_gear,
        )
        record["offset"], record["phase"] = mesh.offset, mesh.phase % 1.0
        record["ratio"] = float(_turns(train, mesh.b) * geometry.gear_teeth / load)
        record["per_radian"] = geometry.gear_teeth / (2.0 * math.pi)
        sense, alpha = train.shafts[mesh.a].sense, geometry.pressure_angle
        for side, way in (("drive", 1.0), ("coast", -1.0)):
            x, y = math.sin(alpha), way * sense * math.cos(alpha)
            record[f"{side}_x"] = math.cos(mesh.angle) * x - math.sin(mesh.angle) * y
            record[f"{side}_y"] = math.sin(mesh.angle) * x + math.cos(mesh.angle) * y
        for side, way in (("rub", 1.0), ("coast_rub", -1.0)):
            x, y = way * math.cos(alpha), -sense * math.sin(alpha)
            record[f"{side}_x"] = math.cos(mesh.angle) * x - math.sin(mesh.angle) * y
            record[f"{side}_y"] = math.sin(mesh.angle) * x + math.cos(mesh.angle) * y
        record["flanks"] = int(s.friction.flanks)
        record["radius_power"] = int(scene.run.balance and s.curvature_force == 0)


def _turns(train: Train, shaft: int) -> Fraction:
    """Speed of a shaft over that of the load's, a fraction of integers."""
    return train.shafts[shaft].ratio / train.shafts[train.load].ratio


def _teeth_at(train: Train, shaft: int) -> int:
    """Teeth of the first gear by which a shaft is driven."""
    return next(mesh.geometry.gear_teeth for mesh in train.meshes if mesh.b == shaft)


def _add_shafts(tm: TrainModel, scene: TrainScene, train: Train) -> None:
    """Set the constants of the shafts."""
    for number, (laid, record) in enumerate(zip(train.shafts, tm.shafts, strict=True)):
        shaft = scene.shafts[laid.name]
        record["inertia"], record["ratio"] = laid.inertia, float(_turns(train, number))
        for key in ("resistance", "viscous", "drag"):
            record[key] = getattr(shaft, key)
        hub = shaft.hub_of(laid.name)
        if hub is not None:
            _add_joint(tm.joints[number], hub, number, scene)
        record["rubs"] = int(record["resistance"] > 0.0 or (hub is not None and bool(hub.holding)))


def _add_joint(record: Record, joint: Joint, shaft: int, scene: TrainScene) -> None:
    """Set the constants of a hub or the pin, and its age after the rest before the start."""
    record["shaft"], record["radius"], record["hold"] = shaft, joint.radius, joint.holding_torque
    record["fresh"], record["rise"] = joint.coefficient, joint.rise
    record["by_load"], record["constant"] = joint.arm, joint.torque(0.0)
    record["age"], record["friction"] = scene.initial.rest_time, joint.aged(scene.initial.rest_time)
    if joint.rise > 0.0:
        record["ageing_rate"] = 1.0 / joint.ageing_time
        record["forgetting"] = joint.sliding_radius / joint.memory_length


def _add_train(
    tm: TrainModel, scene: TrainScene, train: Train, problems: tuple[Problem, ...], start: float
) -> None:
    """Set what is of the train as a whole."""
    record, drive, run = tm.train[0], scene.drive, scene.run
    record.drive, record.load, record.judged = train.drive, train.load, judged_shaft(scene)
    record.drive_mesh, record.load_mesh = _ends(train)
    if resists(problems[record.load_mesh].model, LOAD):
        tm.shafts[train.load]["rubs"] = 1
    if pushes(drive):
        record.pushes, record.cosine, record.sine = (
            1,
            math.cos(drive.orientation),
            math.sin(drive.orientation),
        )
        pin = train_pin(scene)
        _add_joint(tm.joints[-1], pin, train.drive, scene)
        if pin.holding:
            tm.shafts[train.drive]["rubs"] = 1
    teeth = _teeth_at(train, train.load)
    record.per_radian = teeth / (2.0 * math.pi)
    whole = math.lcm(
        *(_fraction(train, mesh.b, mesh.geometry.gear_teeth, teeth).denominator for mesh in train.meshes)
    )
    # histories go round: each keeps its place where all slots have gone by
    slots = max(int(problem.model.scene.slots) for problem in problems)
    record.period = whole * slots * math.ceil(TURNS_LOW / (whole * slots))
    hubs = [shaft.hub_of(name) for name, shaft in scene.shafts.items()]
    record.flanks = int(tm.meshes["flanks"].any())
    record.hubs = int(any(hub is not None and hub.largest * hub.radius > 0.0 for hub in hubs))
    record.ages = int(tm.joints["rise"].any())
    record.discrete = int(any(problem.model.scene.population.flanks > 0 for problem in problems))
    record.balance, record.samples = int(run.balance), run.sample_count
    record.start, record.end = start, start + run.duration
    record.first_sample = first_sample(start, start + run.duration, run.sample_count)
    record.first_look = first_sample(start, start + run.duration, LOOKS)
    word, _, turns = run.stop.partition(" ")
    record.stop_pitches = float(turns) * teeth if word == "turns" else math.inf
    _add_tolerances(tm, scene, problems)


def _fraction(train: Train, shaft: int, teeth: int, load: int) -> Fraction:
    return _turns(train, shaft) * teeth / load


def _add_tolerances(tm: TrainModel, scene: TrainScene, problems: tuple[Problem, ...]) -> None:
    """Set the tolerances of the states by those of the meshes, and how long steps may be."""
    n, rtol = len(tm.shafts), scene.run.rtol
    radii: list[list[tuple[float, float]]] = [[] for _ in range(n)]
    for mesh, problem in zip(tm.meshes, problems, strict=True):
        s = problem.prepare(rtol, scene.run.sample_count).scene
        for side, radius in (("a", "driver_radius"), ("b", "driven_radius")):
            angle = float(mesh["length_unit"] / mesh[radius])
            radii[int(mesh[side])].append((angle, angle / float(mesh["time_unit"])))
        tau = _own_time(tm, mesh)
        tm.train[0].tau = min(float(tm.train[0].tau) or math.inf, tau)
        longest = float(s.longest_step) or math.inf
        free = float(s.free_step) or math.inf
        step = min(longest, free) * float(mesh["time_unit"])
        tm.train[0].longest_step = min(float(tm.train[0].longest_step) or math.inf, step)
        rest = float(s.rest_search_step) * float(mesh["time_unit"])
        tm.train[0].rest_step = min(float(tm.train[0].rest_step) or math.inf, rest)
    for i, own in enumerate(radii):
        tm.weights[i] = 1.0 / (rtol * min(angle for angle, _ in own))
        tm.weights[n + i] = tm.train[0].tau / (rtol * min(angle for angle, _ in own))
    for mesh in tm.meshes:
        for side, radius in (("a", "driver_radius"), ("b", "driven_radius")):
            at, torque = int(mesh[side]), NO_FORCE * float(mesh["force_unit"] * mesh[radius])
            shaft = tm.shafts[at]
            unit = float(mesh["length_unit"] / (mesh[radius] * mesh["time_unit"]))
            shaft["still"] = max(float(shaft["still"]), STILL * unit)
            shaft["creeps"] = max(float(shaft["creeps"]), CREEPS * unit, 1.0 / float(tm.weights[n + at]))
            shaft["no_torque"] = max(float(shaft["no_torque"]), torque)
    # a phase matters by the gap it opens where tip relief is steepest
    steepest = [
        float(mesh["ratio"]) * float(p.model.scene.relief_curvature * p.model.scene.reach)
        for mesh, p in zip(tm.meshes, problems, strict=True)
    ]
    tm.weights[tm.train[0].load] = max(max(steepest), 1.0) / rtol


def _own_time(tm: TrainModel, mesh: Record) -> float:
    """Time of a mesh by its own masses and force, the fastest of its contacts [s]."""
    first, second = tm.shafts[int(mesh["a"])]["inertia"], tm.shafts[int(mesh["b"])]["inertia"]
    inverse = mesh["driver_radius"] ** 2 / first + mesh["driven_radius"] ** 2 / second
    return math.sqrt(float(mesh["length_unit"]) / (inverse * float(mesh["force_unit"])))


# -- the start -------------------------------------------------------------------------------------------------------


def _set_start(
    tm: TrainModel, scene: TrainScene, train: Train, pairs: list[GearScene], problems: tuple[Problem, ...]
) -> None:
    """Set departures and speeds of the shafts: gaps of the tree's meshes as given, none of them closing or opening."""
    n, initial, y = len(train.shafts), scene.initial, tm.y
    y[n + train.load] = initial.gear_speed
    known = {train.load}
    tree = [k for k, mesh in enumerate(train.meshes) if not mesh.closes]
    while tree:
        k = next(k for k in tree if (train.meshes[k].a in known) != (train.meshes[k].b in known))
        tree.remove(k)
        mesh, m = train.meshes[k], problems[k].model
        sigma, geometry = float(m.scene.length_unit), mesh.geometry
        # at the phase of the start; the gap of a pair beyond its path is that of its relief besides
        phase = mesh.phase % 1.0
        outside = phase - min(phase, float(m.scene.contact_ratio))
        relief = 0.5 * float(m.scene.relief_curvature) * outside**2
        gap = float(initial.gap) + mesh.offset - error_on_path(pairs[k], coast=False)
        u = float(m.scene.clearance[DRIVE]) + relief - gap / sigma
        e = mesh_error(m, u, phase)
        way = (u + e.value) * sigma + mesh.offset
        r, s = geometry.base_radius_pinion, geometry.base_radius_gear
        a, b = mesh.a, mesh.b
        arm, other = (1.0 - e.pinion) * r, (1.0 + e.gear) * s
        if b in known:
            y[a], y[n + a] = (way + s * y[b]) / r, other * y[n + b] / arm
        else:
            y[b], y[n + b] = (r * y[a] - way) / s, arm * y[n + a] / other
        known |= {a, b}
    for i, shaft in enumerate(tm.shafts):
        shaft["begin"] = y[i]
    for mesh, problem in zip(train.meshes, problems, strict=True):
        state = problem.model.state
        state.whole_pitches, state.first_position = math.floor(mesh.phase), mesh.phase
