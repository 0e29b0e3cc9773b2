r"""Friction of joints that grows with the time at rest and is forgotten by sliding: rate and state.

The contacts of a joint have an age :math:`\theta`, by which its coefficient grows. The law is Dieterich's (J. Geophys.
Res. 84, 1979, doi:10.1029/JB084iB05p02161) with an exponential approach in the place of his logarithm:

.. math::

    \mu = \mu_d + \Delta\mu\,(1 - e^{-\theta/\tau}), \qquad \dot\theta = 1 - |v|\,\theta/D_c .

At rest the age grows as the time, steady sliding has :math:`\theta = D_c/v`. Where the motion is known the age is, too:
with the way s since the last accepted time

.. math::

    \theta(t) = \theta_0\,e^{-s(t)/D_c} + \int_{t_0}^{t} e^{-(s(t) - s(t'))/D_c}\,\mathrm{d}t' .

So an age is no state of the solver, whose equations stay the four of the motion, but a function of the state and of
what was at the last accepted time, as the turning gap of a pair is. The way of a joint is a state already; between both
ends of a step it is the cubic with their speeds, and the exponentials are integrated by Lobatto's rule. An error of
order five in a step is left, below that of the motion, and none at constant speed; no step is made shorter for it.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import FRICTION
from gearidae.engine.model.record_types import GEAR_HUB, PIN, PINION_HUB
from gearidae.engine.model.state import PHASE, Floats, Model, U, W
from gearidae.engine.pairs.mesh_error import pinion_speed
from gearidae.formulas.interpolation import cubic

_PIECE: Final = 0.5
"""Memory lengths that one piece of the integral has at most: an error of some 1e-8 of the age is left."""
_FORGOTTEN: Final = 32.0
"""Memory lengths, before which nothing is remembered: 1e-14 of it is left."""
_POINT: Final = 0.5 * (1.0 - 1.0 / math.sqrt(5.0))
"""First inner point of Lobatto's rule of four points on 0..1; its weights are 1, 5, 5 and 1 twelfths."""


class JointFriction(NamedTuple):
    """What friction of the joints is, over the base radii.

    Attributes
    ----------
    pinion_hub, gear_hub, pin : float
        Over the loads of hubs and pin.
    pinion_constant, gear_constant : float
        Of adhesion and axial loads.
    """

    pinion_hub: float
    gear_hub: float
    pin: float
    pinion_constant: float
    gear_constant: float


@compiled(inline=True)
def joint_friction(m: Model, t: float, y: Floats) -> JointFriction:
    """Friction of the joints at a state; of joints that do not age that of the scene."""
    f = m.scene.friction
    if f.ages != 0:
        return _of_rises(m, _rises(m, t, y))
    return JointFriction(f.pinion_hub, f.gear_hub, f.pin, f.pinion_constant, f.gear_constant)


@compiled
def _of_rises(m: Model, rises: tuple[float, float, float]) -> JointFriction:
    """Friction of the joints for what their coefficients have risen by."""
    f = m.scene.friction
    return JointFriction(
        f.pinion_hub + rises[PINION_HUB] * f.pinion_arm,
        f.gear_hub + rises[GEAR_HUB] * f.gear_arm,
        f.pin + rises[PIN] * f.pin_arm,
        f.pinion_constant + rises[PINION_HUB] * f.pinion_hold,
        f.gear_constant + rises[GEAR_HUB] * f.gear_hold,
    )


@compiled
def joint_friction_rate(m: Model, t: float, y: Floats) -> JointFriction:
    """Rate of `joint_friction` along the motion; zero of joints that do not age."""
    f = m.scene.friction
    if f.ages == 0:
        return JointFriction(0.0, 0.0, 0.0, 0.0, 0.0)
    motion = _base_circles(m, y)
    ages, speeds = _ages(m, t, motion), _ways(m, motion)[1]
    first = _rise_rate(m, PINION_HUB, ages[PINION_HUB], speeds[0])
    second = _rise_rate(m, GEAR_HUB, ages[GEAR_HUB], speeds[1])
    third = _rise_rate(m, PIN, ages[PIN], speeds[0])
    return JointFriction(
        first * f.pinion_arm,
        second * f.gear_arm,
        third * f.pin_arm,
        first * f.pinion_hold,
        second * f.gear_hold,
    )


@compiled_once(FRICTION)
def coefficients(m: Model, t: float, y: Floats) -> tuple[float, float, float]:
    """Coefficients of friction of hubs and pin."""
    f, rises = m.scene.friction, _rises(m, t, y)
    return (
        f.coefficient[PINION_HUB] + rises[PINION_HUB],
        f.coefficient[GEAR_HUB] + rises[GEAR_HUB],
        f.coefficient[PIN] + rises[PIN],
    )


