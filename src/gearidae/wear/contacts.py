"""Loss by asperity contacts: each contact removes some of the coating with a probability."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearidae.arrays import Floats
from gearidae.wear.base import Exposure, LossLaw, parameter
from gearidae.wear.registry import register_loss


@register_loss
@dataclass(frozen=True)
class Contacts(LossLaw):
    r"""Area of coating that a contact removes on average: :math:`df/dN = -f\,a\,n_a`, n_a contacts per area."""

    name: ClassVar[str] = "contacts"
    source: ClassVar[str] = (
        "mechanochemical attrition, T. D. B. Jacobs and R. W. Carpick, Nature Nanotechnology 8 (2013) 108-112, "
        "doi:10.1038/nnano.2012.255; the area is that of a contact times the probability that it removes "
        "molecules, which is not known for monolayers in repeated impacts: give it, or fit it to a life"
    )

    area: float = parameter("m^2", "area removed by a contact on average", at_most=1.0)

    def rate(self, fraction: Floats, exposure: Exposure) -> Floats:
        """See `LossLaw.rate`."""
        return -fraction * self.area * exposure.contacts
