"""Harmonics of a torque: ``amplitude cos(omega t + phase)``, and ``amplitude cos(order angle + phase)``."""

from __future__ import annotations

import math
from collections.abc import Iterable

from gearidae.compiled import compiled
from gearidae.engine.model.state import Floats, Model


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
def harmonic_value(m: Model, shaft: int, t: float, value: float) -> float:
    """Add the harmonics at a time to a value."""
    own = m.scene.torque[shaft]
    k = own.harmonics_at
    for _ in range(own.harmonic_count):
        value += m.tables[k] * math.cos(m.tables[k + 1] * t + m.tables[k + 2])
        k += 3
    return value


@compiled
def harmonic_rate(m: Model, shaft: int, t: float) -> float:
    """Rate of change of the harmonics."""
    own = m.scene.torque[shaft]
    k = own.harmonics_at
    rate = 0.0
    for _ in range(own.harmonic_count):
        rate -= m.tables[k] * m.tables[k + 1] * math.sin(m.tables[k + 1] * t + m.tables[k + 2])
        k += 3
    return rate


@compiled
def order_value(m: Model, shaft: int, angle: float) -> float:
    """Sum of the harmonics of the shaft's angle [rad]."""
    own = m.scene.torque[shaft]
    k = own.orders_at
    value = 0.0
    for _ in range(own.order_count):
        value += m.tables[k] * math.cos(m.tables[k + 1] * angle + m.tables[k + 2])
        k += 3
    return value


@compiled
def order_rate(m: Model, shaft: int, angle: float) -> float:
    """Rate of change of these per radian."""
    own = m.scene.torque[shaft]
    k = own.orders_at
    rate = 0.0
    for _ in range(own.order_count):
        rate -= m.tables[k] * m.tables[k + 1] * math.sin(m.tables[k + 1] * angle + m.tables[k + 2])
        k += 3
    return rate


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
