r"""Contact area of one asperity, as a law of its own: what its shear strength acts on.

In the units of `gearidae.asperities.base` areas are in units of :math:`\pi\beta l`, so that Hertz's is the
displacement. A JKR asperity has the contact radius

.. math:: a^2 = \beta\,\delta_c\,12^{1/3}\,s^4

with s of `gearidae.asperities.jkr`. Area and load of one asperity have the same branches, ends and tables. Each law
says its area (`gearidae.asperities.AsperityLaw.area`).

References
----------
K. L. Johnson, Contact Mechanics, Cambridge University Press (1985), sections 4.2 and 5.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from numpy.typing import ArrayLike

from gearidae.arrays import Floats
from gearidae.asperities.base import AsperityLaw
from gearidae.asperities.jkr import Jkr
from gearidae.asperities.tip import Asperity


@dataclass(frozen=True)
class ContactArea(AsperityLaw):
    """Contact area of an asperity of another law.

    Attributes
    ----------
    law : AsperityLaw
        One that has an area, see `gearidae.asperities.AsperityLaw.has_area`.
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
    def touch(self) -> float:
        """Displacement of a kink, where the tip begins to touch."""
        return self.law.touch

    @property
    def pull_off(self) -> float:
        """Largest tension: an area has none."""
        return 0.0

    def load(self, displacement: ArrayLike) -> Floats:
        """Contact area over ``pi beta l``; see `AsperityLaw.area`."""
        return self.law.area(displacement)

    def nodes(self, low: ArrayLike, high: ArrayLike, x: Floats, w: Floats) -> tuple[Floats, Floats]:
        """Lay a quadrature rule of the area; see `AsperityLaw.area_nodes`."""
        return self.law.area_nodes(low, high, x, w)
