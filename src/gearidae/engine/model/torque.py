"""Torque laws at the shafts: constant, harmonics, piecewise-linear schedule (Teodorescu et al. 2009, Eq. 2)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine.model import layout as at

__all__ = ["fastest_harmonic", "pack_torque", "torque_force", "torque_rate"]

Floats = NDArray[np.float64]


def pack_torque(
    constant: float,
    harmonics: list[tuple[float, float, float]],
    schedule: list[tuple[float, float]],
    time_unit: float,
    torque_unit: float,
) -> Floats:
    """Lay a torque law out as `torque_force` reads it, for a start at time 0.

    Parameters
    ----------
    constant : float
        Steady torque [N m].
    harmonics : list of (amplitude, frequency, phase)
        [N m], [Hz], [rad].
    schedule : list of (time, value)
        Added to the constant, linear between points, constant outside them [s], [N m].
    time_unit, torque_unit : float
        tau [s] and F R [N m].
    """
    turns = 2.0 * math.pi * time_unit
    body = [x for a, f, p in harmonics for x in (a / torque_unit, turns * f, p)]
    body += [x for t, value in schedule for x in (t / time_unit, value / torque_unit)]
    passed = sum(t <= 0.0 for t, _ in schedule)
    return np.array([constant / torque_unit, len(harmonics), len(schedule), passed, *body])


@compiled(inline=True)
def torque_force(d: Floats, law: int, t: float) -> float:
    """Torque over base radius at scaled time t, in units of the reference load.

    The schedule's segment is read, not searched: it changes at knots only, so that a step never sees two of them.
    """
    k = law + at.LAW_BODY
    value = d[law + at.LAW_CONSTANT]
    for _ in range(int(d[law + at.LAW_HARMONICS])):
        value += d[k] * math.cos(d[k + 1] * t + d[k + 2])
        k += 3
    points = int(d[law + at.LAW_POINTS])
    if points > 0:
        j = int(d[law + at.LAW_SEGMENT])
        if j == 0:
            value += d[k + 1]
        elif j == points:
            value += d[k + 2 * points - 1]
        else:
            k += 2 * j
            share = (t - d[k - 2]) / (d[k] - d[k - 2])
            value += d[k - 1] + share * (d[k + 1] - d[k - 1])
    return value


@compiled
def fastest_harmonic(d: Floats, law: int, felt: float) -> float:
    """Angular frequency of the fastest harmonic that turns a body's speed by more than this impulse; 0 if none does."""
    fastest = 0.0
    for k in range(int(d[law + at.LAW_HARMONICS])):
        amplitude, frequency = d[law + at.LAW_BODY + 3 * k], abs(d[law + at.LAW_BODY + 3 * k + 1])
        if abs(amplitude) > felt * frequency:
            fastest = max(fastest, frequency)
    return fastest


@compiled
def torque_rate(d: Floats, law: int, t: float) -> float:
    """Rate of change of `torque_force`."""
    k = law + at.LAW_BODY
    rate = 0.0
    for _ in range(int(d[law + at.LAW_HARMONICS])):
        rate -= d[k] * d[k + 1] * math.sin(d[k + 1] * t + d[k + 2])
        k += 3
    points, j = int(d[law + at.LAW_POINTS]), int(d[law + at.LAW_SEGMENT])
    if 0 < j < points:
        k += 2 * j
        rate += (d[k + 1] - d[k - 1]) / (d[k] - d[k - 2])
    return rate
