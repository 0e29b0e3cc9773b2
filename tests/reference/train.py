"""A train of two gears as one body under set-valued dry load, from rest: it slips where its drive exceeds the load.

Uses nothing of the engine: roots of the margin by scanning and Brent's rule, slips by an explicit integration.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

SCANS = 400
"""Of a period."""


def torque(shaft, t):
    """Torque of a shaft [N m] at a time [s]: a constant and harmonics."""
    waves = (h.amplitude * math.cos(2.0 * math.pi * h.frequency * t + h.phase) for h in shaft.harmonic)
    return shaft.torque + sum(waves)


def slips(scene, frequency):
    """Times at which a train at rest slips, and the angle [rad] by which its gear has turned in the end.

    ``(I2 + I1 i^2) w' = i M1 - M_load - drag w |w|`` with the ratio i of the teeth.
    """
    gears, end = scene.gears, scene.run.duration
    ratio = gears.gear_teeth / gears.pinion_teeth
    inertia = gears.gear_inertia + gears.pinion_inertia * ratio**2

    def margin(t):
        return torque(scene.load, t) - ratio * torque(scene.drive, t)

    def rates(t, state):
        resistance = max(torque(scene.load, t), 0.0) + scene.load.drag * state[1] * abs(state[1])
        return [state[1], (ratio * torque(scene.drive, t) - resistance) / inertia]

    step, now, angle, times = 1.0 / (SCANS * frequency), 0.0, 0.0, []
    while True:
        grid = np.arange(now, end, step)
        fallen = np.flatnonzero([margin(t) < 0.0 for t in grid])
        if not fallen.size:
            return times, angle
        last = grid[fallen[0]]
        start = brentq(margin, last - step, last, xtol=1e-15, rtol=1e-14) if fallen[0] > 0 else last
        times.append(start)

        def speed(t, state, start=start):
            return state[1] if t > start + 0.1 * step else 1.0

        speed.terminal, speed.direction = True, -1
        run = solve_ivp(
            rates,
            (start, end),
            [0.0, 0.0],
            "DOP853",
            events=speed,
            rtol=1e-10,
            atol=1e-16,
            max_step=8.0 * step,
        )
        angle += run.y[0, -1]
        now = run.t[-1]
        if run.status == 0:
            return times, angle
