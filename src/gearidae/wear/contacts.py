"""Loss by asperity contacts: each contact removes some of the coating with a probability."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearidae.arrays import Floats
from gearidae.references import Reference
from gearidae.wear.base import Exposure, LossLaw, parameter
from gearidae.wear.registry import register_loss

_JACOBS = Reference(
    "jacobs2013",
    ("T. D. B. Jacobs", "R. W. Carpick"),
    "Nanoscale wear as a stress-assisted chemical reaction",
    2013,
    "Nature Nanotechnology",
    "8",
    "108-112",
    doi="10.1038/nnano.2012.255",
)


@register_loss
@dataclass(frozen=True)
class Contacts(LossLaw):
    r"""Area of coating that a contact removes on average: :math:`df/dN = -f\,a\,n_a`, n_a contacts per area."""

    name: ClassVar[str] = "contacts"
    references: ClassVar[tuple[Reference, ...]] = (_JACOBS,)
    source: ClassVar[str] = (
        f"mechanochemical attrition, {_JACOBS.source}; the area is that of a contact times the probability that it "
        "removes molecules, which is not known for monolayers in repeated impacts: give it, or fit it to a life"
    )

    area: float = parameter("m^2", "area removed by a contact on average", at_most=1.0)

    def rate(self, fraction: Floats, exposure: Exposure) -> Floats:
        """See `LossLaw.rate`."""
        return -fraction * self.area * exposure.contacts
