r"""Asperities whose adhesion has a range: a Dugdale zone of constant stress (Maugis).

The surfaces attract each other with the stress :math:`\sigma_0 = \Delta\gamma/h_0` wherever they are less than
:math:`h_0` apart, with :math:`h_0 = \tfrac{9\sqrt3}{16}\varepsilon`, so that the stress is the peak of the
Lennard-Jones law of range :math:`\varepsilon`. With :math:`K = \tfrac43 E^*`, lengths over
:math:`(\pi^2 \Delta\gamma^2 \beta/K^2)^{1/3}`, loads over :math:`\pi\beta\Delta\gamma`, contact radius A and outer
radius of the zone C over :math:`(\pi\Delta\gamma\beta^2/K)^{1/3}`, one number is left,
:math:`\lambda = 2\sigma_0 (\beta/(\pi \Delta\gamma K^2))^{1/3}`, about 1.157 times Tabor's. Where the tip touches, with
:math:`A = C\cos q`,

.. math::

    1 = \tfrac{\lambda}{2} C^2 \left(\sin q \cos q - q\cos 2q\right)
        + \tfrac43 \lambda^2 C \left(q \sin q - 1 + \cos q\right), \qquad
    P = A^3 - \lambda C^2 (\sin q\cos q + q), \qquad \Delta = A^2 - \tfrac43 \lambda C \sin q ;

where it attracts without touching,

.. math::

    P = -\tfrac{\pi}{2} \lambda C^2, \qquad
    \Delta = \tfrac12 C^2 - \tfrac{8}{3\pi} \lambda C - \tfrac{2}{\pi\lambda},

and the two meet at q = pi/2. An approaching tip joins where the stress begins to act, at the distance
:math:`h_0 = 2/(\pi\lambda)`; a receding tip detaches at the single fold, which lies on the second branch for
:math:`\lambda < 0.938`.

References
----------
D. Maugis, J. Colloid Interface Sci. 150 (1992) 243-269, doi:10.1016/0021-9797(92)90285-T.
K.-S. Kim, R. M. McMeeking, K. L. Johnson, J. Mech. Phys. Solids 46 (1998) 243-266,
doi:10.1016/S0022-5096(97)00070-7: the branch without contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import ClassVar, Final

import numpy as np
from numpy.typing import ArrayLike

from gearidae.arrays import Floats
from gearidae.asperities.base import AsperityLaw
from gearidae.asperities.hertz import Hertz
from gearidae.asperities.registry import register
from gearidae.asperities.tip import Asperity
from gearidae.references import Reference

HALF_PI: Final = 0.5 * math.pi
Z_TOUCH: Final = HALF_PI**-0.75
"""z where the tip begins to touch. In ``z = q**(-3/4)`` displacement and load grow like powers, as in JKR's s."""
_SERIES = np.array([(-1) ** k * (k + 1) * 2.0 ** (2 * k + 3) / math.factorial(2 * k + 3) for k in range(11)])


def branch_at(z: Floats, zone: float) -> tuple[Floats, Floats, Floats, Floats]:
    """Displacement, load, rate of the displacement and contact area on the branch of tips that touch.

    Parameters
    ----------
    z : ndarray
        Parameter, `Z_TOUCH` or more; ``q**(-3/4)``.
    zone : float
        lambda.

    Returns
    -------
    displacement, load, rate, area : ndarray, the shape of `z`
        In units of adhesion; the rate is the derivative of the displacement in z, and the area that of the inner
        radius, A squared.
    """
    q = z ** (-4.0 / 3.0)
    s, c, twice = np.sin(q), np.cos(q), np.cos(2.0 * q)
    # sin q cos q - q cos 2q loses digits where q is small
    small = q < 0.5
    near = np.where(small, q, 0.0)
    f = np.where(small, near**3 * np.polynomial.polynomial.polyval(near**2, _SERIES), s * c - q * twice)
    g = q * s - 2.0 * np.sin(0.5 * q) ** 2
    square, linear = 0.5 * zone * f, 4.0 / 3.0 * zone**2 * g
    root = np.sqrt(linear**2 + 4.0 * square)
    outer = 2.0 / (linear + root)
    # both radii change with q so that the equation of the zone holds
    f_rate, g_rate = 2.0 * q * np.sin(2.0 * q), q * c
    outer_rate = -(0.5 * zone * f_rate * outer + 4.0 / 3.0 * zone**2 * g_rate) * outer / root
    inner, inner_rate = outer * c, outer_rate * c - outer * s
    displacement = inner**2 - 4.0 / 3.0 * zone * outer * s
    load = inner**3 - zone * outer**2 * (s * c + q)
    rate = 2.0 * inner * inner_rate - 4.0 / 3.0 * zone * (outer_rate * s + outer * c)
    return displacement, load, rate * (-4.0 / 3.0) * q / z, inner**2


