"""Loss by sliding: Archard's law on coverage."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearidae.arrays import Floats
from gearidae.references import ARCHARD_1953, Reference
from gearidae.wear.base import Exposure, LossLaw, parameter
from gearidae.wear.registry import register_loss


@register_loss
@dataclass(frozen=True)
class SlidingWork(LossLaw):
    r"""Coverage lost in proportion to the sliding work: :math:`df/dN = -k\,w_s` as long as there is a coating.

    Archard's law removes a depth ``K w_s / H``; of a coating of thickness t this is the share ``k = K / (H t)`` for
    each unit of work per area, with the wear coefficient K and the hardness H.
    """

    name: ClassVar[str] = "sliding_work"
    source: ClassVar[str] = f"{ARCHARD_1953.source}; K/H of monolayers has to be measured"
    references: ClassVar[tuple[Reference, ...]] = (ARCHARD_1953,)

    coefficient: float = parameter("m^2/J", "coverage lost for each unit of sliding work per area, k")

    def load(self, exposure: Exposure) -> Floats:
        """Work per area that the loss is in proportion to [J/m^2]."""
        return exposure.sliding_work

    def rate(self, fraction: Floats, exposure: Exposure) -> Floats:
        """See `LossLaw.rate`."""
        return np.asarray(np.where(fraction > 0.0, -self.coefficient * self.load(exposure), 0.0))
