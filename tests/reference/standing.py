"""Where a gear stands, judged apart from the engine: from dense samples, with free gears of its own (scipy)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

Floats = NDArray[np.float64]


def scheduled(schedule: Any, t: float) -> float:
    """Value of a schedule, which holds its first and its last one outside its knots; 0 without knots."""
    if len(schedule) == 0:
        return 0.0
    times, values = np.array(schedule).T
    if getattr(schedule, "interpolation", "linear") == "cubic":
        return float(PchipInterpolator(times, values)(np.clip(t, times[0], times[-1])))
    return float(np.interp(t, times, values))


@dataclass(frozen=True)
class Plant:
    """Shafts and torques: `drive(t, speed)` at the pinion, `dry(t)` at the gear, all SI."""

    inertia: float
    ratio: float
    drag: float
    viscous: float
    drive: Callable[[float, float], float]
    dry: Callable[[float], float]
    breaks: Floats
    step: float

    @classmethod
    def of(cls, scene: Any, law: Callable[[float, float], float] | None = None) -> Plant:
        """Read a scene with torques of the time and the speed."""
        g, d, ld = scene.gears, scene.drive, scene.load
        ratio = g.gear_teeth / g.pinion_teeth

        def value(shaft: Any, t: float) -> float:
            total = shaft.torque + sum(
                h.amplitude * math.cos(2 * math.pi * h.frequency * t + h.phase) for h in shaft.harmonic
            )
            return total + scheduled(shaft.schedule, t)

        speeds = d.speed_knots()

        def drive(t: float, speed: float) -> float:
            held = d.speed_gain * (scheduled(speeds, t) - speed) if len(speeds) else 0.0
            return value(d, t) + held + (law(t, speed) if law else 0.0)

        knots = [t for s in (d.schedule, ld.schedule, d.speed_knots()) for t, _ in s]
        fast = [h.frequency for s in (d, ld) for h in s.harmonic]
        return cls(
            g.gear_inertia + g.pinion_inertia * ratio**2,
            ratio,
            ld.drag,
            ld.viscous,
            drive,
            lambda t: max(value(ld, t), 0.0),
            np.array(sorted(knots)),
            0.02 / max(fast) if fast else math.inf,
        )

    def excess(self, t: float) -> float:
        """Size of the drive beyond the dry load of a gear at rest [N m]."""
        return abs(self.ratio * self.drive(t, 0.0)) - self.dry(t)


def free_way(plant: Plant, start: float, times: Floats) -> Floats:
    """Angle [rad] of free gears from rest at `start`, at later times."""
    at, w, x = start, 0.0, 0.0
    out = np.empty(len(times))
    done = 0
    end = float(times[-1])
    grid = np.unique(np.concatenate([times, plant.breaks]))
    while done < len(times):
        if w == 0.0 and plant.excess(at) <= 1e-12 * plant.dry(at) + 1e-30:
            fine = grid[grid > at]
            if plant.step < math.inf:
                fine = np.unique(np.concatenate([fine, np.arange(at, end, plant.step)[1:]]))
            later = next(
                (float(t) for t in fine if plant.excess(float(t)) > 1e-12 * plant.dry(float(t)) + 1e-30), None
            )
            stop = later if later is not None else end + 1.0
            if later is not None:
                before = max([at, *fine[fine < later].tolist()])
                low, high = before, later
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    low, high = (
                        (middle, high)
                        if plant.excess(middle) <= 1e-12 * plant.dry(middle) + 1e-30
                        else (low, middle)
                    )
                stop = high
            while done < len(times) and times[done] <= stop:
                out[done] = x
                done += 1
            if later is None:
                break
            at = stop
        sign = math.copysign(1.0, w if w != 0.0 else plant.drive(at, 0.0))

        def slope(t: float, y: Floats, sign: float = sign) -> list[float]:
            push = plant.ratio * plant.drive(t, plant.ratio * y[0])
            drags = plant.drag * y[0] * abs(y[0]) + plant.viscous * y[0]
            return [(push - sign * plant.dry(t) - drags) / plant.inertia, y[0]]

        def rest(t: float, y: Floats) -> float:
            return float(y[0])

        rest.terminal, rest.direction = True, -sign  # type: ignore[attr-defined]
        following = plant.breaks[plant.breaks > at * (1 + 1e-12)]
        piece = min(float(following[0]), end) if len(following) else end
        if piece <= at:
            piece = end
        wanted = times[done:][times[done:] <= piece]
        if at >= end:
            out[done:] = x
            break
        solution = solve_ivp(
            slope,
            (at, piece),
            [w, x],
            method="LSODA",
            t_eval=np.unique(np.append(wanted[wanted >= at], piece)),
            events=rest,
            rtol=1e-8,
            atol=[1e-12, 1e-12],
            max_step=plant.step if plant.step < math.inf else (piece - at) / 20,
        )
        reached = float(solution.t_events[0][0]) if len(solution.t_events[0]) else piece
        lookup = dict(zip(solution.t.tolist(), solution.y[1].tolist(), strict=True))
        while done < len(times) and times[done] <= reached and times[done] <= piece:
            out[done] = lookup.get(float(times[done]), x)
            done += 1
        if len(solution.t_events[0]):
            moved = abs(float(solution.y_events[0][0][1]) - x) + abs(reached - at)
            at, w, x = reached, 0.0, float(solution.y_events[0][0][1])
            if moved == 0.0:
                at += 1e-9 * end
        else:
            at, w, x = piece, float(solution.y[0][-1]), float(solution.y[1][-1])
    return out


def zeros_of(time: Floats, speed: Floats) -> NDArray[np.int64]:
    """Samples at or just after zeros of the speed."""
    sign = np.sign(speed)
    changed = np.flatnonzero(sign[1:] != sign[:-1]) + 1
    return np.concatenate([[0] if speed[0] == 0.0 else [], changed]).astype(np.int64)


def judge(
    time: Floats, angle: Floats, speed: Floats, plant: Plant, pitch: float, period: float
) -> tuple[str, float]:
    """Verdict (``moves`` for all that turn on) and time of sticking of a run that ends with the last sample."""
    x = angle / pitch
    end = len(x) - 1
    high_after = np.maximum.accumulate(x[::-1])[::-1]
    low_after = np.minimum.accumulate(x[::-1])[::-1]
    zeros = zeros_of(time, speed)
    near = [k for k in zeros if k < end and high_after[k] - x[k] <= 0.5 and x[k] - low_after[k] <= 0.5]
    length = time[-1]
    for k in thinned(near, x, high_after, low_after):
        a = max(high_after[k] - x[k], x[k] - low_after[k])
        b = float(np.abs(free_way(plant, float(time[k]), time[k:])).max()) / pitch
        lasts = length - time[k]
        if (a < 0.5 * b or b == 0.0) and (b >= 0.1 or lasts > 0.01 * length):
            beyond = [float(plant.excess(float(t)) > 1e-30) for t in time[k:]]
            driven = float(np.trapezoid(beyond, time[k:])) > 0.01 * length
            never = speed[0] == 0.0 and np.abs(x - x[0]).max() <= 0.5
            return ("sticks" if b >= 0.1 or driven else "stops"), (0.0 if never else float(time[k]))
    return back(time, x, plant, pitch, zeros, period), math.nan


def thinned(near: list[int], x: Floats, high: Floats, low: Floats) -> list[int]:
    """At most 60 of the zeros: the first, and those spread over the rest."""
    if len(near) <= 60:
        return near
    return near[:20] + [near[int(i)] for i in np.linspace(20, len(near) - 1, 40)]


def back(time: Floats, x: Floats, plant: Plant, pitch: float, zeros: NDArray[np.int64], period: float) -> str:
    """``turns back``, ``runs back`` or ``moves``."""
    direction, high, low, since, pivot = 0, 0, 0, 0.0, 0
    for k in range(len(x)):
        if direction >= 0:
            high = k if x[k] > x[high] else high
            if x[k] < x[high] - 0.5:
                since = float(time[k]) if direction else 0.0
                direction, pivot, low = -1, high, k
        if direction <= 0:
            low = k if x[k] < x[low] else low
            if x[k] > x[low] + 0.5:
                direction, high = 1, k
    if direction < 0 and (since == 0.0 or since <= time[-1] - period):
        free = free_way(plant, float(time[pivot]), time[pivot:])[-1] / pitch
        return "turns back" if -free >= 0.5 * (x[pivot] - x[-1]) else "runs back"
    return "moves"
