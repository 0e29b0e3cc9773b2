"""Statics of a train: forces of its meshes, loads of its hubs, its modes, the torque that starts it.

Forces are those of steady motion without friction under the mean drive, by the balance of each shaft,

    sum over meshes that drive it: R_b F  -  sum over those that it drives: R_a F  =  torque that resists it,

with the compliance of the contacts where shafts share their load in a loop. A mesh pushes its driven gear along
``n = rot(theta) (sin alpha, s cos alpha)``, with the sense s of its driver; hubs carry the vector sum.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.errors import SceneError, SolverError
from gearidae.laws.frictions import mean_limit
from gearidae.laws.law import LOAD
from gearidae.mesh.involute import curvature_radii, separation
from gearidae.mesh.pair_contact import PairContact, pair_contact
from gearidae.mesh.train_modes import levers
from gearidae.runs.estimates import TURNS_NOTHING, mean_over_run
from gearidae.scene import GearScene, TrainScene
from gearidae.scene.joints import Joint
from gearidae.scene.judged import judged_pitch, judged_shaft
from gearidae.scene.train import Train, TrainMesh

_NEWTON: Final = 200
_LONGEST: Final = 0.5
"""Longest step of Newton's iteration in roughnesses: the force of a contact grows e-fold over a quarter of one."""
_BALANCED: Final = 1e-12
"""Error of the balance, over the torques that it is the sum of, at which the iteration ends.

Teeth that adhere may press each other in a loop with thousands of times what the drive gives: rounding is theirs."""

_IN_TURN: Final = 200
"""Times that forces and friction of a loop are found in turn; the change falls by the share of friction each time."""
_LOCKS: Final = 1e3
"""Over the torque without loads of the hubs: what grows beyond that is taken to lock."""
_SAME: Final = 1e-10
"""Relative change of a starting torque at which that ends."""


def ratios(train: Train) -> Floats:
    """Speeds of the shafts over that of the drive's."""
    return np.array([float(shaft.ratio) for shaft in train.shafts])


def steady_speed(scene: TrainScene) -> float:
    """Speed of the drive's shaft [rad/s] at which the mean torques balance without friction.

    Returns
    -------
    float
        0 if the drive does not overcome the dry resistance, infinite if nothing slows the train down.
    """
    drive, ratio = scene.drive, ratios(scene.train)
    dry, viscous, drag = resistances(scene)
    linear = float(viscous @ ratio**2) + drive.speed_gain
    surplus = _own_torque(scene) - float(dry @ ratio)
    surplus += drive.speed_gain * mean_over_run(scene, 0.0, drive.speed_knots())
    if surplus <= 0.0:
        return 0.0
    slowing = linear + math.sqrt(linear**2 + 4.0 * float(drag @ ratio**3) * surplus)
    return 2.0 * surplus / slowing if slowing > 0.0 else math.inf


def waiting_time(scene: TrainScene) -> float:
    """Time of a pitch of the judged shaft [s], by which a study counts how long mesh exits take.

    At `steady_speed`, or the initial speed without any.

    Raises
    ------
    SceneError
        If neither turns the train on.
    """
    shafts = scene.train.shafts
    speed = steady_speed(scene)
    if not 0.0 < speed < math.inf:
        speed = scene.initial.gear_speed / float(shafts[scene.train.load].ratio)
    if speed <= 0.0:
        raise SceneError("drive.torque", scene.drive.torque, TURNS_NOTHING)
    return judged_pitch(scene) / (speed * float(shafts[judged_shaft(scene)].ratio))


def _own_torque(scene: TrainScene) -> float:
    return mean_over_run(scene, scene.drive.torque, scene.drive.schedule)


def resistances(scene: GearScene | TrainScene) -> tuple[Floats, Floats, Floats]:
    """Mean dry resistance [N m], viscous [N m s] and quadratic drag [N m s^2] of each shaft, with those of the load."""
    assert scene.shafts is not None  # a pair derives them
    shafts = scene.shafts.values()
    dry, viscous, drag = (
        np.array([getattr(shaft, key) for shaft in shafts]) for key in ("resistance", "viscous", "drag")
    )
    load, number = scene.load, scene.train.load
    dry[number] += mean_limit(scene, LOAD, mean_over_run)
    viscous[number] += load.viscous
    drag[number] += load.drag
    return dry, viscous, drag


