r"""Free motion of a train: its shafts under their torques, joined without backlash, adhesion and friction of hubs.

With the speeds :math:`\rho_i` of the shafts over that of the judged one,

.. math::

    \sum I_i \rho_i^2\, \dot w = \rho_d M_d - \rho_l M_l - \sum \rho_i (h_i + c_i \rho_i w + d_i \rho_i^2 w^2),

where dry resistances, that of the load and those of the shafts, hold up to their sum.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

from gearidae.arrays import Floats
from gearidae.scene.judged import judged_shaft
from gearidae.torques import torque_law

if TYPE_CHECKING:
    from gearidae.scene import Drive, Knots, Load, TrainScene

Torque = Callable[[float, float, float], float]
"""Torque [N m] of time [s], angle [rad] and speed [rad/s] of a shaft."""
_RTOL: Final = 1e-9
_LOOKS: Final = 2000
"""Times at which the torques on a train at rest are compared with its dry resistance."""


def knots_at(knots: Knots) -> Callable[[float], float]:
    """Return the function of time that a schedule is; 0 without knots."""
    if not knots:
        return lambda _: 0.0
    period = knots.repeat
    times, values = np.array(knots.cycle()).T
    cubic = knots.interpolation == "cubic" and len(times) > 1
    spline = PchipInterpolator(times, values) if cubic else None

    def at(t: float) -> float:
        inside = times[0] + (t - times[0]) % period if period > 0.0 else min(max(t, times[0]), times[-1])
        return float(np.interp(inside, times, values) if spline is None else spline(inside))

    return at


def torque_of(table: Drive | Load) -> Torque:
    """Return the torque of a drive, or the dry resistance of a load before it is cut off at 0."""
    schedule = knots_at(table.schedule)
    law = None if table.law is None else torque_law(table.law.name)
    parameters = None if table.law is None else np.array(table.law.numbers())
    function: Any = None if law is None else getattr(law.function, "py_func", law.function)

    def torque(t: float, angle: float, speed: float) -> float:
        total = table.torque + schedule(t)
        for harmonic in table.harmonic:
            if harmonic.order is None:
                turned = 2.0 * math.pi * (harmonic.frequency or 0.0) * t
            else:
                turned = harmonic.order * angle
            total += harmonic.amplitude * math.cos(turned + harmonic.phase)
        if law is not None:
            arguments = (t, angle, speed) if law.takes_angle else (t, speed)
            said = function(*arguments, parameters)
            total += said[0] if law.has_force else said
        return float(total)

    return torque


class FreeTrain:
    """A train under its torques and resistances alone."""

    def __init__(self, scene: TrainScene) -> None:
        train, shafts = scene.train, list(scene.shafts.values())
        judged = train.shafts[judged_shaft(scene)].ratio
        ratio = np.array([float(shaft.ratio / judged) for shaft in train.shafts])
        self.inertia = float(np.array([shaft.inertia for shaft in train.shafts]) @ ratio**2)
        self._drive, self._load = torque_of(scene.drive), torque_of(scene.load)
        self._driven, self._loaded = float(ratio[train.drive]), float(ratio[train.load])
        self._gain, self._held = scene.drive.speed_gain, knots_at(scene.drive.speed_knots())
        own = {
            name: np.array([getattr(shaft, name) for shaft in shafts])
            for name in ("resistance", "viscous", "drag")
        }
        own["viscous"][train.load] += scene.load.viscous
        own["drag"][train.load] += scene.load.drag
        self._dry = float(own["resistance"] @ ratio)
        self._viscous, self._drag = float(own["viscous"] @ ratio**2), float(own["drag"] @ ratio**3)

    def driving(self, t: float, angle: float, speed: float) -> float:
        """Torque of the drive at the judged shaft [N m]."""
        turned, turning = self._driven * angle, self._driven * speed
        return self._driven * (
            self._drive(t, turned, turning) + self._gain * (self._held(t) - turning if self._gain else 0.0)
        )

    def dry(self, t: float, angle: float, speed: float) -> float:
        """Dry resistance of the whole train at the judged shaft [N m]."""
        load = self._load(t, self._loaded * angle, self._loaded * speed)
        return self._loaded * max(load, 0.0) + self._dry

    def positions(self, begin: float, angle: float, times: Floats) -> Floats:
        """Angles of the judged shaft [rad] of a train that is at rest at a time and an angle."""
        return self.follow(begin, angle, 0.0, times)[0]

    def follow(self, begin: float, angle: float, speed: float, times: Floats) -> tuple[Floats, float]:
        """Angles of the judged shaft [rad] from a time, an angle and a speed on, and its speed at the last [rad/s]."""
        where = np.full(len(times), angle)
        now, at = begin, angle
        end = float(times[-1]) if len(times) else begin
        while now < end:
            way = self._let_go(now, at) if speed == 0.0 else math.copysign(1.0, speed)
            if way == 0.0:
                now = self._waits(now, end, at)
                where[times >= now] = at
                continue

            def rates(t: float, state: Floats, way: float = way) -> list[float]:
                turned, turning = state
                taken = way * self.dry(t, turned, turning) + self._viscous * turning
                taken += self._drag * turning * abs(turning)
                return [turning, (self.driving(t, turned, turning) - taken) / self.inertia]

            def stops(_: float, state: Floats, way: float = way) -> float:
                return way * float(state[1])

            stops.terminal, stops.direction = True, -1.0  # type: ignore[attr-defined]
            longest = (end - now) / 50.0
            later = times[times > now]
            solved = solve_ivp(
                rates, (now, end), [at, speed], "DOP853", later, rtol=_RTOL, atol=1e-12, max_step=longest,
                events=stops,
            )  # fmt: skip
            count = len(solved.t)
            first = len(times) - len(later)
            if count:  # it may have stopped before the first of these times
                where[first : first + count] = solved.y[0]
            if solved.status != 1:
                return where, float(solved.y[1][-1]) if count else speed
            now, at, speed = float(solved.t_events[0][0]), float(solved.y_events[0][0][0]), 0.0
            where[times >= now] = at
        return where, speed

    def onset(self, begin: float, angle: float, end: float) -> float:
        """Time at which a train begins to move that is at rest at a time and an angle, or the end."""
        return begin if self._let_go(begin, angle) != 0.0 else self._waits(begin, end, angle)

    def _let_go(self, t: float, angle: float) -> float:
        """Direction in which the torques move a train at rest; 0 if dry resistance holds it."""
        torque = self.driving(t, angle, 0.0)
        return math.copysign(1.0, torque) if abs(torque) > self.dry(t, angle, 0.0) else 0.0

    def _waits(self, begin: float, end: float, angle: float) -> float:
        """Time at which a train at rest begins to move, or the end."""
        sampled_times = np.linspace(begin, end, _LOOKS + 1)
        for before, t in pairwise(sampled_times):
            if self._let_go(float(t), angle) != 0.0:
                low, high = float(before), float(t)
                for _ in range(50):
                    middle = 0.5 * (low + high)
                    low, high = (low, middle) if self._let_go(middle, angle) else (middle, high)
                return high
        return end
