"""A chain of meshes whose flanks rub, in slow motion: static equilibria pair by pair, with nothing of the engine.

The drive's torque is constant, and each mesh hands on what its friction leaves. Pairs are in contact as far beyond the
ends of the path as tip relief lets them.
"""

from fractions import Fraction
from itertools import pairwise
from math import lcm

import numpy as np
from scipy.optimize import brentq
from tests.reference.slow_train import DEEPEST, REACH, SlowMesh

from gearidae.mesh import curvature_radii, separation


class RubbingMesh(SlowMesh):
    """A mesh in static equilibrium."""

    def touching(self, error, turned):
        """Forces [N] of the pairs, along the path by tip relief too, arms [m], and the directions of sliding."""
        begin, geometry = self.mesh.phase * self.pitch + turned, self.geometry
        places = begin - (np.floor(begin / self.pitch) + np.arange(-3.0, 3.0)) * self.pitch
        away, slope = separation(geometry, places, self.mesh.mesh.tip_relief_radius)
        near = self.half - error + away < REACH * self.sigma
        first, second, radii = curvature_radii(geometry, places[near])
        deep = np.maximum(self.half - error + away[near], DEEPEST * self.sigma)
        force = self.law(deep) * np.sqrt(radii / self.radius)
        ahead = np.sign(np.clip(places[near], 0.0, geometry.path_length) - geometry.approach)
        return force, force * slope[near], first, second, ahead

    def passes_on(self, torque, turned, coefficient):
        """Torque [N m] on the driven shaft, and what friction takes of the power, over the driver's speed [N m]."""
        r1, r2 = self.geometry.base_radius_pinion, self.geometry.base_radius_gear

        def missing(error):
            force, _, first, _, ahead = self.touching(error, turned)
            return r1 * force.sum() + coefficient * (ahead * force) @ first - torque

        range_of_errors = self.half - REACH * self.sigma, self.half + 1.9 * self.sigma
        force, along, first, second, ahead = self.touching(
            brentq(missing, *range_of_errors, xtol=1e-18), turned
        )
        out = r2 * (force + along).sum() + coefficient * (ahead * force) @ second
        return out, coefficient * force @ np.abs(first - second * r1 / r2)


def friction_shares(scene, torque, coefficient, points):
    """Share of the work put into each mesh of a chain that friction of its flanks takes, over a whole period.

    Parameters
    ----------
    scene : TrainScene
        A chain: each mesh is driven by the shaft that the mesh before drives.
    torque : float
        Of the drive [N m].
    coefficient : float
    points : int
        Places at which forces are evaluated.
    """
    meshes = [RubbingMesh(scene, mesh) for mesh in scene.train.meshes]
    pitches = [Fraction(1)]
    for before, mesh in pairwise(meshes):
        pitches.append(pitches[-1] * Fraction(mesh.geometry.pinion_teeth, before.geometry.gear_teeth))
    period = lcm(*(share.denominator for share in pitches))
    put_in, lost = np.zeros((2, len(meshes)))
    for place in (np.arange(points) + 0.5) * period / points:
        arrives = torque
        for k, (mesh, share) in enumerate(zip(meshes, pitches, strict=True)):
            put_in[k] += arrives
            arrives, taken = mesh.passes_on(arrives, float(share) * place * mesh.pitch, coefficient)
            lost[k] += taken
    return lost / put_in
