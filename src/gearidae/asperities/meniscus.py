r"""Asperities in humid air: a meniscus of water pulls on each that is hydrophilic, from a distance.

Water condenses in gaps that are narrower than two Kelvin radii,

.. math::

    r_K = \frac{\gamma V_m}{R T\,|\ln h|}, \qquad d_m = 2 r_K \cos\theta,

at the relative humidity h and the contact angle theta. A meniscus around a tip of radius beta pulls with
:math:`F_0 = 4\pi\beta\gamma\cos\theta` while the tip touches, and linearly less out to the distance :math:`d_m`, where
it breaks:

.. math::

    P(\Delta) = \tfrac43 E^* \sqrt\beta\,\Delta_+^{3/2} - F_0\,\Bigl(1 - \frac{(-\Delta)_+}{d_m}\Bigr).

An approaching tip gets its meniscus at the distance :math:`s\,d_m`, with s the share of the reachable gaps that are
bridged; that loses :math:`F_0 d_m (1 - s)^2/2`. Where the contact angle is 90 degrees or more there is no water: the
law is that of DMT, with the dry pull of the surface.

References
----------
J. N. Israelachvili, Intermolecular and Surface Forces, 3rd ed., Academic Press (2011), sections 17.11 and 17.12.
F. M. Orr, L. E. Scriven, A. P. Rivas, J. Fluid Mech. 67 (1975) 723-742, doi:10.1017/S0022112075000572.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import ArrayLike

from gearidae.arrays import Floats
from gearidae.asperities.base import AsperityLaw, CoatedKey, SurfaceKey, Validity
from gearidae.asperities.dmt import Dmt
from gearidae.asperities.registry import register
from gearidae.asperities.tip import Asperity
from gearidae.references import Reference

TENSION: Final = 0.072
"""Surface tension of water [N/m]."""
MOLAR_VOLUME: Final = 1.807e-5
"""Of water [m^3/mol]."""
GAS_CONSTANT: Final = 8.314462618
"""[J/(mol K)]"""


def kelvin_radius(humidity: float, temperature: float = 298.15) -> float:
    """Radius of a meniscus that is in equilibrium with humid air.

    Parameters
    ----------
    humidity : float
        Relative humidity, between 0 and 1.
    temperature : float, optional
        [K].

    Returns
    -------
    float
        ``gamma V_m / (R T |ln h|)`` [m].
    """
    return TENSION * MOLAR_VOLUME / (GAS_CONSTANT * temperature * abs(math.log(humidity)))


def meniscus_reach(surface: Any) -> float:
    """Distance at which a meniscus on a surface breaks, ``2 r_K cos(theta)`` [m]; 0 where it carries no water."""
    if getattr(surface, "humidity", None) is None:
        return 0.0
    cosine = math.cos(surface.contact_angle)
    wets = cosine > 1e-9  # 90 degrees, to rounding, is dry
    return 2.0 * kelvin_radius(surface.humidity, surface.temperature) * cosine if wets else 0.0


def _angle_between(coated: float, bare: float) -> float:
    """Contact angle that draws a meniscus between unlike surfaces: by the mean of their cosines."""
    return math.acos(0.5 * (math.cos(coated) + math.cos(bare)))


@register
@dataclass(frozen=True)
class Meniscus(AsperityLaw):
    """Hertz's load less the pull of a meniscus, which acts from a distance and breaks farther out than it forms.

    Attributes
    ----------
    pull : float
        Pull of the meniscus on a tip that touches, F0, in the law's unit of load.
    reach : float
        Distance at which the meniscus breaks, d_m, in the law's unit of length.
    bridged : float
        Distance at which it forms, over that [1].
    """

    name: ClassVar[str] = "meniscus"
    references: ClassVar[tuple[Reference, ...]] = (
        Reference(
            "israelachvili2011",
            ("J. N. Israelachvili",),
            "Intermolecular and Surface Forces, 3rd edition",
            2011,
            publisher="Academic Press",
        ),
        Reference(
            "orr1975",
            ("F. M. Orr", "L. E. Scriven", "A. P. Rivas"),
            "Pendular rings between solids: meniscus properties and capillary force",
            1975,
            "Journal of Fluid Mechanics",
            "67",
            "723-742",
            doi="10.1017/S0022112075000572",
        ),
    )
    needs: ClassVar[tuple[str, ...]] = ("humidity",)
    keys: ClassVar[tuple[SurfaceKey, ...]] = (
        SurfaceKey(
            name="humidity",
            unit="1",
            description="relative humidity of the air, h; for meniscus asperities",
            default=None,
            at_least=0.01,
            at_most=0.99,
        ),
        SurfaceKey(
            name="contact_angle",
            unit="rad",
            description="contact angle of water on the bare flank, which is dry from 90 deg on; "
            "for meniscus asperities",
            default=0.0,
            at_least=0,
            at_most=math.pi,
            coated=CoatedKey(
                default=math.radians(110.0),
                description="contact angle of water on the monolayer; for meniscus asperities",
                mixed=_angle_between,
            ),
        ),
        SurfaceKey(
            name="bridged",
            unit="1",
            description="distance at which a meniscus forms over that at which it breaks; for meniscus asperities",
            default=1.0,
            at_least=0,
            at_most=1,
        ),
        SurfaceKey(
            name="temperature",
            unit="K",
            description="temperature of the air; for meniscus asperities",
            default=298.15,
            at_least=200,
            at_most=650,
        ),
    )
    is_feature: ClassVar[bool] = True
    not_with: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "elastic bodies": (
                "menisci pull across the gap and would deflect the bodies outside the contacts, where no deflection is"
                " solved for"
            ),
            "attraction": (
                "the water would attract twice: what a Hamaker constant pulls across the gap is part of the pull of a"
                " meniscus"
            ),
        }
    )
    pull: float
    reach: float
    bridged: float

    @classmethod
    def of(cls, tip: Asperity, unit: float) -> AsperityLaw:
        """Return the law of a tip, lengths over `unit` [m]; that of DMT where there is no water."""
        reach = 0.0 if tip.surface is None else meniscus_reach(tip.surface)
        if reach == 0.0:
            return Dmt.of(tip, unit)
        force = 4.0 * math.pi * tip.radius * TENSION * math.cos(tip.surface.contact_angle)
        return cls(force / (tip.hertz_factor * unit**1.5), reach / unit, tip.surface.bridged)

    @classmethod
    def validity(cls, surface: Any, gap: float) -> Validity | None:
        """Count menisci within the wetted circle of one: where they merge, no law of one asperity holds."""
        reach = meniscus_reach(surface)
        if reach == 0.0:
            return None
        # the neck of a meniscus around a tip that touches meets the plane where the sphere is its reach away
        area = 2.0 * math.pi * surface.asperity_radius * reach
        share = 0.5 * math.erfc((gap - reach) / (math.sqrt(2.0) * surface.roughness))
        return Validity(
            "menisci",
            "menisci within the circle of one",
            surface.asperity_density * area * share,
            "menisci stay apart",
            "menisci merge: the pull is that of a film, not of single asperities",
        )

    @property
    def join(self) -> float:
        """Distance at which the meniscus forms."""
        return self.bridged * self.reach

    @property
    def detach(self) -> float:
        """Distance at which it breaks."""
        return self.reach

    @property
    def pull_off(self) -> float:
        """Largest tension, where the tip just touches."""
        return self.pull

    @property
    def touch(self) -> float:
        """Where the load of Hertz begins."""
        return 0.0

    def load(self, displacement: ArrayLike) -> Floats:
        """Load of an asperity with its meniscus; see `AsperityLaw.load`."""
        delta = np.asarray(displacement, dtype=np.float64)
        pull = self.pull * (1.0 - np.maximum(-delta, 0.0) / self.reach)
        return np.asarray(np.maximum(delta, 0.0) ** 1.5 - np.where(delta < -self.reach, 0.0, pull))

    def nodes(self, low: ArrayLike, high: ArrayLike, x: Floats, w: Floats) -> tuple[Floats, Floats]:
        """Lay a rule out on either side of touching, above it in ``sqrt(displacement)``; see `AsperityLaw.nodes`."""
        ends = np.stack(np.broadcast_arrays(low, high)).astype(np.float64)[..., None]
        apart = np.minimum(ends, 0.0)
        half = 0.5 * (apart[1] - apart[0])
        close, measure = _touching_nodes(ends, x, w)
        displacement = np.concatenate([apart[0] + half * (x + 1.0), close], axis=-1)
        return displacement, np.concatenate([half * w, measure], axis=-1) * self.load(displacement)

    def energy(self, displacement: ArrayLike) -> Floats:
        """Energy stored from breaking on: ``-F0 (d_m + delta)^2 / (2 d_m)`` before the tip touches."""
        delta = np.asarray(displacement, dtype=np.float64)
        apart = np.clip(self.reach + delta, 0.0, self.reach)
        close = np.maximum(delta, 0.0)
        return np.asarray(0.4 * close**2.5 - self.pull * (0.5 * apart**2 / self.reach + close))

    def area(self, displacement: ArrayLike) -> Floats:
        """Contact area of the solid, a Hertzian contact; see `AsperityLaw.area`."""
        return np.asarray(np.maximum(np.asarray(displacement, dtype=np.float64), 0.0))

    def area_nodes(self, low: ArrayLike, high: ArrayLike, x: Floats, w: Floats) -> tuple[Floats, Floats]:
        """Lay a rule out where the tip touches; see `AsperityLaw.area_nodes`."""
        ends = np.stack(np.broadcast_arrays(low, high)).astype(np.float64)[..., None]
        displacement, measure = _touching_nodes(ends, x, w)
        return displacement, measure * self.area(displacement)


def _touching_nodes(ends: Floats, x: Floats, w: Floats) -> tuple[Floats, Floats]:
    """Nodes and weights of a rule between two displacements of tips that touch, in ``sqrt(displacement)``."""
    close = np.sqrt(np.maximum(ends, 0.0))
    half = 0.5 * (close[1] - close[0])
    root = close[0] + half * (x + 1.0)
    return root**2, 2.0 * root * half * w
