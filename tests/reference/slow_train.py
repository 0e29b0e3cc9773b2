"""A train in plain SI numbers: the readable force law of smooth tips, DOP853, nothing compiled, nothing of the engine.

The slow twin of an engine for trains. Asperities have no memory (Hertz) or are pressed for the first time, loads are
dry and turn all the time, so that nothing has to be remembered and no shaft is held: friction of a hub is that of a
shaft that slips.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from gearidae.mesh import curvature_radii, separation
from gearidae.mesh.pair_contact import pair_contact
from gearidae.torques import torque_law

REACH = 9.0
"""Roughnesses beyond which a force is below 1e-10 of those that press."""
DEEPEST = -2.0
"""Roughnesses to which the law is tabulated."""


class SlowMesh:
    """Force of one mesh, both flanks."""

    def __init__(self, scene, mesh):
        self.mesh, self.geometry = mesh, mesh.geometry
        contact = pair_contact(scene.pair(mesh.name))
        self.half, self.sigma, self.pitch = (
            0.5 * mesh.mesh.backlash,
            mesh.surface.roughness,
            mesh.geometry.base_pitch,
        )
        gaps = np.linspace(DEEPEST, REACH, 4001) * self.sigma
        force = contact.force(gaps)
        # of a rigid body the force goes with the root of the radius; its logarithm is smooth
        pushes = CubicSpline(gaps, np.log(force)) if (force > 0.0).all() else None
        self.law = CubicSpline(gaps, force) if pushes is None else lambda deep: np.exp(pushes(deep))
        self.radius = contact.radius

    def flank(self, gap, places):
        """Force [N] of pairs at places on the path [m] and a gap on it, and the same times the slope of the relief."""
        away, slope = separation(self.geometry, places, self.mesh.mesh.tip_relief_radius)
        near = gap + away < REACH * self.sigma
        if not near.any():
            return np.zeros(2)
        deep = np.maximum(gap + away[near], DEEPEST * self.sigma)  # a step that is tried and refused
        radii = curvature_radii(self.geometry, places[near])[2]
        force = self.law(deep) * np.sqrt(radii / self.radius)
        return np.array([force.sum(), force @ slope[near]])

    def forces(self, error, turned):
        """Forces F and Fs of the drive and the coast flank [N] at a transmission error and a way R2 phi2 [m]."""
        begin = self.mesh.phase * self.pitch + turned
        places = begin - (np.floor(begin / self.pitch) + np.arange(-3.0, 3.0)) * self.pitch
        mirrored = 2.0 * self.geometry.approach - places + 0.5 * self.pitch
        far = REACH * self.sigma - self.half
        return [
            self.flank(self.half - way * error, at) if -way * error < far else np.zeros(2)
            for way, at in ((1.0, places), (-1.0, mirrored))
        ]


class SlowTrain:
    """The equations of motion of a scene's train.

    The state is well scaled: transmission errors of the tree's meshes and their rates, angle and speed of the load's
    shaft. Static errors are left out.
    """

    def __init__(self, scene):
        self.scene, self.train = scene, scene.train
        train = self.train
        self.meshes = [SlowMesh(scene, mesh) for mesh in train.meshes]
        self.arms = np.zeros((len(train.meshes), len(train.shafts)))
        for row, mesh in zip(self.arms, train.meshes, strict=True):
            row[mesh.a], row[mesh.b] = mesh.geometry.base_radius_pinion, -mesh.geometry.base_radius_gear
        self.offset = np.array([mesh.offset for mesh in train.meshes])
        self.tree = [k for k, mesh in enumerate(train.meshes) if not mesh.closes]
        # the shafts' angles from what the state holds: errors of the tree, and the load's shaft
        last = np.zeros((1, len(train.shafts)))
        last[0, train.load] = 1.0
        self.back = np.linalg.inv(np.vstack([self.arms[self.tree], last]))
        self.inertia = np.array([shaft.inertia for shaft in train.shafts])
        self.begin = np.zeros(
            len(train.shafts)
        )  # angles at the start, from which the places of the pairs count
        self.lines = [self.directions(mesh) for mesh in train.meshes]

    def directions(self, mesh):
        """Unit vectors of what drive and coast flank push the driven gear with."""
        alpha, sense = mesh.geometry.pressure_angle, self.train.shafts[mesh.a].sense
        turn = np.array(
            [[math.cos(mesh.angle), -math.sin(mesh.angle)], [math.sin(mesh.angle), math.cos(mesh.angle)]]
        )
        return [turn @ [math.sin(alpha), side * sense * math.cos(alpha)] for side in (1.0, -1.0)]

    def split(self, state):
        """Errors of all meshes, their rates, angles and speeds of all shafts."""
        n = len(self.tree)
        angles = self.back @ np.append(state[:n] + self.offset[self.tree], state[2 * n])
        speeds = self.back @ np.append(state[n : 2 * n], state[2 * n + 1])
        errors, rates = self.arms @ angles - self.offset, self.arms @ speeds
        errors[self.tree], rates[self.tree] = state[:n], state[n : 2 * n]
        return errors, rates, angles - self.begin, speeds

    def drive(self, t, angle, speed):
        """Torque [N m] of the drive, and its force on the shaft [N]."""
        drive = self.scene.drive
        if drive.law is None:
            return drive.torque, np.zeros(2)
        law = torque_law(drive.law.name)
        function = getattr(law.function, "py_func", law.function)
        torque, fx, fy = function(t, angle, speed, np.array(drive.law.numbers()))
        cosine, sine = math.cos(drive.orientation), math.sin(drive.orientation)
        return drive.torque + torque, np.array([cosine * fx - sine * fy, sine * fx + cosine * fy])

    def look(self, t, state):
        """Forces of the meshes, loads of the hubs, torques on the shafts."""
        errors, rates, angles, speeds = self.split(state)
        train, loads = self.train, np.zeros((len(self.train.shafts), 2))
        torque, loads[train.drive] = self.drive(t, angles[train.drive], speeds[train.drive])
        pin = math.hypot(*loads[train.drive])
        mesh_forces, torques = np.zeros(len(self.meshes)), np.zeros(len(train.shafts))
        torques[train.drive] = torque
        for k, (mesh, slow) in enumerate(zip(train.meshes, self.meshes, strict=True)):
            drive, coast = slow.forces(errors[k], mesh.geometry.base_radius_gear * angles[mesh.b])
            push = drive[0] * self.lines[k][0] + coast[0] * self.lines[k][1]
            loads[mesh.b] += push
            loads[mesh.a] -= push
            mesh_forces[k] = drive[0] - coast[0] + mesh.mesh.damping * rates[k]
            torques[mesh.b] += mesh.geometry.base_radius_gear * (drive[1] - coast[1])
        hubs = np.hypot(*loads.T)
        torques -= self.arms.T @ mesh_forces
        load = self.scene.load
        torques[train.load] -= load.torque * np.sign(speeds[train.load])
        torques[train.load] -= load.drag * speeds[train.load] * abs(speeds[train.load])
        for i, shaft in enumerate(self.scene.shafts.values()):
            held = shaft.hub_friction * shaft.hub_radius * hubs[i]
            if i == train.drive:
                friction = self.scene.drive.pin_friction
                friction = shaft.hub_friction if friction is None else friction
                held += friction * self.scene.drive.pin_radius * pin
            torques[i] -= held * np.sign(speeds[i])
        return {
            "force": mesh_forces,
            "hub": hubs,
            "torques": torques,
            "drive": torque,
            "u": errors,
            "speed": speeds,
        }

    def rates(self, t, state):
        n = len(self.tree)
        accelerations = self.look(t, state)["torques"] / self.inertia
        return np.concatenate(
            [
                state[n : 2 * n],
                self.arms[self.tree] @ accelerations,
                [state[2 * n + 1], accelerations[self.train.load]],
            ]
        )

    def run(self, times, rtol=1e-9):
        """What `look` gives at the given times [s]."""
        n, initial = len(self.tree), self.scene.initial
        start = np.zeros(2 * n + 2)
        for i, k in enumerate(self.tree):
            mesh = self.train.meshes[k]
            start[i] = 0.5 * mesh.mesh.backlash - initial.gap - mesh.offset
        start[2 * n + 1] = initial.gear_speed
        self.begin = self.back @ np.append(start[:n] + self.offset[self.tree], 0.0)
        sigma = self.meshes[0].sigma
        scale = np.concatenate([np.full(n, sigma), np.full(n, 1e6 * sigma), [1e-4, 100.0]])
        solved = solve_ivp(
            self.rates,
            (0.0, times[-1]),
            start,
            "DOP853",
            t_eval=times,
            rtol=rtol,
            atol=rtol * scale,
            first_step=1e-9,
        )
        return [self.look(t, state) for t, state in zip(solved.t, solved.y.T, strict=True)]
