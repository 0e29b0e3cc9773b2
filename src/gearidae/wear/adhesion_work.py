"""Loss by dissipated energy: the energy that adhesion takes on coated flank removes the coating."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearidae.arrays import Floats
from gearidae.references import FOUVRY_2003, Reference
from gearidae.wear.base import Exposure, LossLaw, parameter
from gearidae.wear.registry import register_loss


@register_loss
@dataclass(frozen=True)
class AdhesionWork(LossLaw):
    r"""Energy per area that leaves 1/e of a coating: :math:`df/dN = -f\,w / Q`, w the adhesion work per area."""

    name: ClassVar[str] = "adhesion_work"
    source: ClassVar[str] = (
        f"energy description of wear, {FOUVRY_2003.source}; "
        "that of monolayers is not known: give it, or fit it to a life"
    )
    references: ClassVar[tuple[Reference, ...]] = (FOUVRY_2003,)

    energy: float = parameter("J/m^2", "adhesion work per area that leaves 1/e of the coating, Q", above=0.0)

    def rate(self, fraction: Floats, exposure: Exposure) -> Floats:
        """See `LossLaw.rate`."""
        return -fraction * exposure.adhesion_work / self.energy
