r"""An asperity that adheres, stretches and detaches (Johnson, Kendall and Roberts).

Scaled by the pull-off load :math:`P_c` and the stretch limit :math:`\delta_c`, every JKR asperity obeys one law.
With s the square root of the scaled contact radius, load and displacement are polynomials,

.. math::

    \frac{\delta}{\delta_c} = 12^{1/3} s^4 - \tfrac43 18^{1/6} s, \qquad
    \frac{P}{P_c} = 2 \left(s^6 - \sqrt2\, s^3\right),

and with :math:`t = s / 18^{-1/6}` simpler still: :math:`\delta/\delta_c = (t^4 - 4t)/3` and
:math:`P/P_c = t^3 (t^3 - 6)/9`. The branch that is stable under given displacement is :math:`t \ge 1`; it ends in a
fold at :math:`\delta = -\delta_c`, where the asperity detaches. An approaching asperity joins when it touches.

Displacements are positive in compression, loads are positive when they push the bodies apart.

References
----------
K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324 (1971) 301-313, doi:10.1098/rspa.1971.0141.
M. Teodorescu, S. Theodossiades, H. Rahnejat, Tribology International 42 (2009) 197-205, Eqs. 7-8,
doi:10.1016/j.triboint.2008.05.019.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearidae.arrays import Floats
from gearidae.asperities.base import AsperityLaw
from gearidae.asperities.hertz import Hertz
from gearidae.asperities.registry import register
from gearidae.asperities.tip import Asperity
from gearidae.references import Reference

S_FOLD = (1.0 / 18.0) ** (1.0 / 6.0)
"""s at the fold, displacement -1: the end of the stable branch."""
S_TOUCH = (8.0 / 9.0) ** (1.0 / 6.0)
"""s at displacement 0: where an approaching asperity snaps in."""
JOINING: Final = (4.0 / 27.0) * (3.6 * 4.0 ** (1.0 / 3.0) + 0.6)
"""Energy that an asperity loses when it joins, over its pull-off load times its stretch limit: minus the integral of
P/P_c over delta/dc from -1 to 0, 0.93550."""


def displacement(s: ArrayLike) -> NDArray[np.float64]:
    """Scaled displacement ``delta/dc`` at the root s of the scaled contact radius.

    Parameters
    ----------
    s : array_like
        Square root of the scaled contact radius; stable from `S_FOLD` up.

    Returns
    -------
    ndarray
        ``12^(1/3) s^4 - (4/3) 18^(1/6) s``, the shape of `s`.
    """
    t = np.asarray(s, dtype=np.float64) / S_FOLD
    return np.asarray(t * (t**3 - 4.0) / 3.0)


def load(s: ArrayLike) -> NDArray[np.float64]:
    """Scaled load ``P/P_c`` at the root s of the scaled contact radius.

    Parameters
    ----------
    s : array_like
        Square root of the scaled contact radius; stable from `S_FOLD` up.

    Returns
    -------
    ndarray
        ``2 (s^6 - sqrt(2) s^3)``, the shape of `s`.
    """
    cube = (np.asarray(s, dtype=np.float64) / S_FOLD) ** 3
    return np.asarray(cube * (cube - 6.0) / 9.0)


def _excess(displacement: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return t - 1 on the stable branch; displacements below -1 count as -1.

    ``(t^4 - 4t)/3 = -1 + e`` reads ``u sqrt(u^2 + 4u + 6) = sqrt(3e)`` in u = t - 1: increasing, convex and regular at
    the fold. Newton's method started to the right of the root therefore falls onto it without ever overshooting, and
    e = 1 + displacement loses no digit near the fold.
    """
    q = np.sqrt(3.0 * np.maximum(1.0 + displacement, 0.0))
    u = np.minimum(q / math.sqrt(6.0), np.sqrt(q))
    finite = np.isfinite(q)
    q, root = np.where(finite, q, 0.0), np.where(finite, u, 0.0)
    for _ in range(12):  # 6 suffice from this start; the test on the step ends it
        radicand = root * (root + 4.0) + 6.0
        step = (root * radicand - q * np.sqrt(radicand)) / (2.0 * (root * (root + 3.0) + 3.0))
        root -= step
        if np.all(np.abs(step) <= 4e-16 * root):
            break
    return np.where(finite, root, u)


def jkr_root(displacement: ArrayLike) -> NDArray[np.float64]:
    """Root s of the scaled contact radius at a scaled displacement, stable branch: the inverse of `displacement`.

    Parameters
    ----------
    displacement : array_like
        ``delta/dc``, -1 or more; less counts as -1.

    Returns
    -------
    ndarray
        s, `S_FOLD` or more, the shape of `displacement`.
    """
    return (1.0 + _excess(np.asarray(displacement, dtype=np.float64))) * S_FOLD


