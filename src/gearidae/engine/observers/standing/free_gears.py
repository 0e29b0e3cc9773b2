"""Free gears: both shafts under their torques, joined without backlash, adhesion and friction.

    (m1 + m2) w' = F1 - F2 + what acts on either shaft,    with set-valued laws of both shafts at w = 0,

scaled and over the base radii. They are at rest at a zero of the real gear's speed and have its angles. The equation is
solved by LSODA (Petzold, SIAM J. Sci. Stat. Comput. 4, 1983), which a stiff drive does not slow down, over windows that
end at knots, and where the speed falls to zero under a set-valued law. Windows follow from the torques alone, not from
when they are asked for: what is known of free gears at a time is the same whatever the blocks of the run are.
"""

from __future__ import annotations

import math
import threading
import warnings
from bisect import bisect_right
from collections.abc import Callable
from typing import Final, NamedTuple, TypeAlias

import numpy as np

from gearidae.arrays import Floats
from gearidae.engine.model.state import Model
from gearidae.engine.observers.standing.torques import drive_at, drive_between, free_acceleration, rest_of
from gearidae.formulas.interpolation import cubic, turning_point
from gearidae.formulas.roots import zero_of_cubic
from gearidae.records.standing import GROWS

RTOL: Final = 3e-7
"""Of speed and travel in a step of LSODA: what adds up over a run is some 1e-6."""
ATOL: Final = 1e-8
"""Pitches, and for the speed the same over a window."""
STEPS: Final = 1024.0
"""Steps of `SCENE.free_step` that a window has at most,"""
MOST_STEPS: Final = 2_000
"""and of LSODA, about."""
LONGEST_STEP: Final = 4.0
"""Of these steps, that LSODA takes at most: it sees a law of a user at its own steps alone."""
_GRID: Final = np.unique(np.concatenate([np.geomspace(1e-4, 1.0, 64), np.linspace(0.0, 1.0, 33)]))
"""Shares of a window that are kept: close where a motion begins;"""
_COARSE: Final = np.linspace(0.0, 1.0, 9)
MANY_KNOTS: Final = 64
"""and fewer between so many knots."""
_STOP_SPAN: Final = 1.5
"""Of the time after which they have stopped, the next window: what lies behind the stop has been for nothing."""
_HALVINGS: Final = 60
"""Of a piece of motion: a time in it is then known to the last bit."""
SHORTEST: Final = 1e-8
"""Share of the time of all runs of a chain that a piece of motion has at least: a bound on the work."""
_ONE_AT_A_TIME: Final = threading.Lock()
"""Older versions of LSODA in scipy keep their state where another thread would find it."""

Rates: TypeAlias = Callable[[float, Floats], tuple[float, float]]
"""Of travel and speed at a time of a window."""


class Zero(NamedTuple):
    """A zero of the gear's speed, with the fields of the state's record."""

    time: float
    position: float
    pinion_lead: float
    exits: int
    lowest: float
    highest: float
    start: int
    driven: int
    rest_time: float
    mark: float
    grown: float
    free_time: float
    free_travel: float
    free_speed: float
    free_farthest: float
    free_before: float
    free_mark: float
    free_grown: float
    onset: float
    excess: float
    driven_time: float


class FreeWay(NamedTuple):
    """What free gears have done from a zero to a time.

    Attributes
    ----------
    travel, speed : float
        [pb], [pb/s].
    farthest : float
        Largest size of the travel [pb].
    mark, grown : float
        Size of the travel [pb] where it last grew by a share, and when [s].
    onset : float
        When they began to move [s]; 0 before.
    excess : float
        Largest torque of the drive at the gear that stands beyond the dry load [N m].
    driven_time : float
        For which there was any [s].
    """

    travel: float
    speed: float
    farthest: float
    mark: float
    grown: float
    onset: float
    excess: float
    driven_time: float


