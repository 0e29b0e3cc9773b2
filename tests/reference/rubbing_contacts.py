"""Contacts of the gears that rub (`reference.rubbing`): forces and friction limits of one pair of teeth, in SI units.

The mean law is for asperities without memory (`hertz`, `dmt`); real asperities are JKR's, and listed.
"""

import math

import numpy as np
from scipy.interpolate import make_interp_spline

from gearidae.asperities.tip import asperity_of
from gearidae.contact.line import line_force


def jkr(overlap):
    """A^3 of JKR's stable branch at overlaps in stretch limits, ``12^(1/3) s^4 - (4/3) 18^(1/6) s`` of s = sqrt(A)."""
    d = np.asarray(overlap, float)
    s = (np.maximum(d, 0.0) / 12 ** (1 / 3)) ** 0.25 + 1.0
    for _ in range(60):  # from the right of a convex function's root: monotone
        slope = 4.0 * 12 ** (1 / 3) * s**3 - 4.0 / 3.0 * 18 ** (1 / 6)
        step = (12 ** (1 / 3) * s**4 - 4.0 / 3.0 * 18 ** (1 / 6) * s - d) / np.where(slope > 0, slope, 1.0)
        s = s - np.where(slope > 0, step, 0.0)
        if np.all(np.abs(step) < 1e-14 * s):
            break
    return s**6


class MeanLaw:
    """The mean force of rough flanks without memory, tabulated once; friction by the law ``net``."""

    def __init__(self, scene):
        self.scene = scene
        self.parts = [
            (material.surface, material.share) for material in scene.materials() if material.share > 0.0
        ]
        contact, coated = scene.contact, scene.coating.friction
        coated = contact.friction if coated is None else coated
        self.coefficients = [
            contact.friction if material.name == "bare" else coated
            for material in scene.materials()
            if material.share > 0.0
        ]
        self.sigma = scene.surface.roughness
        places = np.arange(-2.0, 14.0, 0.02)
        self.tables = [
            make_interp_spline(
                places,
                share
                * line_force(places * self.sigma, 0.0, 1.0, scene.gears.face_width, surface, contact.asperity)
                * np.exp(0.5 * places**2),
                k=7,
            )
            for surface, share in self.parts
        ]

    def touching(self, key, gap, a1, a2, inside, base):
        """Force and friction limit of a pair, the latter below zero where adhesion exceeds the load; none along."""
        radius = a1 * a2 / (a1 + a2)
        at = gap / self.sigma
        if at > 13.9:
            return 0.0, 0.0, 0.0
        scale = math.sqrt(radius) * math.exp(-0.5 * at * at)
        loads = [scale * float(table(at)) for table in self.tables]
        rubbed = sum(mu * load for mu, load in zip(self.coefficients, loads, strict=True))
        return sum(loads), rubbed, 0.0

    def begin(self, gears):
        """Nothing joins."""

    def roots(self, gears):
        """No asperity has a guard of its own."""
        return []

    def pass_events(self, gears):
        """Nothing changes sides."""


class ListedAsperities:
    """JKR asperities, the same list on each flank of each pinion tooth, one material; ``net`` or ``shear``.

    Parameters
    ----------
    scene : Scene
    arcs, heights, radii : array_like, shape(n)
        [m].
    coefficient : float
        Of the law ``net``.
    strength : float
        Shear strength [Pa]: of the law ``shear`` if it is not zero.
    """

    def __init__(self, scene, asperities, coefficient, strength=0.0, surface=None):
        self.arcs, self.heights, self.radii = (np.asarray(column, float) for column in asperities)
        tip = asperity_of(surface or scene.surface)
        dgamma, self.modulus = tip.work_of_adhesion, tip.modulus
        self.pc = 1.5 * math.pi * self.radii * dgamma
        self.dc = (9.0 * self.radii * self.pc / (4.0 * self.modulus)) ** (2 / 3) / (3.0 * self.radii)
        self.coefficient, self.strength = coefficient, strength
        self.joined = {}  # pair -> set of asperities

    def overlaps(self, gap, a1, a2, base):
        radius = a1 * a2 / (a1 + a2)
        x = self.arcs - a1**2 / (2.0 * base)
        return self.heights - gap - x**2 / (2.0 * radius), x, radius

    def touching(self, key, gap, a1, a2, inside, base):
        held = sorted(self.joined.get(key, ()))
        if not held:
            return 0.0, 0.0, 0.0
        delta, x, radius = (np.asarray(column) for column in self.overlaps(gap, a1, a2, base))
        cube = jkr(np.maximum(delta[held] / self.dc[held], -1.0))
        loads = 2.0 * self.pc[held] * (cube - np.sqrt(2.0 * cube))
        along = 0.0
        if inside:
            by = x[held] * a1 / base / radius + x[held] ** 2 * (a2 - a1) / (a1 + a2) / (2.0 * radius**2)
            along = -float(loads @ by)
        if self.strength > 0.0:
            area = (3.0 * self.radii[held] * self.pc[held] / (2.0 * self.modulus)) ** (2 / 3) * cube ** (
                2 / 3
            )
            limit = self.strength * math.pi * float(area.sum())
        else:
            limit = self.coefficient * float(loads.sum())
        return float(loads.sum()), limit, along

    def guards(self, gears, y):
        """Distances to joining (free) and letting go (joined) of every asperity of every pair, over 1 nm."""
        functions = {}
        for side, i, xi in gears.places(y[2]):
            inside = min(max(xi, 0.0), gears.g.path_length)
            gap = 0.5 * gears.scene.mesh.backlash - side * y[0]
            gap += (xi - inside) ** 2 / (2.0 * gears.scene.mesh.tip_relief_radius)
            a1 = gears.first + inside
            delta, _, _ = self.overlaps(gap, a1, gears.total - a1, gears.r1)
            held = np.zeros(len(self.arcs), bool)
            held[sorted(self.joined.get((side, i), ()))] = True
            functions[side, i] = np.where(held, delta + self.dc * (1.0 - 1e-12), -delta) / 1e-9
        return functions

    def begin(self, gears):
        self.joined = {k: set(np.flatnonzero(v < 0.0)) for k, v in self.guards(gears, gears.y).items()}

    def roots(self, gears):
        near = {k: np.flatnonzero(v < 300.0) for k, v in self.guards(gears, gears.y).items()}
        keys = [k for k, some in near.items() if some.size]

        def nearest(t, y):
            guards = self.guards(gears, y)
            return min((float(guards[k].min()) for k in keys if k in guards), default=1.0)

        return [nearest]

    def pass_events(self, gears):
        """Asperities whose guard has been reached change sides."""
        for key, guards in self.guards(gears, gears.y).items():
            for a in np.flatnonzero(guards <= 1e-9):
                self.joined.setdefault(key, set()).symmetric_difference_update({a})