@compiled_once(FRICTION)
def _rises(m: Model, t: float, y: Floats) -> tuple[float, float, float]:
    """By how much the coefficients of hubs and pin have risen."""
    ages = _ages(m, t, _base_circles(m, y))
    return (
        _rise(m, PINION_HUB, ages[PINION_HUB]),
        _rise(m, GEAR_HUB, ages[GEAR_HUB]),
        _rise(m, PIN, ages[PIN]),
    )


@compiled(inline=True)
def _rise(m: Model, joint: int, age: float) -> float:
    f = m.scene.friction
    return -f.rise[joint] * math.expm1(-age * f.ageing_rate[joint])


@compiled(inline=True)
def _rise_rate(m: Model, joint: int, age: float, speed: float) -> float:
    f = m.scene.friction
    rate = f.ageing_rate[joint]
    return f.rise[joint] * rate * math.exp(-age * rate) * (1.0 - speed * f.forgetting[joint] * age)


@compiled_once(FRICTION)
def follow_ageing(m: Model, t: float, y: Floats) -> None:
    """Take the ages of an accepted time over, with the directions of slip that the step had."""
    motion = _base_circles(m, y)
    ages = _ages(m, t, motion)
    for joint in range(3):
        m.state.ageing.age[joint] = ages[joint]
    _note(m, t, motion)


@compiled_once(FRICTION)
def begin_ageing(m: Model, t: float, y: Floats) -> None:
    """Note ways and speeds of a state whose ages are known."""
    _note(m, t, _base_circles(m, y))


@compiled(inline=True)
def _note(m: Model, t: float, motion: tuple[float, float, float, float]) -> None:
    ageing = m.state.ageing
    ageing.time = t
    ageing.way[0], ageing.way[1], ageing.speed[0], ageing.speed[1] = motion


@compiled
def _base_circles(m: Model, y: Floats) -> tuple[float, float, float, float]:
    """Ways and speeds of the base circles of pinion and gear."""
    gear = y[PHASE] / m.scene.phase_rate
    surface_speed, e = pinion_speed(m, y)
    return gear + y[U] + e.value, gear, surface_speed, y[W]


@compiled
def _ways(
    m: Model, motion: tuple[float, float, float, float]
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Ways since the last accepted time and speeds, of pinion and gear in their directions of slip; 0 of what is held.

    Just behind a reversal that is still to be found a way is below zero, so that nothing has a corner there.
    """
    x, z, surface_speed, w = motion
    slip, gear_slip, ageing = m.state.pinion_slip, m.state.slip, m.state.ageing
    ways = slip * (x - ageing.way[0]), gear_slip * (z - ageing.way[1])
    return ways, (slip * surface_speed, gear_slip * w)


@compiled
def _ages(m: Model, t: float, motion: tuple[float, float, float, float]) -> tuple[float, float, float]:
    """Ages of the contacts of hubs and pin."""
    ageing, h = m.state.ageing, t - m.state.ageing.time
    ways, speeds = _ways(m, motion)
    first, second = m.state.pinion_slip * ageing.speed[0], m.state.slip * ageing.speed[1]
    forgetting, age = m.scene.friction.forgetting, ageing.age
    pinion = later_age(age[PINION_HUB], h, ways[0], first, speeds[0], forgetting[PINION_HUB])
    gear = later_age(age[GEAR_HUB], h, ways[1], second, speeds[1], forgetting[GEAR_HUB])
    return pinion, gear, later_age(age[PIN], h, ways[0], first, speeds[0], forgetting[PIN])


@compiled
def later_age(age: float, h: float, way: float, first: float, last: float, forgetting: float) -> float:
    """Age of contacts after a time.

    Parameters
    ----------
    age : float
        Before.
    h : float
        The time; not above zero in a look back at gears at rest.
    way, first, last : float
        Way of the surfaces in it, and speed at its beginning and its end.
    forgetting : float
        One over the memory length, as a way of the same surfaces; 0 of contacts that do not age.
    """
    if forgetting == 0.0:
        return age
    if h <= 0.0 or (way == 0.0 and first == 0.0 and last == 0.0):
        return max(age + h, 0.0)
    share, lengths = 0.0, way * forgetting
    if lengths > _FORGOTTEN:
        share = 1.0 - _FORGOTTEN / lengths
        age = h / lengths  # of steady sliding; next to nothing of it is left
    pieces = max(math.ceil((1.0 - share) * lengths / _PIECE), 1)
    width = (1.0 - share) / pieces
    begin = cubic(share, h, 0.0, first, way, last)
    for i in range(pieces):
        at = share + i * width
        end = way if i == pieces - 1 else cubic(at + width, h, 0.0, first, way, last)
        early = cubic(at + _POINT * width, h, 0.0, first, way, last)
        late = cubic(at + (1.0 - _POINT) * width, h, 0.0, first, way, last)
        left = math.exp((begin - end) * forgetting)
        inner = math.exp((early - end) * forgetting) + math.exp((late - end) * forgetting)
        age = age * left + width * h * (1.0 + left + 5.0 * inner) / 12.0
        begin = end
    return age
