"""Harmonics of a torque: ``amplitude cos(omega t + phase)``, and ``amplitude cos(order angle + phase)``."""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from typing import TYPE_CHECKING, Final

from gearidae.compiled import compiled
from gearidae.laws.law import INT, Range, ShaftLaw

if TYPE_CHECKING:
    from gearidae.arrays import Floats
    from gearidae.engine.model.state import Model

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
def _add_cosines(m: Model, at: int, count: int, x: float, value: float) -> float:
    """Add ``amplitude cos(factor x + phase)`` of some harmonics to a value; `x` is the time or the shaft's angle."""
    k = at
    for _ in range(count):
        value += m.tables[k] * math.cos(m.tables[k + 1] * x + m.tables[k + 2])
        k += 3
    return value


@compiled
def _slope_of_cosines(m: Model, at: int, count: int, x: float) -> float:
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


# -- of the time -----------------------------------------------------------------------------------------------------


@compiled(inline=True)
def _force(m: Model, shaft: int, t: float, angle: float, speed: float, value: float) -> float:
    torque = m.scene.torque[shaft]
    return _add_cosines(m, torque.harmonics_at, torque.harmonic_count, t, value)


@compiled
def _rate(
    m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float, value: float
) -> float:
    torque = m.scene.torque[shaft]
    return value + _slope_of_cosines(m, torque.harmonics_at, torque.harmonic_count, t)


@compiled
def _is_constant(m: Model, shaft: int, value: bool) -> bool:
    return bool(value and m.scene.torque[shaft].harmonic_count == 0)


@compiled
def _is_steady(m: Model, shaft: int, t: float, value: bool) -> bool:
    return bool(value and m.scene.torque[shaft].harmonic_count == 0)


@compiled
def _range(m: Model, shaft: int, t: float, to: float, value: Range) -> Range:
    torque = m.scene.torque[shaft]
    k, moving, swing = torque.harmonics_at, value.moving, value.swing
    for _ in range(torque.harmonic_count):
        if m.tables[k + 1] != 0.0:
            moving += m.tables[k] * math.cos(m.tables[k + 1] * t + m.tables[k + 2])
            swing += abs(m.tables[k])
        k += 3
    return Range(moving, swing, value.low, value.high)


HARMONICS = ShaftLaw(
    "harmonics",
    drives=True,
    fields=(
        ("harmonic_count", INT),  # [1]
        ("harmonics_at", INT),  # amplitude, angular frequency and phase of each, among the tables [index]
    ),
    force=_force,
    rate=_rate,
    is_constant=_is_constant,
    is_steady=_is_steady,
    range=_range,
)


# -- of the angle ----------------------------------------------------------------------------------------------------


@compiled
def _sum_of_orders(m: Model, shaft: int, angle: float) -> float:
    """Sum of them; not put into its callers, most of which have none."""
    torque = m.scene.torque[shaft]
    return _add_cosines(m, torque.orders_at, torque.order_count, angle, 0.0)


@compiled(inline=True)
def _force_of_orders(m: Model, shaft: int, t: float, angle: float, speed: float, value: float) -> float:
    if m.scene.torque[shaft].order_count != 0:
        value += _sum_of_orders(m, shaft, angle)
    return value


@compiled
def _rate_of_orders(
    m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float, value: float
) -> float:
    torque = m.scene.torque[shaft]
    if torque.order_count != 0:
        slope = _slope_of_cosines(m, torque.orders_at, torque.order_count, angle)
        value += slope * speed * torque.angle_unit
    return value


@compiled
def _has_no_orders(m: Model, shaft: int, value: bool) -> bool:
    return bool(value and m.scene.torque[shaft].order_count == 0)


ORDERS = ShaftLaw(
    "orders",
    drives=True,
    fields=(
        ("order_count", INT),  # harmonics of the shaft's angle [1]
        ("orders_at", INT),  # amplitude, order and phase of each, among the tables [index]
    ),
    force=_force_of_orders,
    rate=_rate_of_orders,
    is_constant=_has_no_orders,
)
