"""A gear pair in plain SI numbers: the readable force law, DOP853, a stop at every turning point.

The slow twin of the engine: no tables, no scaling, no compiled code, another integrator. The pairs' joined heights
are followed as the model states them; the integration stops where the transmission error turns round, the only place
at which a joined height has to be remembered as long as no pair slides along its tip relief (the runs it is used for
keep every pair on the path of contact, or out of reach).
"""

import math

import numpy as np
from scipy.integrate import solve_ivp

from gearidae.asperities import law_of_tip
from gearidae.asperities.tip import asperity_of
from gearidae.contact.line import line_force
from gearidae.mesh import curvature_radii, separation
from gearidae.scene.coating import interface_shares
from gearidae.scene.coating_table import fraction_at


class SlowGears:
    """The equations of motion of a scene, drive flank only, pair 0 and the one ahead of it."""

    def __init__(self, scene):
        self.scene, self.geometry = scene, scene.geometry
        self.law = scene.contact.asperity
        self.materials = [
            (surface, part, self.stretch_limit(surface), offset, name)
            for surface, part, offset, name in scene.materials()
            if part > 0
        ]
        self.pairs = (0, -1)
        self.joined = None
        start = scene.initial
        pitch, r2 = self.geometry.base_pitch, self.geometry.base_radius_gear
        phase = start.mesh_phase
        relief, _ = separation(self.geometry, phase * pitch, scene.mesh.tip_relief_radius)
        u = 0.5 * scene.mesh.backlash + float(relief) - start.gap
        self.start = np.array([u, 0.0, phase * pitch / r2, start.gear_speed])

    def stretch_limit(self, surface):
        """By how much an asperity stretches beyond its joining before it detaches [m]."""
        law = law_of_tip(self.law, asperity_of(surface), 1.0)
        return law.detach - law.join

    def gap(self, pair, u, angle):
        pitch, r2 = self.geometry.base_pitch, self.geometry.base_radius_gear
        xi = r2 * angle - pair * pitch
        s, slope = separation(self.geometry, xi, self.scene.mesh.tip_relief_radius)
        return 0.5 * self.scene.mesh.backlash - u + float(s), float(slope), xi

    def follow(self, u, angle):
        """Take the joined heights along to this gap."""
        fresh = self.joined is None
        self.joined = {} if fresh else self.joined
        for pair in self.pairs:
            gap, _, _ = self.gap(pair, u, angle)
            for m, (_, _, limit, _, _) in enumerate(self.materials):
                before = gap if fresh else self.joined[pair, m]
                self.joined[pair, m] = min(max(before, gap - limit), gap)

    def share(self, material, pair, xi):
        """Share of a material of a drive pair, by the readable table."""
        coating, name = self.scene.coating, self.materials[material][4]
        place = min(max(xi / self.geometry.path_length, 0.0), 1.0)
        sides = [fraction_at(table, pair, place) for table in coating.tables]
        return float(interface_shares(coating.pairing, *sides)[name])

    def forces(self, u, angle):
        """F and Fs [N]."""
        force = relief = 0.0
        for pair in self.pairs:
            gap, slope, xi = self.gap(pair, u, angle)
            if gap > 12 * self.scene.surface.roughness:
                continue
            radius = float(curvature_radii(self.geometry, xi)[2])
            for m, (surface, part, limit, offset, _) in enumerate(self.materials):
                joined = min(max(self.joined[pair, m], gap - limit), gap)
                width = self.scene.gears.face_width
                if self.scene.coating.by_place:
                    part = self.share(m, pair, xi)
                load = part * float(line_force(gap + offset, gap - joined, radius, width, surface, self.law))
                force += load
                relief += load * slope
        return force, relief

    def rates(self, t, y):
        u, u_rate, angle, speed = y
        scene, geometry = self.scene, self.geometry
        r1, r2 = geometry.base_radius_pinion, geometry.base_radius_gear
        force, relief = self.forces(u, angle)
        drive = scene.drive.torque + sum(
            h.amplitude * math.cos(2 * math.pi * h.frequency * t + h.phase) for h in scene.drive.harmonic
        )
        resistance = scene.load.torque * np.sign(speed) + scene.load.drag * speed * abs(speed)
        pinion = (drive - r1 * force) / scene.gears.pinion_inertia
        gear = (-resistance + r2 * (force + relief)) / scene.gears.gear_inertia
        return np.array([u_rate, r1 * pinion - r2 * gear, speed, gear])

    def run(self, times, rtol=1e-10):
        """State (u, u', angle, speed) at the given times, shape (4, n)."""
        sigma = self.scene.surface.roughness
        y, t = self.start.copy(), 0.0
        speed = abs(y[3]) * self.geometry.base_radius_gear
        atol = rtol * np.array(
            [sigma, 1e-2 * speed, sigma / self.geometry.base_radius_gear, 1e-2 * abs(y[3])]
        )
        self.follow(y[0], y[2])
        out = np.full((4, len(times)), np.nan)

        def turning(t, y):
            return y[1]

        turning.terminal = True
        while True:
            leg = solve_ivp(
                self.rates,
                (t, times[-1]),
                y,
                method="DOP853",
                rtol=rtol,
                atol=atol,
                events=turning,
                dense_output=True,
            )
            here = (times >= t) & (times <= leg.t[-1])
            if here.any():
                out[:, here] = leg.sol(times[here])
            t, y = leg.t[-1], leg.y[:, -1]
            if leg.status != 1:
                return out
            self.follow(y[0], y[2])
            y = y + 0.0
            y[1] = 0.0
            # away from the turning point, so that the same root is not met again
            nudge = 1e-9 * times[-1]
            y = y + nudge * self.rates(t, y)
            t += nudge
