r"""Contact area of one asperity, as a law of its own: what its shear strength acts on.

In the units of `gearidae.asperities.base` areas are in units of :math:`\pi\beta l`, so that Hertz's is the
displacement. A JKR asperity has the contact radius

.. math:: a^2 = \beta\,\delta_c\,12^{1/3}\,s^4

with s of `gearidae.asperities.jkr`. Area and load of one asperity have the same branches, ends and tables.

References
----------
K. L. Johnson, Contact Mechanics, Cambridge University Press (1985), sections 4.2 and 5.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from gearidae.arrays import Floats
from gearidae.asperities.base import AsperityLaw
from gearidae.asperities.jkr import Jkr, jkr_root
from gearidae.asperities.tip import Asperity

AREAS = ("jkr", "dmt", "hertz")
"""Laws whose contact area is known."""


@dataclass(frozen=True)
class ContactArea(AsperityLaw):
    """Contact area of an asperity of another law.

    Attributes
    ----------
    law : AsperityLaw
        One of `AREAS`.
    """

    name: ClassVar[str] = "area"
    law: AsperityLaw

    @classmethod
    def of(cls, tip: Asperity, unit: float) -> ContactArea:
        """Return the area of a JKR tip, lengths over `unit` [m]."""
        return cls(Jkr.of(tip, unit))

    @property
    def detach(self) -> float:
        """Distance of detachment."""
        return self.law.detach

    @property
    def join(self) -> float:
        """Distance of joining."""
        return self.law.join

    @property
    def pieces(self) -> int:
        """Pieces of the stretched branch."""
        return self.law.pieces

    @property
    def pull_off(self) -> float:
        """Largest tension: an area has none."""
        return 0.0

    def load(self, displacement: ArrayLike) -> Floats:
        """Contact area over ``pi beta l``; see `AsperityLaw.load`."""
        delta = np.asarray(displacement, dtype=np.float64)
        if not isinstance(self.law, Jkr):
            return np.asarray(np.maximum(delta, 0.0))
        limit = self.law.limit
        area = limit * 12.0 ** (1.0 / 3.0) * jkr_root(delta / limit) ** 4
        return np.where(delta < -limit, 0.0, area)
