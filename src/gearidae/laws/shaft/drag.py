"""Quadratic and viscous drag: torques against the turning (Teodorescu et al. 2009, Eq. 2)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gearidae.compiled import compiled
from gearidae.formulas.quadrature import Ends, integral_of_cube, integral_of_square
from gearidae.laws.law import LOAD, Coefficient, ShaftLaw

if TYPE_CHECKING:
    from gearidae.engine.model.state import Model


@compiled(inline=True)
def _force(m: Model, shaft: int, t: float, angle: float, speed: float, value: float) -> float:
    value -= m.scene.torque[shaft].drag * speed * abs(speed)
    return value - m.scene.torque[shaft].viscous * speed


@compiled(inline=True)
def _by_speed(m: Model, shaft: int, angle: float, speed: float, value: float) -> float:
    return value - (2.0 * m.scene.torque[shaft].drag * abs(speed) + m.scene.torque[shaft].viscous)


@compiled(inline=True)
def _loss(m: Model, shaft: int, h: float, angle: float, travel: float, speeds: Ends, value: float) -> float:
    e, torque = m.state.energy, m.scene.torque[shaft]
    if torque.drag != 0.0:
        cube, error = integral_of_cube(h, travel, speeds)
        value += torque.drag * cube
        e.drag_loss += torque.drag * cube
        e.loss_error += torque.drag * error
    if torque.viscous != 0.0:
        square, error = integral_of_square(h, travel, speeds)
        value += torque.viscous * square
        e.drag_loss += torque.viscous * square
        e.loss_error += torque.viscous * error
    return value


def _slowing(scene: Any, shaft: int, value: tuple[float, float]) -> tuple[float, float]:
    return (value[0] + scene.load.viscous, value[1] + scene.load.drag) if shaft == LOAD else value


DRAG = ShaftLaw(
    "drag",
    coefficients=(
        Coefficient("drag", 2),  # force per squared speed [F tau^2/sigma^2]
        Coefficient("viscous", 1),  # force per speed [F tau/sigma]
    ),
    force=_force,
    by_speed=_by_speed,
    loss=_loss,
    slowing=_slowing,
)
