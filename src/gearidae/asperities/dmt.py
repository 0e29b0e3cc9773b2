"""Stiff asperities whose adhesion acts around the contact (Derjaguin, Muller and Toporov).

References
----------
B. V. Derjaguin, V. M. Muller, Yu. P. Toporov, J. Colloid Interface Sci. 53 (1975) 314-326,
doi:10.1016/0021-9797(75)90018-1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from gearidae.arrays import Floats
from gearidae.asperities.base import AsperityLaw
from gearidae.asperities.registry import register
from gearidae.asperities.tip import Asperity
from gearidae.references import Reference


@register
@dataclass(frozen=True)
class Dmt(AsperityLaw):
    """Hertz's load less a constant pull while the asperity touches; no stretch, no loss.

    Attributes
    ----------
    jkr_limit : float
        Stretch limit of a JKR asperity with the same tip: a measure of adhesion relative to stiffness.
    """

    name: ClassVar[str] = "dmt"
    references: ClassVar[tuple[Reference, ...]] = (
        Reference(
            "derjaguin1975",
            ("B. V. Derjaguin", "V. M. Muller", "Yu. P. Toporov"),
            "Effect of contact deformations on the adhesion of particles",
            1975,
            "Journal of Colloid and Interface Science",
            "53",
            "314-326",
            doi="10.1016/0021-9797(75)90018-1",
        ),
    )
    jkr_limit: float

    @classmethod
    def of(cls, tip: Asperity, unit: float) -> Dmt:
        """Return the law of a tip, lengths over `unit` [m]."""
        return cls(tip.stretch_limit / unit)

    @property
    def detach(self) -> float:
        """Distance of detachment: none."""
        return 0.0

    @property
    def pull_off(self) -> float:
        """Largest tension, ``2 pi beta dgamma``: 4/3 of JKR's."""
        return 4.0 / 3.0 * math.sqrt(3.0) * self.jkr_limit**1.5

    def load(self, displacement: ArrayLike) -> Floats:
        """Load of an asperity, ``displacement^1.5 - pull_off`` while it touches; see `AsperityLaw.load`."""
        delta = np.asarray(displacement, dtype=np.float64)
        return np.asarray(np.maximum(delta, 0.0) ** 1.5 - np.where(delta >= 0.0, self.pull_off, 0.0))

    def area(self, displacement: ArrayLike) -> Floats:
        """Contact area of a Hertzian contact; see `AsperityLaw.area`."""
        return np.asarray(np.maximum(np.asarray(displacement, dtype=np.float64), 0.0))