@lru_cache(maxsize=64)
def _landmarks(zone: float) -> tuple[float, float, float, float]:
    """Fold and touch of a law: z at the end of the touching branch, displacements there and at the fold, pull-off."""
    touch = 2.0 / (4.0 / 3.0 * zone**2 * (HALF_PI - 1.0) + math.sqrt(_zone_square(zone)))
    fold = 8.0 * zone / (3.0 * math.pi)
    apart = 0.5 * touch**2 - fold * touch - 2.0 / (math.pi * zone)
    if fold < touch:  # detaches without touching; the pull is largest where the tip touches, or before
        end, least = Z_TOUCH, -0.5 * fold**2 - 2.0 / (math.pi * zone)
    else:
        end = _rising(lambda z: branch_at(z, zone)[2], Z_TOUCH)
        apart = least = float(branch_at(np.array(end), zone)[0])
    z = end * np.geomspace(1.0, 20.0, 4001)
    k = int(np.argmin(branch_at(z, zone)[1]))
    finer = np.linspace(z[max(k - 1, 0)], z[k + 1], 20_001)
    pull = -float(np.min(branch_at(finer, zone)[1]))
    return end, apart, least, pull


@lru_cache(maxsize=64)
def _detachment_energy(zone: float) -> float:
    """Integral of the load over the displacement from free surfaces to the fold, in units of adhesion."""
    fold = 8.0 * zone / (3.0 * math.pi)
    radius = min(fold, 2.0 / (4.0 / 3.0 * zone**2 * (HALF_PI - 1.0) + math.sqrt(_zone_square(zone))))
    apart = -HALF_PI * zone * (radius**4 / 4.0 - fold * radius**3 / 3.0)
    end = _landmarks(zone)[0]
    x, w = np.polynomial.legendre.leggauss(64)
    half = 0.5 * math.log(end / Z_TOUCH)  # 0 if it detaches before it touches
    z = Z_TOUCH * np.exp(half * (x + 1.0))
    _, load, rate, _ = branch_at(z, zone)
    return float(apart + half * (w * z * load * rate).sum())


def _zone_square(zone: float) -> float:
    """Discriminant of the zone's equation where the tip begins to touch."""
    return (4.0 / 3.0 * zone**2 * (HALF_PI - 1.0)) ** 2 + math.pi * zone


def _rising(function: object, low: float) -> float:
    """Where a function that is negative at first changes its sign, by bisection."""
    assert callable(function)
    high = 2.0 * low
    while function(np.array(high)) < 0.0:
        high *= 2.0
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if function(np.array(middle)) < 0.0 else (low, middle)
    return high


_ZONES = (1e-100, 1e10)
"""Beyond these ends no number of the law changes but the distance of joining: rigid spheres, and JKR to rounding."""


