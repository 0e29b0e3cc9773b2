"""Quadrature of powers over one or several steps, from values and rates at both ends."""

from __future__ import annotations

from typing import NamedTuple

from gearidae.compiled import compiled


class Ends(NamedTuple):
    """A quantity and its rate at the beginning and at the end of an interval."""

    start: float
    start_rate: float
    end: float
    end_rate: float


@compiled
def torque_work(h: float, travel: float, force: Ends, speed: Ends) -> tuple[float, float]:
    """Work of a torque along a travel, and how far it may be out.

    The mean of the torque does its part exactly, and its change that at the mean speed nearly so; what is in doubt is
    the work at the speed's deviation.
    """
    work = 0.5 * (force.start + force.end) * travel
    if force.start_rate == 0.0 and force.end_rate == 0.0:
        return work, 0.0
    mean, half = travel / h, 0.5 * (force.end - force.start)
    a, b = speed.start - mean, speed.end - mean
    start, end = force.start_rate * a - half * speed.start_rate, force.end_rate * b + half * speed.end_rate
    slow = mean * correction(h, force.start_rate, force.end_rate)
    return work + slow + integral(h, -half * a, half * b, start, end), error_estimate(
        h, half * a, half * b, start, end
    )


@compiled
def error_estimate(h: float, f0: float, f1: float, rate0: float, rate1: float) -> float:
    """By how much the corrected trapezoidal rule may be out: its correction, times the share that this has in it."""
    corrected = abs(correction(h, rate0, rate1))
    if corrected == 0.0:
        return 0.0
    return corrected * corrected / (corrected + 0.5 * h * (abs(f0) + abs(f1)))


@compiled
def integral(h: float, f0: float, f1: float, rate0: float, rate1: float) -> float:
    """Corrected trapezoidal rule: exact for cubics."""
    return 0.5 * h * (f0 + f1) + correction(h, rate0, rate1)


@compiled
def correction(h: float, rate0: float, rate1: float) -> float:
    """What the rates correct the trapezoidal rule by."""
    return h * h / 12.0 * (rate0 - rate1)


@compiled
def integral_with_middle(h: float, f0: float, middle: float, f1: float, rate0: float, rate1: float) -> float:
    """Corrected trapezoidal rule, extrapolated with the value in the middle: exact for quintics."""
    return h * (7.0 * (f0 + f1) + 16.0 * middle) / 30.0 + 0.2 * correction(h, rate0, rate1)


@compiled
def middle_deviation(h: float, deviation: Ends) -> float:
    """Deviation from the mean in the middle of an interval: the one with which `integral_with_middle` gives zero."""
    rates = deviation.start_rate - deviation.end_rate
    return -(7.0 * (deviation.start + deviation.end) + 0.5 * h * rates) / 16.0


@compiled
def integral_of_cube(h: float, travel: float, speed: Ends) -> tuple[float, float]:
    """Integral of the cube of a speed's magnitude, and how far it may be out.

    The integral of the speed itself is known, the travel: what is left to the quadrature is of second order in the
    speed's deviation from its mean, and the deviation in the middle follows from those at the ends.
    """
    mean, (w0, rate0, w1, rate1) = travel / h, speed
    if mean * w0 <= 0.0 or mean * w1 <= 0.0:  # the speed has changed sign
        q0, q1 = w0 * abs(w0), w1 * abs(w1)
        start, end = 3.0 * q0 * rate0, 3.0 * q1 * rate1
        return integral(h, q0 * w0, q1 * w1, start, end), error_estimate(h, q0 * w0, q1 * w1, start, end)
    a, b = w0 - mean, w1 - mean
    c = middle_deviation(h, Ends(a, rate0, b, rate1))
    # of the cube of mean and deviation, the deviation itself leaves nothing
    f0, middle, f1 = (3.0 * mean + a) * a * a, (3.0 * mean + c) * c * c, (3.0 * mean + b) * b * b
    start, end = 3.0 * (2.0 * mean + a) * a * rate0, 3.0 * (2.0 * mean + b) * b * rate1
    error = (3.0 * abs(mean) + max(abs(a), abs(b))) * error_of_square(h, rate0, rate1)
    corrected = abs(correction(h, start, end))
    if corrected > 0.5 * h * (abs(f0) + abs(f1)):
        # the step is too long for the drag: rates may be out at both ends alike
        error = max(error, corrected)
    return abs(mean * mean * travel + integral_with_middle(h, f0, middle, f1, start, end)), error


@compiled
def integral_of_square(h: float, travel: float, speed: Ends) -> tuple[float, float]:
    """Integral of the square of a speed, of which the travel is known, and how far it may be out."""
    mean, (w0, rate0, w1, rate1) = travel / h, speed
    a, b = w0 - mean, w1 - mean
    c = middle_deviation(h, Ends(a, rate0, b, rate1))
    rest = integral_with_middle(h, a * a, c * c, b * b, 2.0 * a * rate0, 2.0 * b * rate1)
    return mean * travel + rest, error_of_square(h, rate0, rate1)


@compiled
def error_of_square(h: float, rate0: float, rate1: float) -> float:
    r"""By how much `integral_with_middle` may be out for the square of a quantity x that vibrates.

    The error of the corrected trapezoidal rule is :math:`h^5/720` times the fourth derivative,
    :math:`6 \ddot x^2 + 8 \dot x \dddot x + 2 x x^{(4)}`. Over a vibration each of these products is as large as
    :math:`\ddot x^2` on average, which the rates at both ends show. With the middle, the error is of seventh order in h
    and less than a sixteenth of that, unless a step lasts as long as half a vibration.
    """
    change = rate1 - rate0
    return h * h * h * change * change / 720.0