def resisting_torques(scene: TrainScene) -> tuple[float, Floats]:
    """Mean torque of the drive [N m], and the torques that balance it on all shafts [N m].

    What resists at the steady speed; while the train stands, dry resistances in proportion; where nothing resists, the
    inertias of a train that speeds up. Of a drive with a law or a held speed what the load takes, at the initial speed.
    """
    drive, train = scene.drive, scene.train
    ratio = ratios(train)
    dry, viscous, drag = resistances(scene)
    speed = steady_speed(scene)
    if drive.law is not None:
        speed = abs(scene.initial.gear_speed) / float(train.shafts[train.load].ratio)
    turning = speed if math.isfinite(speed) else 0.0
    taken = dry + viscous * ratio * turning + drag * (ratio * turning) ** 2
    torque = _own_torque(scene)
    if drive.law is not None or drive.speed is not None:
        return max(float(taken @ ratio), torque * (drive.speed is None)), taken
    if not np.any(taken):
        taken = np.array([shaft.inertia for shaft in train.shafts]) * ratio
    return torque, taken * (torque / float(taken @ ratio))


def mesh_forces(scene: TrainScene) -> Floats:
    """Forces of the meshes [N] under the mean drive, at the phases of the start where a loop shares its load."""
    train = scene.train
    torque, taken = resisting_torques(scene)
    arms, outside = levers(train), -taken
    outside[train.drive] += torque
    # what every shaft is short of is what its meshes have to give; the equations add up to 0 by the ratios
    if len(train.meshes) == len(train.shafts) - 1 or not outside.any():
        return np.asarray(np.linalg.lstsq(arms.T, outside, rcond=None)[0])
    return _shared(_contacts(scene), arms, outside, torque)


def stages(scene: TrainScene) -> Iterator[tuple[str, GearScene]]:
    """Yield the name of each mesh, and its pair under a constant torque that gives the mesh's mean force."""
    for mesh, force in zip(scene.train.meshes, mesh_forces(scene), strict=True):
        torque = float(force) * mesh.geometry.base_radius_pinion
        yield mesh.name, scene.pair(mesh.name).replace({"drive": {"torque": torque}, "load": None})


def _contacts(scene: TrainScene) -> list[_Mesh]:
    """Contacts of all meshes at the phases of the start."""
    return [_Mesh(scene, mesh) for mesh in scene.train.meshes]


def _shared(contacts: Sequence[_Mesh], arms: Floats, outside: Floats, torque: float) -> Floats:
    """Forces of a train with loops: angles of the shafts at which the contacts balance all torques, by Newton.

    Parameters
    ----------
    contacts : sequence of _Mesh
    arms : ndarray, shape (meshes, shafts)
        From `levers`.
    outside : ndarray, shape (shafts,)
        Torques besides those of the meshes [N m].
    torque : float
        Of the drive [N m].

    Raises
    ------
    SolverError
        If no such angles are found.
    """
    sigma = np.array([contact.sigma for contact in contacts])
    offset = np.array([contact.offset for contact in contacts])
    guess = np.linalg.lstsq(arms.T, outside, rcond=None)[0]
    least = 1e-3 * np.abs(guess).max()
    start = [contact.error_at(max(force, least)) for contact, force in zip(contacts, guess, strict=True)]
    arms, outside = arms[:, :-1], outside[:-1]  # one shaft may stand where it is
    angles = np.linalg.lstsq(arms, np.array(start) + offset, rcond=None)[0]
    for _ in range(_NEWTON):
        errors = arms @ angles - offset
        forces, stiffness = np.array([c.force(u) for c, u in zip(contacts, errors, strict=True)]).T
        left = outside - arms.T @ forces
        parts = np.abs(arms).T @ np.abs(forces)
        if np.abs(left).max() <= _BALANCED * max(abs(torque), float(parts.max())):
            return np.asarray(forces)
        change = np.linalg.lstsq(arms.T @ (stiffness[:, None] * arms), left, rcond=1e-14)[0]
        step = np.abs(arms @ change) / sigma
        angles = angles + change * min(1.0, _LONGEST / max(step.max(), 1e-30))
    short = np.abs(left).max() / abs(torque)
    raise SolverError(
        f"forces of a train with a loop were not found: a shaft lacks {short:.2g} of the drive's torque",
        time=0.0,
        state={},
        last_event="none",
        advice="check the torques, and the offsets and surfaces of the meshes",
    )