def jkr_load(displacement: ArrayLike) -> NDArray[np.float64]:
    """Load of a JKR asperity in contact, scaled by its pull-off load (Teodorescu et al. 2009, Eqs. 7-8).

    Parameters
    ----------
    displacement : array_like
        ``delta/dc``, displacement over the stretch limit; positive in compression.

    Returns
    -------
    ndarray
        ``P/P_c`` on the stable branch, the shape of `displacement`: -5/9 at the fold -1, never below the pull-off -1,
        -8/9 at 0, towards Hertz's ``displacement^1.5 / sqrt(3)`` in deep compression (``P_c`` is sqrt(3) times the
        Hertz load at a compression of dc). Zero below the fold, where there is no contact; NaN stays NaN.
    """
    d = np.asarray(displacement, dtype=np.float64)
    with np.errstate(over="ignore"):
        cube = (1.0 + _excess(d)) ** 3
        return np.where(d < -1.0, 0.0, cube * (cube - 6.0) / 9.0)


def jkr_slope(displacement: ArrayLike) -> NDArray[np.float64]:
    """Derivative of `jkr_load`: scaled stiffness ``d(P/P_c)/d(delta/dc)`` on the stable branch.

    Parameters
    ----------
    displacement : array_like
        ``delta/dc``, displacement over the stretch limit.

    Returns
    -------
    ndarray
        The shape of `displacement`; -inf at the fold -1 itself, zero below it.
    """
    d = np.asarray(displacement, dtype=np.float64)
    u = _excess(d)  # with t = 1 + u the slope is t^2 (t^3 - 3) / (2 (t^3 - 1))
    with np.errstate(divide="ignore", over="ignore"):
        slope = 0.5 * (1.0 + u) ** 2 * (1.0 - 2.0 / (u * (u * (u + 3.0) + 3.0)))
    return np.where(d < -1.0, 0.0, slope)


@register
@dataclass(frozen=True)
class Jkr(AsperityLaw):
    """Soft asperities whose adhesion acts within the contact.

    Attributes
    ----------
    limit : float
        Stretch limit dc, above 0. In the units of a law the pull-off load is ``sqrt(3) dc^1.5``.
    """

    name: ClassVar[str] = "jkr"
    references: ClassVar[tuple[Reference, ...]] = (
        Reference(
            "johnson1971",
            ("K. L. Johnson", "K. Kendall", "A. D. Roberts"),
            "Surface energy and the contact of elastic solids",
            1971,
            "Proceedings of the Royal Society A",
            "324",
            "301-313",
            doi="10.1098/rspa.1971.0141",
        ),
    )
    limit: float

    @classmethod
    def of(cls, tip: Asperity, unit: float) -> AsperityLaw:
        """Return the law of a tip, lengths over `unit` [m]; without adhesion it is Hertz's."""
        limit = tip.stretch_limit / unit
        return cls(limit) if limit > 0.0 else Hertz()

    @property
    def detach(self) -> float:
        """Distance of detachment: the stretch limit."""
        return self.limit

    @property
    def pull_off(self) -> float:
        """Largest tension, ``1.5 pi beta dgamma``."""
        return math.sqrt(3.0) * self.limit**1.5

    @property
    def loss(self) -> float:
        """Energy lost by joining, 0.93550 times pull-off load times stretch limit."""
        return JOINING * math.sqrt(3.0) * self.limit**2.5

    @property
    def detachment_energy(self) -> float:
        """Energy at the fold, 4/45 times pull-off load times stretch limit: the integral of P over 0 <= t <= 1."""
        return 4.0 / 45.0 * math.sqrt(3.0) * self.limit**2.5

    def load(self, displacement: ArrayLike) -> Floats:
        """Load of an asperity, `jkr_load` in the law's units; see `AsperityLaw.load`."""
        delta = np.asarray(displacement, dtype=np.float64)
        return math.sqrt(3.0) * self.limit**1.5 * jkr_load(delta / self.limit)

    def area(self, displacement: ArrayLike) -> Floats:
        """Contact area, ``dc 12^(1/3) s^4``; see `AsperityLaw.area`."""
        delta = np.asarray(displacement, dtype=np.float64)
        area = self.limit * 12.0 ** (1.0 / 3.0) * jkr_root(delta / self.limit) ** 4
        return np.where(delta < -self.limit, 0.0, area)

    def nodes(self, low: ArrayLike, high: ArrayLike, x: Floats, w: Floats) -> tuple[Floats, Floats]:
        """Lay a quadrature rule out in s, in which load and displacement are polynomials; see `AsperityLaw.nodes`."""
        ends = jkr_root(np.stack(np.broadcast_arrays(low, high)) / self.limit)[..., None]
        half, middle = 0.5 * (ends[1] - ends[0]), 0.5 * (ends[1] + ends[0])
        s = half * x + middle
        rate = 4.0 * 12.0 ** (1 / 3) * s**3 - 4.0 / 3.0 * 18.0 ** (1 / 6)
        weight = half * w * rate * load(s) * math.sqrt(3.0) * self.limit**2.5
        return displacement(s) * self.limit, weight

    def energy(self, displacement: ArrayLike) -> Floats:
        """Energy that an asperity stores, a polynomial in t = 1 + u; see `AsperityLaw.energy`."""
        u = _excess(np.asarray(displacement, dtype=np.float64) / self.limit)
        # the integral of t^3 (t^3 - 6)/9 over (t^4 - 4t)/3 from t = 1; what is below a fold counts as at it
        t = 1.0 + u
        lifted = t**4 * ((0.1 * t**3 - 1.0) * t**3 + 1.5) - 0.6
        return np.asarray(4.0 / 27.0 * lifted * math.sqrt(3.0) * self.limit**2.5)
