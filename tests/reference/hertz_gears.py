"""A gear pair without adhesion in its two angles, both flanks, all pairs: another form of the equations, DOP853.

Independent of the engine's states and scaling: Newton's law for each shaft in phi1 and phi2, the gaps from Teodorescu
et al. 2009, Eqs. 4-6, the flanks' force interpolated from the readable line force. Static error, runout and listed
errors of single teeth, a pinion whose centre is moved in its hub along and across the centres, mesh damping, torque and
load harmonics, a torque law of the drive; the gear must keep turning forward (dry resistance is not set-valued here).
"""

import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from gearidae.contact.line import line_force
from gearidae.mesh import curvature_radii, separation
from gearidae.torques import torque_law


class HertzGears:
    """Equations of motion of a scene whose asperities do not adhere."""

    def __init__(self, scene, film_reach=0.0):
        assert scene.contact.asperity == "hertz"
        self.scene, self.geometry, self.film_reach = scene, scene.geometry, film_reach
        sigma = scene.surface.roughness
        self.far, self.deepest = 12.0 * sigma, -30.0 * sigma  # trial steps only get deeper
        gaps = np.linspace(self.deepest, self.far, 6001)
        force = line_force(gaps, 0.0, 1.0, scene.gears.face_width, scene.surface, "hertz")
        self.log_force = CubicSpline(gaps, np.log(force))
        start, pitch, r2 = scene.initial, self.geometry.base_pitch, self.geometry.base_radius_gear
        r1 = self.geometry.base_radius_pinion
        angle = start.mesh_phase * pitch / r2
        relief = float(separation(self.geometry, start.mesh_phase * pitch, scene.mesh.tip_relief_radius)[0])
        ratio = self.geometry.contact_ratio
        there = np.arange(math.ceil(start.mesh_phase - ratio), math.floor(start.mesh_phase) + 1)
        u = 0.5 * scene.mesh.backlash + relief + self.errors(there, 0).min() - start.gap
        self.first = 0.0  # the angle from which the drive's law counts
        u -= self.nearer(0.0)[0]
        pinion = brentq(
            lambda a: r1 * a - r2 * angle - self.error(a, angle)[0] - u, -10.0, 10.0, xtol=1e-16, rtol=1e-15
        )
        self.first = pinion
        _, slope, gear_slope = self.error(pinion, angle)
        speed = (r2 + gear_slope) * start.gear_speed / (r1 - slope)
        self.start = np.array([pinion, angle, speed, start.gear_speed])

    def errors(self, pairs, coast):
        """By how much the teeth of pairs stand back on a flank [m]."""
        mesh = self.scene.mesh
        first, second = (
            np.array(listed or [0.0]) for listed in (mesh.pinion_pitch_error, mesh.gear_pitch_error)
        )
        sums = first[pairs % first.size] + second[(pairs + coast) % second.size]
        return -sums if coast else sums

    def error(self, angle, gear):
        """Static transmission error with runout [m] and its derivatives in both angles [m/rad]."""
        mesh, e, slope, gear_slope = self.scene.mesh, 0.0, 0.0, 0.0
        for h in mesh.static_error:
            e += h.amplitude * math.cos(h.order * angle + h.phase)
            slope -= h.order * h.amplitude * math.sin(h.order * angle + h.phase)
        if mesh.pinion_runout:
            e += mesh.pinion_runout.amplitude * math.cos(angle + mesh.pinion_runout.phase)
            slope -= mesh.pinion_runout.amplitude * math.sin(angle + mesh.pinion_runout.phase)
        if mesh.gear_runout:
            e += mesh.gear_runout.amplitude * math.cos(gear + mesh.gear_runout.phase)
            gear_slope -= mesh.gear_runout.amplitude * math.sin(gear + mesh.gear_runout.phase)
        return e, slope, gear_slope

    def law(self, t, angle, speed):
        """Torque [N m] of the drive's law, and its force [N] along and across the centres."""
        drive = self.scene.drive
        if drive.law is None:
            return 0.0, 0.0, 0.0
        numbers = np.array(drive.law.numbers())
        torque, x, y = torque_law(drive.law.name).function(t, angle - self.first, speed, numbers)
        c, s = math.cos(drive.orientation), math.sin(drive.orientation)
        return torque, c * x - s * y, s * x + c * y

    def nearer(self, t):
        """By how much a pinion that is pushed in its hub is nearer along the lines of action of both flanks [m]."""
        clearance, alpha = self.scene.gears.pinion_hub_clearance, self.geometry.pressure_angle
        if clearance == 0.0:
            return np.zeros(2)
        _, x, y = self.law(t, 0.0, 0.0)
        x, y = clearance * x / math.hypot(x, y), clearance * y / math.hypot(x, y)
        # along the centres are the teeth of the gear; a drive flank pushes it across them, a coast flank back
        return np.array(
            [x * math.sin(alpha) + y * math.cos(alpha), x * math.sin(alpha) - y * math.cos(alpha)]
        )

    def film(self, gaps):
        """Damping of the films [N s/m]."""
        mesh = self.scene.mesh
        if mesh.film_damping == 0.0:
            return 0.0
        damping = mesh.film_damping * (mesh.film_gap / (mesh.film_gap + np.maximum(gaps, 0.0))) ** 3
        return np.where(gaps < self.film_reach, damping, 0.0)

    def rates(self, t, y):
        scene, geometry = self.scene, self.geometry
        pinion, gear, w1, w2 = y
        r1, r2, pitch = geometry.base_radius_pinion, geometry.base_radius_gear, geometry.base_pitch
        e, slope, gear_slope = self.error(pinion, gear)
        arm, span = r2 + gear_slope, 1e-6 * scene.run.duration
        before = max(t - 0.5 * span, 0.0)
        nearer, closing = self.nearer(t), (self.nearer(before + span) - self.nearer(before)) / span
        lead, lead_rate = r1 * pinion - r2 * gear - e, (r1 - slope) * w1 - arm * w2
        along_line = scene.mesh.damping * (lead_rate + closing[0])
        on_gear = arm * along_line
        first = math.floor(r2 * gear / pitch)
        numbers = np.arange(first - 4, first + 5)
        drive = r2 * gear - numbers * pitch
        coast = 2.0 * geometry.approach - (r2 * gear - (numbers + 0.5) * pitch)
        for sign, back, xi in ((1.0, 0, drive), (-1.0, 1, coast)):
            opened, steepness = separation(geometry, xi, scene.mesh.tip_relief_radius)
            gaps = (
                0.5 * scene.mesh.backlash - sign * lead - nearer[back] + opened + self.errors(numbers, back)
            )
            near = gaps < self.far
            if near.any():
                radius = curvature_radii(geometry, xi[near])[2]
                load = sign * np.sqrt(radius) * np.exp(self.log_force(np.maximum(gaps[near], self.deepest)))
                load -= (
                    sign
                    * self.film(gaps[near])
                    * (sign * (r2 * w2 * steepness[near] - lead_rate) - closing[back])
                )
                along_line += load.sum()
                on_gear += (load * (arm + r2 * steepness[near])).sum()
        torques = []
        for shaft in (scene.drive, scene.load):
            swing = (h.amplitude * math.cos(2 * math.pi * h.frequency * t + h.phase) for h in shaft.harmonic)
            torques.append(shaft.torque + sum(swing))
        resistance = np.sign(w2) * max(torques[1], 0.0) + scene.load.drag * w2 * abs(w2)
        return np.array(
            [
                w1,
                w2,
                (torques[0] + self.law(t, pinion, w1)[0] - (r1 - slope) * along_line)
                / scene.gears.pinion_inertia,
                (on_gear - resistance) / scene.gears.gear_inertia,
            ]
        )

    def run(self, times, rtol=1e-11):
        """Transmission error and both speeds at the given times, shape (3, n)."""
        r1 = self.geometry.base_radius_pinion
        scale = self.scene.surface.roughness / r1
        # the angles are resolved to 1e-6 of what a roughness makes of them at the least
        speeds = rtol * (abs(self.start[2]) + scale / times[-1])
        atol = np.array([1e-3 * rtol * scale, 1e-3 * rtol * scale, speeds, speeds])
        run = solve_ivp(
            self.rates,
            (0.0, times[-1]),
            self.start,
            "DOP853",
            times,
            rtol=1e-13,
            atol=atol,
            first_step=1e-7 * times[-1],
            max_step=times[-1] / 200,
        )
        assert run.success
        pinion, gear, w1, w2 = run.y
        e = np.array([self.error(a, b)[0] for a, b in zip(pinion, gear, strict=True)])
        nearer = np.array([self.nearer(t)[0] for t in times])
        return np.array([r1 * pinion - self.geometry.base_radius_gear * gear - e + nearer, w1, w2])
