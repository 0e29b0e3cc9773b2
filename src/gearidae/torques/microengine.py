"""The drive of a microengine: two comb drives at right angles that hold a pin of the pinion through linkages.

Garcia and Sniegowski, "Surface micromachined microengine", Sensors and Actuators A 48 (1995) 203-214, describe the
device; the equations are those of two forces on a pin, with linkages that are long against its radius.
"""

from __future__ import annotations

import math

from gearidae.torques.registry import Parameter, Parameters, register_torque

_FIRST_KNOT = 5
"""Where the knots of the frequency begin: the last parameter."""


@register_torque(
    "microengine",
    parameters=(
        Parameter("radius", "m", description="of the pin's circle on the pinion"),
        Parameter("force", "N", description="amplitude F0 of either comb drive"),
        Parameter("stiffness_x", "N/m", 0.0, description="of the springs of one comb drive, kx"),
        Parameter("stiffness_y", "N/m", 0.0, description="and of the other, ky"),
        Parameter("phase", "rad", 0.0, description="of the forces at time 0"),
        Parameter("frequency", "Hz", over_time=True, description="of the forces, a number or a schedule"),
    ),
    force=True,
    knots=lambda p, t_end: p[_FIRST_KNOT::2],
)
def microengine(t: float, angle: float, speed: float, p: Parameters) -> tuple[float, float, float]:
    """Torque [N m] of two comb drives on the pin, ``M = r (Fy cos(angle) - Fx sin(angle))``, and the force on it [N].

    ``Fx = -F0 sin(psi) - kx r cos(angle)`` and ``Fy = F0 cos(psi) - ky r sin(angle)`` with
    ``psi = phase + 2 pi integral of frequency``. With ``kx = ky`` the springs do no work over the circle and
    ``M = r F0 cos(psi - angle)``: a synchronous motor, which pulls out at a load of ``r F0``. The pin is at the angle
    ``angle`` from the x axis of the force.

    Parameters
    ----------
    t : float
        Time [s].
    angle : float
        Of the pinion since the start [rad].
    speed : float
        Angular speed of the pinion [rad/s]; of no influence.
    p : ndarray, shape (5 + 2 n,)
        Radius r of the pin [m], force F0 [N], stiffnesses kx and ky [N/m], phase [rad], and the n knots
        (time [s], frequency [Hz]) of the frequency.
    """
    turns = 0.0
    time, frequency = 0.0, p[_FIRST_KNOT + 1]
    for k in range(_FIRST_KNOT, p.size, 2):
        later, changed = p[k], p[k + 1]
        if later > t:
            slope = (changed - frequency) / (later - time)
            turns += (t - time) * (frequency + 0.5 * slope * (t - time))
            time = t
            break
        turns += 0.5 * (later - time) * (frequency + changed)
        time, frequency = later, changed
    turns += (t - time) * frequency
    psi = p[4] + 2.0 * math.pi * turns
    c, s = math.cos(angle), math.sin(angle)
    x = -p[1] * math.sin(psi) - p[2] * p[0] * c
    y = p[1] * math.cos(psi) - p[3] * p[0] * s
    return p[0] * (y * c - x * s), x, y
