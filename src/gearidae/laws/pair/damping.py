"""Viscous damping of the transmission error: of the whole mesh, whose force acts without contact, too."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gearidae.compiled import compiled
from gearidae.formulas.quadrature import Ends, integral_of_square
from gearidae.laws.law import Key, Loss
from gearidae.laws.pair_law import MeshConstant, PairLaw

if TYPE_CHECKING:
    from gearidae.engine.model.state import Model


@compiled(inline=True)
def _force(m: Model, rate: float, value: float) -> float:
    return value + m.scene.damping * rate


@compiled(inline=True)
def _by_rate(m: Model, value: float) -> float:
    return value + m.scene.damping


@compiled(inline=True)
def _loss(m: Model, h: float, travel: float, rates: Ends, value: tuple[float, float]) -> tuple[float, float]:
    square, error = integral_of_square(h, travel, rates)
    return value[0] + m.scene.damping * square, value[1] + m.scene.damping * error


def _acts(scene: Any) -> bool:
    return bool(scene.damping != 0.0)


DAMPING = PairLaw(
    name="mesh damping",
    acts=_acts,
    constants=(
        MeshConstant(  # force per rate of the transmission error [F tau/sigma]
            "damping",
            Key(
                "N s/m",
                "viscous damping of the transmission error; it acts without contact, too",
                at_most=1e9,
                example=7e-6,
            ),
            force=1,
            length=-1,
            time=1,
        ),
    ),
    losses=(Loss("damping_loss", "energy lost to the mesh's viscous damping", since=""),),
    mesh_force=_force,
    mesh_by_rate=_by_rate,
    mesh_loss=_loss,
)
