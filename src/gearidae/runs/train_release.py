r"""Start of a train from rest against adhesion: mesh exits of all its meshes in slow motion.

Mesh k is pressed by what the meshes before it and the hubs pass on, and its leaving pair holds its driven gear back
with :math:`\rho_k` (`gearidae.runs.release`),

.. math::

    R_{kb}\,(F_k - \rho_k) = \sum R_{ja} F_j + h(F_k, F_j),

from the drive to the load. The train turns on if at every angle the torque that arrives at the load overcomes what
resists there. Exits of two meshes that coincide add up, each with the ratio of its stage; whether they coincide follows
from the phases. Angles are those of the drive's shaft.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import reduce
from typing import Final, NamedTuple

import numpy as np

from gearidae.arrays import Floats
from gearidae.runs.release import LeavingPair, largest
from gearidae.runs.train_statics import (
    balancing_forces,
    hubs_at_rest,
    line_of_action,
    resistances,
    starting_torque,
)
from gearidae.scene import TrainScene

_MOST_EXITS: Final = 400
"""Largest number of exits of one mesh that are followed: phases of meshes may repeat only after many more."""
_SAME_PLACE: Final = 1e-6
"""Difference of two angles, in widths of an exit, below which exits of the same meshes are alike."""


class Resistance(NamedTuple):
    """Resistance of a train at the angle where it needs the largest torque.

    Attributes
    ----------
    missing : float
        Torque that the drive lacks [N m]; negative where it has more than it needs.
    held : ndarray, shape (meshes,)
        Forces with which leaving pairs hold the driven gears [N].
    """

    missing: float
    held: Floats


class _Window(NamedTuple):
    """An exit: its mesh, its number among those of the mesh, angles of the drive [rad] where it begins and ends."""

    mesh: int
    number: int
    begin: float
    end: float


class _Passed(NamedTuple):
    """Torque that is missing [N m], forces of the meshes [N], and forces with which their leaving pairs hold [N]."""

    missing: float
    forces: Floats
    held: Floats


class TrainRelease:
    """Mesh exits of a train without loops in slow motion.

    Parameters
    ----------
    scene : Scene
        A train.
    impacts : int
        Exits of each mesh that press its contacts deeper; later exits begin with the gap that these have left.
    """

    def __init__(self, scene: TrainScene, impacts: int) -> None:
        self._scene, self._train, self._impacts = scene, scene.train, impacts
        self._pairs = [LeavingPair(scene.pair(mesh.name)) for mesh in self._train.meshes]
        self._path = self._way_to_the_load()
        self._hubs = hubs_at_rest(scene)
        self._beside = [k for k in range(len(self._train.meshes)) if k not in self._path]
        self._carried = starting_torque(scene)[1]
        self._groups = list(self._grouped(self._windows()))
        self._lines = [line_of_action(self._train, mesh) for mesh in self._train.meshes]
        self._needs = self._constants()

    def _way_to_the_load(self) -> list[int]:
        """Numbers of the meshes from the drive to the load."""
        path: list[int] = []
        shaft = self._train.load
        while shaft != self._train.drive:
            mesh = next(k for k, mesh in enumerate(self._train.meshes) if mesh.b == shaft)
            path.insert(0, mesh)
            shaft = self._train.meshes[mesh].a
        return path

    def _constants(self) -> Floats:
        """Torque on each shaft that its own dry resistance, and its hub without a load, take [N m]."""
        return resistances(self._scene)[0] + [0.0 if hub is None else hub.torque(0.0) for hub in self._hubs]

    def _speed(self, mesh: int) -> float:
        """Speed along the path of contact of a mesh over the angular speed of the drive [m/rad]."""
        there = self._train.meshes[mesh]
        return there.geometry.base_radius_gear * float(self._train.shafts[there.b].ratio)

    def _windows(self) -> Iterator[_Window]:
        """Yield the exits until all meshes have had theirs and phases repeat."""
        meshes = self._train.meshes
        # pitches of each mesh in a turn of the drive
        paces = [mesh.geometry.gear_teeth * self._train.shafts[mesh.b].ratio for mesh in meshes]
        turns = self._impacts / min(paces) + 1 / reduce(_common_divisor, paces)
        for k, mesh in enumerate(meshes):
            speed, pitch = self._speed(k), mesh.geometry.base_pitch
            # the exit of the next pair that leaves
            first = (mesh.geometry.path_length / pitch - mesh.phase) % 1.0
            width = float(self._pairs[k].positions[-1]) / speed
            for number in range(min(math.ceil(turns * paces[k]), _MOST_EXITS)):
                begin = (first + number) * pitch / speed
                yield _Window(k, min(number, self._impacts - 1), begin, begin + width)

    def _grouped(self, windows: Iterator[_Window]) -> Iterator[list[_Window]]:
        """Yield groups of exits that overlap; one that repeats is yielded once."""
        known = set()
        group: list[_Window] = []
        for window in [*sorted(windows, key=lambda w: w.begin), None]:
            if group and (window is None or window.begin >= max(w.end for w in group)):
                scale = _SAME_PLACE * (group[0].end - group[0].begin)
                key = tuple((w.mesh, w.number, round((w.begin - group[0].begin) / scale)) for w in group)
                if key not in known:
                    known.add(key)
                    yield group
                group = []
            if window is not None:
                group.append(window)

    def resistance(self, torque: float) -> Resistance:
        """Follow the exits under a torque of the drive [N m], and return what holds at the worst angle."""
        count = len(self._pairs)
        still = self._passed(torque, np.zeros(count), lambda _k, _force: 0.0)
        gaps = [pair.settled(force) for pair, force in zip(self._pairs, still.forces, strict=True)]
        joined = [np.full(self._impacts, gap) for gap in gaps]
        worst = Resistance(still.missing, np.zeros(count))
        begin = [still.missing, *(-gap for gap in gaps), *[0.0] * count]
        for group in self._groups:
            most = self._follow(torque, group, joined, begin)
            if most[0] > worst.missing:
                worst = Resistance(most[0], np.array(most[1 + count :]))
        return worst

    def _follow(
        self, torque: float, group: Sequence[_Window], joined: Sequence[Floats], begin: list[float]
    ) -> Sequence[float]:
        """Follow exits that overlap; the gaps to which contacts are pressed go into `joined`, by mesh and exit."""
        positions = np.unique(
            np.concatenate([w.begin + self._pairs[w.mesh].positions / self._speed(w.mesh) for w in group])
        )

        def at(position: float, near: Sequence[float]) -> list[float]:
            return self._largest_torques(torque, position, near, group, joined)

        followed, ending = [begin], sorted(group, key=lambda window: window.end)
        for number, position in enumerate(positions[1:], 1):
            followed.append(at(float(position), followed[-1]))
            while ending and ending[0].end <= position:
                window = ending.pop(0)
                k, exit_number, first = (
                    window.mesh,
                    window.number,
                    int(np.searchsorted(positions, window.begin)),
                )
                if exit_number < self._impacts - 1:
                    inside = slice(first, number + 1)
                    deepest = largest(at, positions[inside], followed[inside], 1 + k)[1 + k]
                    joined[k][exit_number + 1 :] = min(joined[k][exit_number], -deepest)
        return largest(at, positions, followed, 0)

    def _largest_torques(
        self,
        torque: float,
        position: float,
        near: Sequence[float],
        group: Sequence[_Window],
        joined: Sequence[Floats],
    ) -> list[float]:
        """Torque that is missing at an angle of the drive [rad], depths of all gaps, and resistances."""
        count = len(self._pairs)
        depths, held = list(near[1 : 1 + count]), np.array(near[1 + count :])

        def hold(k: int, force: float) -> float:
            there = next((w for w in group if w.mesh == k and w.begin <= position <= w.end), None)
            if there is None:
                return 0.0
            pair = self._pairs[k]
            beyond = min((position - there.begin) * self._speed(k), float(pair.positions[-1]))
            depths[k], resistance = pair.balanced(beyond, -depths[k], joined[k][there.number], force)
            return resistance

        passed = self._passed(torque, held, hold)
        return [passed.missing, *depths, *passed.held]

    def _passed(self, torque: float, near: Floats, hold: Callable[[int, float], float]) -> _Passed:
        """Hand a torque [N m] on from the drive to the load.

        Meshes that do not lead to the load carry what their shafts take, with the resistances `near`, which change
        little from angle to angle.
        """
        train, arriving, before = self._train, torque, np.zeros(2)
        forces, held = np.zeros(len(self._pairs)), np.zeros(len(self._pairs))
        if self._beside:
            carried = starting_torque(self._scene, near)[1]
            for k in self._beside:
                forces[k], held[k] = carried[k], hold(k, carried[k])
        for step in range(len(self._path) + 1):
            last = step == len(self._path)
            shaft = train.load if last else train.meshes[self._path[step]].a
            hub, ratio = self._hubs[shaft], float(train.shafts[shaft].ratio)
            arm, left, pushed = 0.0 if hub is None else hub.arm, arriving - self._needs[shaft], before
            for side in self._beside:
                if train.meshes[side].a == shaft:
                    left -= train.meshes[side].geometry.base_radius_pinion * forces[side]
                    pushed = pushed - forces[side] * self._lines[side]
            missing = ratio * (arm * math.hypot(*pushed) - left)
            if last:
                break
            k = self._path[step]
            mesh = train.meshes[k]
            radius = mesh.geometry.base_radius_pinion
            if missing > 0.0:
                # nothing passes: what comes after lacks what it needs without adhesion, too
                return _Passed(float(missing) + ratio * radius * float(self._carried[k]), forces, held)
            candidates = balancing_forces(radius, arm, left, self._lines[k], pushed)
            forces[k] = max(force for force in candidates if radius * force <= left * (1.0 + 1e-12))
            held[k] = hold(k, float(forces[k]))
            arriving = mesh.geometry.base_radius_gear * (forces[k] - held[k])
            before = forces[k] * self._lines[k]
        return _Passed(float(missing), forces, held)


def _common_divisor(one: Fraction, other: Fraction) -> Fraction:
    """Largest number of which both are whole multiples."""
    down = one.denominator * other.denominator
    return Fraction(math.gcd(one.numerator * other.denominator, other.numerator * one.denominator), down)
