"""Loss by friction: Archard's law with the energy that friction takes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.references import FOUVRY_2003, Reference
from gearidae.scene.friction import friction_values
from gearidae.wear.base import Exposure, parameter
from gearidae.wear.registry import register_loss
from gearidae.wear.sliding_work import SlidingWork

if TYPE_CHECKING:
    from gearidae.scene.scene import Scene


@register_loss
@dataclass(frozen=True)
class FrictionWork(SlidingWork):
    r"""Coverage lost in proportion to the work of friction: :math:`df/dN = -k\,w_f` as long as there is a coating."""

    name: ClassVar[str] = "friction_work"
    source: ClassVar[str] = (
        f"energy description of wear, {FOUVRY_2003.source}; the coefficient of monolayers has to be measured"
    )
    references: ClassVar[tuple[Reference, ...]] = (FOUVRY_2003,)

    coefficient: float = parameter("m^2/J", "coverage lost for each unit of work of friction per area, k")

    def load(self, exposure: Exposure) -> Floats:
        """See `SlidingWork.load`."""
        return exposure.friction_work

    def check(self, scene: Scene) -> None:
        """See `LossLaw.check`."""
        if not any(friction_values(scene).values()):
            raise SceneError(
                "contact.friction", scene.contact.friction, f"must be above 0 for the loss law {self.name}"
            )
