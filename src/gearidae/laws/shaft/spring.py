"""A torsional spring between a shaft and the ground, with a damper beside it and a play on both sides of zero.

Beyond the play a it resists with ``k (angle -+ a) + c speed``, within it with nothing: a stop, a flexure or a tether of
the shaft. It is in touch by the angle alone, and lets go where the angle comes back to the play.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from gearidae.compiled import compiled
from gearidae.formulas.quadrature import Ends, integral_of_square
from gearidae.laws.law import DRIVE, Coefficient, Key, Loss, Memory, Sample, ShaftEvent, ShaftLaw, number_of

if TYPE_CHECKING:
    from gearidae.engine.model.state import Model

_TOUCHES: Final = ShaftEvent("spring_contact", 15, 16)
_LETS_GO: Final = ShaftEvent("spring_release", 17, 18)


@compiled
def _position(angle: float, play: float) -> int:
    """Side of the play on which an angle is, 0 within."""
    return 1 if angle > play else -1 if angle < -play else 0


@compiled
def _side(m: Model, shaft: int, angle: float) -> int:
    """Side on which the spring is in touch, within a step the one at its beginning, so that the force has no corner."""
    if m.work.elsewhere != 0:
        return _position(angle, m.scene.torque[shaft].spring_play)
    return int(m.state.shaft[shaft].spring_side)


@compiled
def _in_touch(m: Model, shaft: int, angle: float) -> bool:
    return bool(m.scene.torque[shaft].spring_play == 0.0 or _side(m, shaft, angle) != 0)


@compiled
def _force(m: Model, shaft: int, t: float, angle: float, speed: float, value: float) -> float:
    if _in_touch(m, shaft, angle):
        torque = m.scene.torque[shaft]
        deflection = angle - _side(m, shaft, angle) * torque.spring_play
        value -= torque.spring * deflection + torque.spring_damping * speed
    return value


@compiled
def _by_speed(m: Model, shaft: int, angle: float, speed: float, value: float) -> float:
    if _in_touch(m, shaft, angle):
        value -= m.scene.torque[shaft].spring_damping
    return value


@compiled
def _by_angle(m: Model, shaft: int, angle: float, speed: float, value: float) -> float:
    if _in_touch(m, shaft, angle):
        value -= m.scene.torque[shaft].spring
    return value


@compiled
def _energy(m: Model, shaft: int, angle: float, value: float) -> float:
    torque = m.scene.torque[shaft]
    deflection = max(abs(angle) - torque.spring_play, 0.0)
    return value + 0.5 * torque.spring * deflection * deflection / torque.angle_unit


@compiled
def _loss(m: Model, shaft: int, h: float, angle: float, travel: float, speeds: Ends, value: float) -> float:
    if _in_touch(m, shaft, angle):
        damping = m.scene.torque[shaft].spring_damping
        square, error = integral_of_square(h, travel, speeds)
        value += damping * square
        m.state.energy.spring_loss += damping * square
        m.state.energy.loss_error += damping * error
    return value


@compiled
def _guard(m: Model, shaft: int, angle: float, speed: float, value: float) -> float:
    play = m.scene.torque[shaft].spring_play
    if play == 0.0:
        return value
    side = m.state.shaft[shaft].spring_side
    return min(value, side * angle - play if side != 0 else play - abs(angle))


@compiled
def _switch(m: Model, shaft: int, angle: float, speed: float, value: int) -> int:
    play, memory = m.scene.torque[shaft].spring_play, m.state.shaft[shaft]
    side = _position(angle, play) if play > 0.0 else 0
    if value >= 0 or side == memory.spring_side:
        return value
    memory.spring_side = side
    if shaft == DRIVE:
        return _TOUCHES_PINION if side != 0 else _LETS_GO_PINION
    return _TOUCHES_GEAR if side != 0 else _LETS_GO_GEAR


_TOUCHES_PINION, _TOUCHES_GEAR = _TOUCHES.numbers
_LETS_GO_PINION, _LETS_GO_GEAR = _LETS_GO.numbers


def _holds(scene: Any, shaft: int) -> bool:
    return number_of(scene, shaft, "spring") > 0.0


SPRING = ShaftLaw(
    "spring with play",
    coefficients=(
        Coefficient(  # force per angle [F/rad]
            "spring",
            0,
            Key(
                "N m/rad",
                "stiffness of a torsional spring that ties the {shaft} to the ground",
                at_most=1e3,
                least=1e-30,
                example=1e-7,
            ),
        ),
        Coefficient(  # force per speed [F tau/sigma]
            "spring_damping",
            1,
            Key(
                "N m s/rad",
                "viscous damping beside that spring, where it is in touch",
                at_most=1e3,
                least=1e-40,
                example=3e-14,
            ),
        ),
        Coefficient(  # [rad]
            "spring_play",
            None,
            Key(
                "rad",
                "angle that the {shaft} turns either way before the spring is in touch",
                at_most=1e6,
                least=1e-12,
                example=5e-4,
            ),
        ),
    ),
    memory=(Memory("spring_side", "side on which the spring is in touch, 0 within its play", -1, 1),),
    losses=(Loss("spring_loss", "energy lost to dampers of the shafts' springs"),),
    events=(_TOUCHES, _LETS_GO),
    sample=Sample("spring_torque", "torque of the spring on the {shaft}"),
    force=_force,
    by_speed=_by_speed,
    by_angle=_by_angle,
    energy=_energy,
    loss=_loss,
    guard=_guard,
    switch=_switch,
    holds=_holds,
)
