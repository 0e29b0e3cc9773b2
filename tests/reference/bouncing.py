"""A tooth that a steady torque drives against another again and again: by quadrature, no equation of motion is solved.

The gear is so heavy that it stands still. The gap g of the one pair in mesh then moves like a ball's height over the
ground, ``m g'' = F - m a``, and where its energy is known its speed is: every time between two events is an integral of
``dg / g'``. Each impact costs what its asperities' adhesion takes, so that the ball rises less and less high until one
impact holds it: after finitely many, whose times accumulate as those of a bouncing ball do.
"""

import math

import numpy as np
from numpy.polynomial import Chebyshev
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from gearidae.contact import asperity_of, line_force
from gearidae.mesh import curvature_radii


class BouncingTooth:
    """One pair of teeth under steady torque, the coating whole.

    Attributes
    ----------
    mass, pull : float
        Moving mass [kg] and steady acceleration towards the flank [m/s^2].
    far : float
        Gap beyond which there is no force [m].
    """

    def __init__(self, scene, engage, far):
        geometry, gears = scene.geometry, scene.gears
        assert scene.coating.sam_fraction == 1.0
        self.surface, self.width = scene.coated_surface, gears.face_width
        r1, r2 = geometry.base_radius_pinion, geometry.base_radius_gear
        self.mass = 1.0 / (r1**2 / gears.pinion_inertia + r2**2 / gears.gear_inertia)
        self.pull = r1 * scene.drive.torque / gears.pinion_inertia
        self.radius = float(curvature_radii(geometry, scene.initial.mesh_phase * geometry.base_pitch)[2])
        self.limit = asperity_of(self.surface).stretch_limit
        self.engage, self.far = engage, far
        sigma = scene.surface.roughness
        # forces fall by e^6 a roughness: a two-hundredth of it leaves a spline some 1e-9 of them
        gaps = np.linspace(-2.0 * sigma, far, round((far / sigma + 2.0) * 200) + 1)
        self.joining = CubicSpline(gaps, self.force(gaps, 0.0)).antiderivative()
        self.tearing = CubicSpline(gaps, self.force(gaps, self.limit)).antiderivative()
        self.x, self.w = np.polynomial.legendre.leggauss(32)

    def force(self, gap, stretch):
        return line_force(gap, stretch, self.radius, self.width, self.surface)

    def _over(self, rate, low, high, panels):
        """Integral of dg over the speed where the speed is not zero."""
        edges = np.linspace(low, high, panels + 1)
        half = 0.5 * np.diff(edges)[:, None]
        gaps = edges[:-1, None] + half * (self.x + 1.0)
        return float((half * self.w / rate(gaps)).sum())

    def approach(self, speed):
        """From `far` inwards at a speed: time to the onset, time to the turning point, and its gap."""

        def square(gap):
            work = self.joining(self.far) - self.joining(gap)
            return speed**2 + 2.0 * (self.pull * (self.far - gap) - work / self.mass)

        low = self.far
        while square(low) > 0.0:
            low -= 0.05 * self.far
        lowest = brentq(square, low, low + 0.05 * self.far, xtol=1e-24, rtol=1e-15)
        way = self.far - lowest

        def time_from(gap):
            """From the turning point up to a gap; g = lowest + way r^2 takes the square root away."""
            end = math.sqrt((gap - lowest) / way)
            r = 0.5 * end * (np.concatenate([self.x, self.x + 2.0, self.x + 4.0, self.x + 6.0]) + 1.0) / 4.0
            weights = 0.5 * end * np.tile(self.w, 4) / 4.0
            return float((weights * 2.0 * way * r / np.sqrt(square(lowest + way * r**2))).sum())

        whole = time_from(self.far)
        return whole - time_from(self.engage), whole, lowest

    def retreat(self, lowest):
        """From a turning point outwards: times to full stretch, separation and `far`, and the speed there; or None."""
        # partly stretched by S = limit sin^2: force and time are both smooth in that angle
        angle = 0.25 * math.pi * (self.x + 1.0)
        work = Chebyshev.interpolate(
            lambda q: (
                self.force(lowest + self.limit * np.sin(q) ** 2, self.limit * np.sin(q) ** 2) * np.sin(2 * q)
            ),
            40,
            domain=[0.0, 0.5 * math.pi],
        ).integ(lbnd=0.0)

        def squares(q):
            return 2.0 * self.limit * (work(q) / self.mass - self.pull * np.sin(q) ** 2)

        if np.any(squares(angle) <= 0.0):
            return None
        stretched = float(
            (0.25 * math.pi * self.w * self.limit * np.sin(2 * angle) / np.sqrt(squares(angle))).sum()
        )
        torn, kept = lowest + self.limit, float(squares(0.5 * math.pi))

        def square(gap):
            done = self.tearing(gap) - self.tearing(torn)
            return kept + 2.0 * (done / self.mass - self.pull * (gap - torn))

        if np.any(square(np.linspace(torn, self.far, 500)) <= 0.0):
            return None
        times = [
            stretched + self._over(lambda g: np.sqrt(square(g)), torn, end, 24)
            for end in (self.engage, self.far)
        ]
        return stretched, *times, math.sqrt(square(self.far))

    def bounces(self, gap):
        """Times of onsets, turning points, full stretches and separations after a fall from rest at a gap."""
        time = math.sqrt(2.0 * (gap - self.far) / self.pull)
        speed = self.pull * time
        events = {"onset": [], "turning": [], "full": [], "separation": []}
        while True:
            onset, turned, lowest = self.approach(speed)
            events["onset"].append(time + onset)
            time += turned
            events["turning"].append(time)
            left = self.retreat(lowest)
            if left is None:
                return {name: np.array(times) for name, times in events.items()}
            full, separated, away, speed = left
            events["full"].append(time + full)
            events["separation"].append(time + separated)
            time += away + 2.0 * speed / self.pull
