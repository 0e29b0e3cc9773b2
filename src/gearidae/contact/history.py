"""What a contact remembers: the height above which its asperities are joined.

Asperities join when they touch, stretch when the surfaces part, and detach at the stretch limit dc. Let zeta be the
height above which they are joined. Along any monotone stretch of motion that began with zeta_k,

    zeta = min(max(zeta_k, h - dc), h),

a play (backlash) operator: exact, independent of the rate, and in need of memory only where the motion turns round.
The most stretched asperity still in contact is extended by S = h - zeta.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.formulas.interpolation import turning_point


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
    return turning_point(span, gap0, rate0, gap1, rate1)[1]