class FreeGears:
    """Free gears from rest at a zero, followed as far as they are asked for.

    Parameters
    ----------
    m : Model
    place : int
        Of the model, from `gearidae.engine.model.addresses.Addresses`.
    zero : Zero
    knots : sequence of float
        Where torques begin another piece, over tau, in order; the last is the end of the run.
    """

    def __init__(self, m: Model, address: int, zero: Zero, knots: list[float]) -> None:
        self._address, self._knots, self._zero = address, knots, zero
        self._unit, self._end = float(m.scene.time_unit), float(m.scene.end)
        self._torque = float(m.scene.force_unit * m.scene.gear_radius)
        self._may_stop, step = bool(m.scene.torque["resists"].any()), float(m.scene.free_step)
        self._span = self._longest = STEPS * step if step > 0.0 else math.inf
        self._largest_step = LONGEST_STEP * step
        self._grid = _COARSE if len(knots) > MANY_KNOTS else _GRID
        self._mass = float(1.0 / m.scene.pinion_inverse_mass + 1.0 / m.scene.gear_inverse_mass)
        self._rate = float(m.scene.phase_rate)
        torques = m.scene.torque
        self._bounded = not (m.work.torque_law.any() or torques["takes_angle"].any())
        self._times = [min(zero.free_time / self._unit, self._end)]
        self._travels, self._speeds = [zero.free_travel], [zero.free_speed * self._unit]
        self._farthest = [zero.free_farthest]
        self._marks = [(-math.inf, zero.free_mark, zero.free_grown)]
        self._onset = zero.onset
        self._drives = [(self._times[0], zero.excess, zero.driven_time)]

    def until(self, time: float) -> FreeWay:
        """Return what they have done until a time [s]; before torques that have ended, what is known of it."""
        z = self._zero
        if time < z.free_time * (1.0 - 1e-12):
            known = (z.free_mark, z.free_grown, z.onset, z.excess, z.driven_time)
            return FreeWay(z.free_travel, z.free_speed, z.free_before, *known)
        t = min(max(time / self._unit, self._times[0]), self._end)
        while self._times[-1] < t:
            self._follow()
        i = min(bisect_right(self._times, t), len(self._times) - 1) - 1
        travel, speed, farthest = self._travels[i], self._speeds[i], self._farthest[i]
        if t > self._times[i]:
            h = self._times[i + 1] - self._times[i]
            share = (t - self._times[i]) / h
            ends = self._travels[i], speed, self._travels[i + 1], self._speeds[i + 1]
            travel = cubic(share, h, *ends)
            farthest = max(farthest, abs(travel))
            speed += share * (self._speeds[i + 1] - speed)
        mark, grown = self._marks[bisect_right(self._marks, (t, math.inf, math.inf)) - 1][1:]
        if farthest > (1.0 + GROWS) * mark:
            mark, grown = farthest, t * self._unit
        onset = self._onset if 0.0 < self._onset <= t * self._unit else 0.0
        return FreeWay(travel, speed / self._unit, farthest, mark, grown, onset, *self.driven(time))

    def driven(self, time: float) -> tuple[float, float]:
        """By how much [N m] and how long [s] the drive has exceeded the dry load of a gear that stands."""
        t = min(time / self._unit, self._end)
        at = self._zero.position, self._zero.pinion_lead
        while (last := self._drives[-1])[0] < t:
            piece = self._piece(last[0])
            if piece[1] > t:
                break
            self._drives.append(self._add_drive(last, piece, piece[1], at))
        known = self._drives[max(bisect_right(self._drives, (t, math.inf, math.inf)) - 1, 0)]
        if t > known[0]:
            known = self._add_drive(known, self._piece(known[0]), t, at)
        return known[1], known[2]

    def _add_drive(
        self, last: tuple[float, float, float], piece: tuple[float, float], to: float, at: tuple[float, float]
    ) -> tuple[float, float, float]:
        largest, lasts = drive_between(self._address, piece, last[0], to, at)
        return to, max(last[1], largest * self._torque), last[2] + lasts * self._unit

    def drive_torque(self, time: float) -> float:
        """Torque of the drive on a pinion that stands with the gear, over its base radius, scaled."""
        t = min(time / self._unit, self._end)
        return float(
            drive_at(self._address, self._piece(t), t, (self._zero.position, self._zero.pinion_lead))
        )

    def bound(self, time: float) -> float:
        """Bound of how far they have been until a time [pb], at no more cost than of their torques at rest.

        What depends on the speed holds them back; of laws of a user, and of an angle, nothing is known.
        """
        excess, _ = self.driven(time)
        if excess <= 0.0:
            return self._zero.free_farthest
        if not self._bounded or self._zero.free_time > self._zero.time:
            return math.inf
        lasts = time / self._unit - self._times[0]
        return 0.5 * self._rate * excess / self._torque / self._mass * lasts * lasts

    def reaches(self, distance: float) -> float:
        """Time over tau at which they have been so far away [pb]; infinite if they have not by the end of the run."""
        while self._farthest[-1] < distance and self._times[-1] < self._end:
            self._follow()
        if self._farthest[-1] < distance:
            return math.inf
        i = next(k for k, farthest in enumerate(self._farthest) if farthest >= distance)
        if i == 0:
            return self._times[0]
        low, high = self._times[i - 1] * self._unit, self._times[i] * self._unit
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if self.until(middle).farthest >= distance else (middle, high)
        return high / self._unit

    def _piece(self, t: float) -> tuple[float, float]:
        """Knots between which a time lies, or which begins there."""
        i = min(bisect_right(self._knots, t), len(self._knots) - 1)
        return self._knots[i - 1] if i > 0 else 0.0, self._knots[i]

    def _follow(self) -> None:
        """Follow them over one more window."""
        t, x, v = self._times[-1], self._travels[-1], self._speeds[-1]
        piece = self._piece(t)
        sign = math.copysign(1.0, v)
        if v == 0.0:
            time, push = rest_of(self._address, piece, t, (self._zero.position + x, self._zero.pinion_lead))
            if push == 0.0 or time > t:
                self._add([time], [x], [0.0])
                return
            sign = math.copysign(1.0, push)
            if self._onset == 0.0:
                self._onset = t * self._unit
        self._solve(piece, t, (x, v), sign)

    def _solve(self, piece: tuple[float, float], t: float, start: tuple[float, float], sign: float) -> None:
        """Solve their equation over a window in which they turn in one direction, or which ends as they stop."""
        address, position, pinion_lead, (begin, end) = (
            self._address,
            self._zero.position,
            self._zero.pinion_lead,
            piece,
        )

        def rates(s: float, y: Floats) -> tuple[float, float]:
            x, v = y.tolist()
            return v, free_acceleration(address, begin, end, t + s, position + x, pinion_lead, v, sign)

        span = min(self._span, piece[1] - t)
        while True:
            times, y, steps = self._solution(rates, start, self._grid * span)
            if steps <= MOST_STEPS:
                break
            span *= 0.5 * MOST_STEPS / steps
            self._span = span
        if steps > 3 * len(times):  # what is kept has to follow its steps
            times, y, _ = self._solution(rates, start, np.linspace(0.0, span, steps))
        turned = np.flatnonzero(y[1:, 1] * sign <= 0.0) if self._may_stop else np.empty(0, np.int64)
        last = int(turned[0]) + 1 if turned.size else len(times)
        ends = np.minimum(t + times[1:last], piece[1]).tolist()
        if last == len(times) and span == piece[1] - t:
            ends[-1] = piece[1]
        self._add(ends, y[1:last, 0].tolist(), y[1:last, 1].tolist())
        if last == len(times):
            if steps < MOST_STEPS // 4:
                self._span = min(2.0 * self._span, self._longest)
            return
        low, h = float(times[last - 1]), float(times[last] - times[last - 1])
        share, x = self._stop_within(rates, low, h, (float(y[last - 1, 0]), float(y[last - 1, 1])), sign)
        least = max(SHORTEST * self._end, 1e-14 * t) if last == 1 else 0.0
        time = min(max(t + low + share * h, self._times[-1] + least), piece[1])
        self._span = min(max(_STOP_SPAN * (time - t), 1e3 * SHORTEST * self._end), self._longest)
        self._add([time], [x], [0.0])

    def _stop_within(
        self, rates: Rates, low: float, h: float, first: tuple[float, float], sign: float
    ) -> tuple[float, float]:
        """Share of an interval after which the speed falls to zero, and the travel there."""
        grid = np.linspace(0.0, h, 33)
        times, y, _ = self._solution(lambda s, at: rates(low + s, at), first, grid)
        k = int(np.flatnonzero(np.append(y[1:, 1] * sign, -1.0) <= 0.0)[0])
        if k == 32:
            return 1.0, float(y[-1, 0])
        part = times[k + 1] - times[k]
        ends = [(*y[j].tolist(), rates(low + times[j], y[j])[1]) for j in (k, k + 1)]
        (x0, v0, a0), (x1, v1, a1) = ends
        stop = zero_of_cubic(0.0, 1.0, _HALVINGS, 0.0, sign, part, v0, a0, v1, a1)[1]
        return float(times[k] + stop * part) / h, cubic(stop, part, x0, v0, x1, v1)

    def _add(self, times: list[float], travels: list[float], speeds: list[float]) -> None:
        """Add what is known of them at some times over tau."""
        t, x, v = self._times[-1], self._travels[-1], self._speeds[-1]
        farthest, mark = self._farthest[-1], self._marks[-1][1]
        for after, travel, speed in zip(times, travels, speeds, strict=True):
            farthest = max(farthest, abs(travel))
            if v * speed < 0.0 and after > t:
                farthest_travel = turning_point(after - t, x, v, travel, speed)[1]
                farthest = max(farthest, abs(farthest_travel))
            if farthest > (1.0 + GROWS) * mark:
                mark = farthest
                self._marks.append((after, mark, after * self._unit))
            self._farthest.append(farthest)
            t, x, v = after, travel, speed
        self._times += times
        self._travels += travels
        self._speeds += speeds

    def _solution(self, rates: Rates, start: tuple[float, float], grid: Floats) -> tuple[Floats, Floats, int]:
        """Solve for travel and speed over a window; times, both, and how many steps it took."""
        from scipy.integrate import ODEintWarning, odeint  # a tenth of a second, and most runs need it not

        with _ONE_AT_A_TIME, warnings.catch_warnings():
            # of more steps than wanted: the window is then made shorter
            warnings.simplefilter("ignore", ODEintWarning)
            y, told = odeint(
                rates,
                start,
                grid,
                tfirst=True,
                rtol=RTOL,
                atol=[ATOL, ATOL / grid[-1]],
                tcrit=[grid[-1]],
                hmax=self._largest_step,
                mxstep=2 * MOST_STEPS,
                full_output=True,
            )
        steps = int(told["nst"][-1])
        if not np.isfinite(y).all() or told["message"] != "Integration successful.":
            steps = 8 * MOST_STEPS
        return grid, y, steps
