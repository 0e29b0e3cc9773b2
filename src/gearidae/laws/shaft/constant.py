"""The constant part of a torque."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.compiled import compiled
from gearidae.laws.law import REAL, ShaftLaw

if TYPE_CHECKING:
    from gearidae.engine.model.state import Model


@compiled(inline=True)
def _force(m: Model, shaft: int, t: float, angle: float, speed: float, value: float) -> float:
    return value + m.scene.torque[shaft].constant


CONSTANT = ShaftLaw(
    "constant",
    drives=True,
    fields=(("constant", REAL),),  # over the base radius [F]
    force=_force,
)