class _Mesh:
    """Drive flank of a mesh at the phase of the start, all pairs that are in reach."""

    def __init__(self, scene: TrainScene, mesh: TrainMesh) -> None:
        contact, geometry = pair_contact(scene.pair(mesh.name)), mesh.geometry
        self.half, self.sigma, self.offset = 0.5 * mesh.mesh.backlash, mesh.surface.roughness, mesh.offset
        first = mesh.phase - math.floor(mesh.phase) - 1.0
        positions = np.arange(first, geometry.contact_ratio + 1.0) * geometry.base_pitch
        radii = curvature_radii(geometry, positions)[2]
        relief = separation(geometry, positions, mesh.mesh.tip_relief_radius)[0]
        # a pair that tip relief holds far off carries nothing
        self.pairs: list[tuple[PairContact, float]] = [
            (replace(contact, radius=float(radius)), float(away))
            for radius, away in zip(radii, relief, strict=True)
            if away < 30.0 * self.sigma
        ]

    def force(self, error: float) -> tuple[float, float]:
        """Force [N] and stiffness [N/m] at a transmission error [m]."""
        gaps = [(contact, self.half - error + away) for contact, away in self.pairs]
        return (
            sum(float(contact.force(gap)) for contact, gap in gaps),
            sum(contact.stiffness(gap) for contact, gap in gaps),
        )

    def error_at(self, load: float) -> float:
        """Transmission error [m] at which the nearest pair alone carries a load [N]."""
        contact, away = min(self.pairs, key=lambda pair: pair[1])
        return self.half + away - contact.resting_gap(load, 1e-6)


def line_of_action(train: Train, mesh: TrainMesh) -> Floats:
    """Direction in which a mesh pushes its driven gear on the drive flank, in the frame."""
    alpha, sense = mesh.geometry.pressure_angle, train.shafts[mesh.a].sense
    across, along = math.sin(alpha), sense * math.cos(alpha)
    cosine, sine = math.cos(mesh.angle), math.sin(mesh.angle)
    return np.array([cosine * across - sine * along, sine * across + cosine * along])


def hubs_at_rest(scene: TrainScene) -> list[Joint | None]:
    """Hubs of all shafts with the friction that they have after ``initial.rest_time``, None of a shaft without one."""
    hubs = [shaft.hub_of(name) for name, shaft in scene.shafts.items()]
    return [None if hub is None else hub.of_age(scene.initial.rest_time) for hub in hubs]


def hub_loads(train: Train, forces: Floats) -> Floats:
    """Vectors of what the meshes push on each shaft with, shape (shafts, 2) [N]."""
    loads = np.zeros((len(train.shafts), 2))
    for mesh, force in zip(train.meshes, forces, strict=True):
        push = force * line_of_action(train, mesh)
        loads[mesh.b] += push
        loads[mesh.a] -= push
    return loads


def starting_torque(
    scene: TrainScene, held: Floats | None = None, *, hubs: Collection[int] | None = None
) -> tuple[float, Floats]:
    """Torque of the drive that overcomes all dry loads and hubs, and what adhesion of the teeth holds.

    From the last shaft back to the drive, each is on the point of slipping,

        R_b (F - H) = sum R_a F' + dry + mu [r (|F n - V| + A) + r_d P],

    with the forces F' of the meshes that it drives and their vector sum V. Where loops share their load, they do by the
    compliance of the contacts, at the phases of the start.

    Parameters
    ----------
    scene : Scene
        A train.
    held : ndarray, shape (meshes,), optional
        Forces H at the driven gears' base circles that adhesion takes [N]; default none.
    hubs : collection of int, optional
        Numbers of the shafts whose hubs have friction; default all.

    Returns
    -------
    torque : float
        [N m]; infinite where a hub locks, NaN where adhesion holds a train with loops.
    forces : ndarray, shape (meshes,)
        [N].

    Raises
    ------
    SolverError
        If the forces of a loop are not found.
    """
    return _limit(scene, held, hubs, 1.0)


def run_back_torque(scene: TrainScene) -> tuple[float, Floats]:
    """Torque of the drive below which the train runs back if its dry loads are torques that push it back.

    As `starting_torque` with the friction of the hubs reversed, and without adhesion: what a lock or a weight needs.

    Returns
    -------
    torque : float
        [N m]; at most 0 where it cannot be driven back.
    forces : ndarray, shape (meshes,)
        [N].
    """
    return _limit(scene, None, None, -1.0)


