"""Asperities without adhesion (Hertz).

References
----------
K. L. Johnson, Contact Mechanics, Cambridge University Press (1985), section 4.2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from gearidae.arrays import Floats
from gearidae.asperities.base import AsperityLaw
from gearidae.asperities.registry import register
from gearidae.asperities.tip import Asperity
from gearidae.references import JOHNSON_1985, Reference


@register
@dataclass(frozen=True)
class Hertz(AsperityLaw):
    """Elastic spheres that do not adhere: ``P = displacement^1.5`` in compression, nothing else."""

    name: ClassVar[str] = "hertz"
    references: ClassVar[tuple[Reference, ...]] = (JOHNSON_1985,)

    @classmethod
    def of(cls, tip: Asperity, unit: float) -> Hertz:
        """Return the law, the same for all tips."""
        return cls()

    @property
    def detach(self) -> float:
        """Distance of detachment: none."""
        return 0.0

    @property
    def pull_off(self) -> float:
        """Largest tension: none."""
        return 0.0

    def load(self, displacement: ArrayLike) -> Floats:
        """Load of an asperity, ``displacement^1.5``; see `AsperityLaw.load`."""
        return np.asarray(np.maximum(displacement, 0.0) ** 1.5)

    def area(self, displacement: ArrayLike) -> Floats:
        """Contact area, the displacement in compression; see `AsperityLaw.area`."""
        return np.asarray(np.maximum(np.asarray(displacement, dtype=np.float64), 0.0))