@register
@dataclass(frozen=True)
class Maugis(AsperityLaw):
    """Asperities between JKR's (large `zone`) and rigid spheres (small `zone`).

    Attributes
    ----------
    length : float
        ``(pi^2 dgamma^2 beta / K^2)^(1/3)`` in the law's unit of length, above 0.
    zone : float
        Maugis' lambda.
    """

    name: ClassVar[str] = "maugis"
    is_feature: ClassVar[bool] = True
    references: ClassVar[tuple[Reference, ...]] = (
        Reference(
            "maugis1992",
            ("D. Maugis",),
            "Adhesion of spheres: the JKR-DMT transition using a Dugdale model",
            1992,
            "Journal of Colloid and Interface Science",
            "150",
            "243-269",
            doi="10.1016/0021-9797(92)90285-T",
        ),
        Reference(
            "kim1998",
            ("K.-S. Kim", "R. M. McMeeking", "K. L. Johnson"),
            "Adhesion, slip, cohesive zones and energy fluxes for elastic spheres in contact",
            1998,
            "Journal of the Mechanics and Physics of Solids",
            "46",
            "243-266",
            doi="10.1016/S0022-5096(97)00070-7",
        ),
    )
    length: float
    zone: float

    @classmethod
    def of(cls, tip: Asperity, unit: float) -> AsperityLaw:
        """Return the law of a tip, lengths over `unit` [m]; without adhesion it is Hertz's."""
        if tip.stretch_limit == 0.0:
            return Hertz()
        length = tip.stretch_limit / 0.75 ** (1.0 / 3.0)
        distance = 9.0 * math.sqrt(3.0) / 16.0 * tip.interaction_range
        zone = 2.0 * length / (math.pi * distance)
        return cls(length / unit, min(max(zone, _ZONES[0]), _ZONES[1]))

    @cached_property
    def _marks(self) -> tuple[float, float, float, float]:
        return _landmarks(self.zone)

    @property
    def join(self) -> float:
        """Distance of joining, h0."""
        return self.length * 2.0 / (math.pi * self.zone)

    @property
    def detach(self) -> float:
        """Distance of detachment, at the fold."""
        return -self.length * self._marks[2]

    @property
    def pull_off(self) -> float:
        """Largest tension, between ``1.5 pi beta dgamma`` (JKR) and ``2 pi beta dgamma`` (Bradley)."""
        return self.length**1.5 * self._marks[3]

    @property
    def pieces(self) -> int:
        """Pieces of the load in v, where fold and touch may come close together."""
        return 12

    @property
    def touch(self) -> float:
        """Position at which a receding tip ceases to touch, if that is before detachment."""
        return self.length * self._marks[1]

    @property
    def detachment_energy(self) -> float:
        """Energy at the fold: the integral along the unstable branch, without contact first, from no zone at all on."""
        return self.length**2.5 * _detachment_energy(self.zone)

    def load(self, displacement: ArrayLike) -> Floats:
        """Load of an asperity on its stable branch; see `AsperityLaw.load`."""
        delta = np.asarray(displacement, dtype=np.float64) / self.length
        touches = branch_at(self._parameter(delta), self.zone)[1]
        apart = -HALF_PI * self.zone * self._zone_radius(delta) ** 2
        load = np.where(delta >= self._marks[1], touches, apart)
        return self.length**1.5 * np.where(delta < self._marks[2], 0.0, load)

    def nodes(self, low: ArrayLike, high: ArrayLike, x: Floats, w: Floats) -> tuple[Floats, Floats]:
        """Lay a rule out in the parameter of either branch, one after the other; see `AsperityLaw.nodes`."""
        ends = np.stack(np.broadcast_arrays(low, high)) / self.length
        z = self._parameter(ends)[..., None]
        half = 0.5 * (z[1] - z[0])
        displacement, load, rate, _ = branch_at(z[0] + half * (x + 1.0), self.zone)
        weight = half * w * rate * load
        if self._marks[1] > self._marks[2]:
            radius = self._zone_radius(np.minimum(ends, self._marks[1]))[..., None]
            half = 0.5 * (radius[1] - radius[0])
            outer = radius[0] + half * (x + 1.0)
            fold = 8.0 * self.zone / (3.0 * math.pi)
            apart = 0.5 * (outer - fold) ** 2 + self._marks[2]
            pull = half * w * (outer - fold) * (-HALF_PI * self.zone) * outer**2
            displacement, weight = (
                np.concatenate([apart, displacement], -1),
                np.concatenate([pull, weight], -1),
            )
        return displacement * self.length, weight * self.length**2.5

    def area(self, displacement: ArrayLike) -> Floats:
        """Contact area within the zone, where the tip touches; see `AsperityLaw.area`."""
        delta = np.asarray(displacement, dtype=np.float64) / self.length
        area = branch_at(self._parameter(delta), self.zone)[3]
        return self.length * np.where(delta >= self._marks[1], area, 0.0)

    def area_nodes(self, low: ArrayLike, high: ArrayLike, x: Floats, w: Floats) -> tuple[Floats, Floats]:
        """Lay a rule out in the parameter of tips that touch; see `AsperityLaw.area_nodes`."""
        z = self._parameter(np.stack(np.broadcast_arrays(low, high)) / self.length)[..., None]
        half = 0.5 * (z[1] - z[0])
        displacement, _, rate, area = branch_at(z[0] + half * (x + 1.0), self.zone)
        return displacement * self.length, half * w * rate * area * self.length**2

    def _zone_radius(self, delta: Floats) -> Floats:
        """C of a tip that does not touch, at a displacement."""
        fold = 8.0 * self.zone / (3.0 * math.pi)
        return fold + np.sqrt(2.0 * np.maximum(delta - (-0.5 * fold**2 - 2.0 / (math.pi * self.zone)), 0.0))

    def _parameter(self, delta: Floats) -> Floats:
        """Parameter z of a tip that touches, at a displacement; what is below the branch counts as its end."""
        end = self._marks[0]
        low, high = np.full(delta.shape, end), np.full(delta.shape, 2.0 * end)
        most = float(np.max(delta, initial=0.0))
        while float(branch_at(np.array(high.flat[0] if high.size else end), self.zone)[0]) < most:
            high *= 2.0
        for _ in range(54):
            middle = 0.5 * (low + high)
            below = branch_at(middle, self.zone)[0] < delta
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return np.where(delta <= self._marks[1], end, high)
