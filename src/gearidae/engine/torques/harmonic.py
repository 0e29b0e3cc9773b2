"""Harmonics of a torque: ``amplitude cos(omega t + phase)``, and ``amplitude cos(order angle + phase)``."""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from typing import Final

from gearidae.compiled import compiled
from gearidae.engine.model.state import Floats, Model

WHOLE_HIGH: Final = 1000
"""Periods of one harmonic in a common period at most, in which another has a whole number, too,"""
WHOLE_RTOL: Final = 1e-15
"""and by how much, relatively, the ratio of two frequencies may miss that of whole numbers: by its rounding."""


def pack_harmonics(
    harmonics: Iterable[tuple[float, float, float]], time_unit: float, torque_unit: float
) -> list[float]:
    """Lay harmonics out as the functions below read them.

    Parameters
    ----------
    harmonics : iterable of (amplitude, frequency, phase)
        [N m], [Hz], [rad].
    time_unit, torque_unit : float
        tau [s] and F R [N m].
    """
    turns = 2.0 * math.pi * time_unit
    return [x for a, f, p in harmonics for x in (a / torque_unit, turns * f, p)]


@compiled(inline=True)
def add_cosines(m: Model, at: int, count: int, x: float, value: float) -> float:
    """Add ``amplitude cos(factor x + phase)`` of some harmonics to a value; `x` is the time or the shaft's angle."""
    k = at
    for _ in range(count):
        value += m.tables[k] * math.cos(m.tables[k + 1] * x + m.tables[k + 2])
        k += 3
    return value


@compiled
def sum_of_cosines(m: Model, at: int, count: int, x: float) -> float:
    """Return their sum; not put into its callers, most of which have none."""
    return add_cosines(m, at, count, x, 0.0)


@compiled
def slope_of_cosines(m: Model, at: int, count: int, x: float) -> float:
    """Derivative of their sum in x."""
    k, slope = at, 0.0
    for _ in range(count):
        slope -= m.tables[k] * m.tables[k + 1] * math.sin(m.tables[k + 1] * x + m.tables[k + 2])
        k += 3
    return slope


def fastest_harmonic(harmonics: Floats, felt: float) -> float:
    """Angular frequency of the fastest harmonic that turns a body's speed by more than an impulse; 0 if none does.

    Parameters
    ----------
    harmonics : ndarray, shape (3 n,)
        From `pack_harmonics`.
    felt : float
        The impulse.
    """
    amplitudes, frequencies = abs(harmonics[0::3]), abs(harmonics[1::3])
    return float(frequencies[amplitudes > felt * frequencies].max(initial=0.0))


def common_period(frequencies: Iterable[float]) -> float:
    """Shortest time that is a whole number of periods of all frequencies above zero; 0 if there is none.

    Parameters
    ----------
    frequencies : iterable of float
        [Hz]
    """
    moving, periods = [frequency for frequency in frequencies if frequency > 0.0], 1
    for frequency in moving:
        ratio = Fraction(frequency / moving[0]).limit_denominator(WHOLE_HIGH)
        if abs(frequency / moving[0] - ratio) > WHOLE_RTOL * ratio:
            return 0.0
        periods = math.lcm(periods, ratio.denominator)
    return periods / moving[0] if moving else 0.0


@compiled
def swing_of_cosines(m: Model, at: int, count: int, x: float) -> tuple[float, float]:
    """Sum of those that change with `x`, and the largest size that it can have."""
    k, value, swing = at, 0.0, 0.0
    for _ in range(count):
        if m.tables[k + 1] != 0.0:
            value += m.tables[k] * math.cos(m.tables[k + 1] * x + m.tables[k + 2])
            swing += abs(m.tables[k])
        k += 3
    return value, swing
