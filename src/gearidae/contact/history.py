"""What a contact remembers: the height above which its asperities are joined.

Asperities join when they touch, stretch when the surfaces part, and detach at the stretch limit dc. Let zeta be the
height above which they are joined. Along any monotone stretch of motion that began with zeta_k,

    zeta = min(max(zeta_k, h - dc), h),

a play (backlash) operator: exact, independent of the rate, and in need of memory only where the motion turns round.
The most stretched asperity still in contact is extended by S = h - zeta.
"""

from __future__ import annotations

import math

from gearidae.compiled import compiled


@compiled
def joined_height(joined: float, gap: float, limit: float) -> float:
    """Joined height after a monotone motion that began with another: the play operator.

    Parameters
    ----------
    joined : float
        Joined height at the last turning point.
    gap : float
        Mean gap now, in the same unit.
    limit : float
        Stretch limit of an asperity, in the same unit.

    Returns
    -------
    float
        Between ``gap - limit`` (fully stretched) and ``gap`` (nothing stretched).
    """
    return min(max(joined, gap - limit), gap)


@compiled
def extreme_gap(span: float, gap0: float, rate0: float, gap1: float, rate1: float) -> float:
    """Turning point of the gap between two times whose gap rates differ in sign, by cubic Hermite interpolation.

    Parameters
    ----------
    span : float
        Time between.
    gap0, rate0, gap1, rate1 : float
        Gap and gap rate at both ends.

    Returns
    -------
    float
        Gap at the turning point; its error is of fourth order in `span`.
    """
    m0, m1 = span * rate0, span * rate1
    rise = gap1 - gap0
    a = 3.0 * (m0 + m1 - 2.0 * rise)
    b = m1 - m0 - a
    root = math.sqrt(max(b * b - 4.0 * a * m0, 0.0))
    q = -0.5 * (b + (root if b >= 0.0 else -root))
    # of the two zeros q/a and m0/q of the rate a s^2 + b s + m0 exactly one lies within the step
    s = m0 / q if q != 0.0 else 0.0
    if not 0.0 <= s <= 1.0:
        s = q / a if a != 0.0 else 0.5
    s = min(max(s, 0.0), 1.0)
    return gap0 + s * (m0 + s * (0.5 * b + s * a / 3.0))
