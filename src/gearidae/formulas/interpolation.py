"""Polynomials between two accepted times."""

from __future__ import annotations

import math

from gearidae.compiled import compiled


@compiled
def cubic(s: float, h: float, f0: float, rate0: float, f1: float, rate1: float) -> float:
    """Cubic with given values and rates at both ends, at a share s of the way h between them."""
    return f0 + s * s * (3.0 - 2.0 * s) * (f1 - f0) + s * (1.0 - s) * h * ((1.0 - s) * rate0 - s * rate1)


@compiled
def cubic_slope(s: float, h: float, f0: float, rate0: float, f1: float, rate1: float) -> float:
    """Slope of `cubic` in s."""
    ends = (1.0 - s) * (1.0 - 3.0 * s) * rate0 - s * (2.0 - 3.0 * s) * rate1
    return 6.0 * s * (1.0 - s) * (f1 - f0) + h * ends


@compiled
def turning_point(h: float, f0: float, rate0: float, f1: float, rate1: float) -> tuple[float, float]:
    """Share of the way at which `cubic` turns round between ends whose rates differ in sign, and its value there."""
    m0, m1 = h * rate0, h * rate1
    rise = f1 - f0
    a = 3.0 * (m0 + m1 - 2.0 * rise)
    b = m1 - m0 - a
    root = math.sqrt(max(b * b - 4.0 * a * m0, 0.0))
    q = -0.5 * (b + (root if b >= 0.0 else -root))
    # of the two zeros q/a and m0/q of the rate a s^2 + b s + m0 exactly one lies within the step
    s = m0 / q if q != 0.0 else 0.0
    if not 0.0 <= s <= 1.0:
        s = q / a if a != 0.0 else 0.5
    s = min(max(s, 0.0), 1.0)
    return s, f0 + s * (m0 + s * (0.5 * b + s * a / 3.0))


@compiled
def quintic(s: float, h: float, end0: tuple[float, float, float], end1: tuple[float, float, float]) -> float:
    """Polynomial of degree five with given value, rate and acceleration at both ends.

    The cubic with their values and rates, and a term that only corrects its second derivatives there.
    """
    (f0, rate0, bend0), (f1, rate1, bend1) = end0, end1
    rise, m0, m1 = f1 - f0, h * rate0, h * rate1
    c0 = h * h * bend0 - 6.0 * rise + 4.0 * m0 + 2.0 * m1
    c1 = h * h * bend1 + 6.0 * rise - 2.0 * m0 - 4.0 * m1
    inner = s * (1.0 - s)
    return cubic(s, h, f0, rate0, f1, rate1) + 0.5 * inner * inner * ((1.0 - s) * c0 + s * c1)


@compiled
def vertex(t0: float, f0: float, t1: float, f1: float, t2: float, f2: float) -> tuple[float, float, float]:
    """Vertex of the parabola through three points: its argument and value, and half its second derivative."""
    first, second = (f1 - f0) / (t1 - t0), (f2 - f1) / (t2 - t1)
    curvature = (second - first) / (t2 - t0)
    t = 0.5 * (t0 + t1 - first / curvature)
    return t, f0 + (t - t0) * (first + curvature * (t - t1)), curvature