def _limit(
    scene: TrainScene, held: Floats | None, hubs: Collection[int] | None, way: float
) -> tuple[float, Floats]:
    """Torque of the drive at which the train begins to move forward (way 1) or back (-1), and forces of the meshes."""
    train = scene.train
    forces = np.full(len(train.meshes), math.nan)
    slipping = [
        hub if hubs is None or number in hubs else None for number, hub in enumerate(hubs_at_rest(scene))
    ]
    if train.loops:
        return _limit_of_loops(scene, slipping, way) if held is None or not held.any() else (math.nan, forces)
    dry = resistances(scene)[0]
    for number in reversed(_outwards(train)):
        hub = slipping[number]
        driven = [k for k, mesh in enumerate(train.meshes) if mesh.a == number]
        pushed = sum((forces[k] * line_of_action(train, train.meshes[k]) for k in driven), np.zeros(2))
        constant = dry[number] + way * (0.0 if hub is None else hub.torque(0.0))
        constant += sum(train.meshes[k].geometry.base_radius_pinion * forces[k] for k in driven)
        arm = 0.0 if hub is None else hub.arm
        if number == train.drive:
            return float(constant + way * arm * math.hypot(*pushed)), forces
        mine = next(k for k, mesh in enumerate(train.meshes) if mesh.b == number)
        mesh = train.meshes[mine]
        radius = mesh.geometry.base_radius_gear
        constant += 0.0 if held is None else radius * held[mine]
        forces[mine] = _slipping(radius, arm, constant, line_of_action(train, mesh), pushed, way)
        if math.isinf(forces[mine]):
            return math.inf, forces
    raise AssertionError("the drive's shaft is the first")


def _limit_of_loops(scene: TrainScene, hubs: Sequence[Joint | None], way: float) -> tuple[float, Floats]:
    """`_limit` of a train with loops: hubs slip under the loads that their own friction adds to, in turn."""
    train, contacts = scene.train, _contacts(scene)
    ratio, arms, dry = ratios(train), levers(train), resistances(scene)[0]
    torque, least, forces = math.inf, math.inf, np.zeros(len(contacts))
    for _ in range(_IN_TURN):
        loads = np.hypot(*hub_loads(train, forces).T)
        friction = [0.0 if hub is None else hub.torque(load) for hub, load in zip(hubs, loads, strict=True)]
        taken = dry + way * np.array(friction)
        before, torque = torque, float(taken @ ratio)
        least = min(least, torque)
        if torque <= 0.0 or abs(torque - before) <= _SAME * torque:
            return torque, forces
        if torque > _LOCKS * least:
            break
        outside = -taken
        outside[train.drive] += torque
        forces = _shared(contacts, arms, outside, torque)
    return math.inf if way > 0.0 else 0.0, forces


def _outwards(train: Train) -> list[int]:
    """Numbers of the shafts of a train without loops, each after the one that drives it."""
    order = [train.drive]
    for number in order:
        order += [mesh.b for mesh in train.meshes if mesh.a == number]
    return order


def _slipping(radius: float, arm: float, constant: float, line: Floats, pushed: Floats, way: float) -> float:
    """Force F with ``R F = C + way m |F n - V|``: the smallest of a start, infinite where there is none."""
    candidates = balancing_forces(radius, arm, constant, line, pushed)
    sides = [force for force in candidates if way * (radius * force - constant) >= -1e-12 * abs(constant)]
    return min(sides, default=math.inf) if way > 0.0 else max(sides, default=0.0)


def balancing_forces(radius: float, arm: float, constant: float, line: Floats, pushed: Floats) -> list[float]:
    """Both forces F with ``(R F - C)^2 = m^2 |F n - V|^2``; none where a hub locks."""
    square = radius**2 - arm**2
    half = radius * constant - arm**2 * float(line @ pushed)
    rest = constant**2 - arm**2 * float(pushed @ pushed)
    # half^2 - square rest, without the difference of near numbers: exactly 0 without a hub
    away, across = radius * pushed - constant * line, line[0] * pushed[1] - line[1] * pushed[0]
    root = arm**2 * float(away @ away - (arm * across) ** 2)
    if root < 0.0:
        return []
    # the two roots without the difference of near numbers
    large = half + math.copysign(math.sqrt(root), half)
    return [large / square if square != 0.0 else math.inf, rest / large if large != 0.0 else 0.0]


def overlapping(train: Train) -> Iterator[tuple[str, str]]:
    """Yield the pairs of gears of different shafts without a mesh whose tip circles overlap."""
    tips: dict[str, tuple[int, float]] = {}
    for mesh in train.meshes:
        geometry = mesh.geometry
        for gear, shaft, base in (
            (mesh.driver, mesh.a, geometry.base_radius_pinion),
            (mesh.driven, mesh.b, geometry.base_radius_gear),
        ):
            tips[gear] = (shaft, base / math.cos(geometry.pressure_angle) + geometry.module)
    met = {frozenset((mesh.driver, mesh.driven)) for mesh in train.meshes}
    names = list(tips)
    for number, first in enumerate(names):
        for second in names[number + 1 :]:
            (one, tip), (other, reach) = tips[first], tips[second]
            away = math.dist(train.shafts[one].centre, train.shafts[other].centre)
            if one != other and frozenset((first, second)) not in met and away < tip + reach:
                yield first, second
