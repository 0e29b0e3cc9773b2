r"""What a joint of a shaft is: a plain bearing, whose dry friction grows with its load and with its time at rest.

Under a load N across the axis friction takes, or holds, a torque :math:`\mu(r(N + A) + r_d P)`, with the adhesion A of
the joint and an axial load P on dimples. The law is set-valued, as those of `gearidae.laws.friction_law`, but the load
follows from the forces of the mesh, and so from the frictions that are held: loads and frictions are solved together in
the engine (`gearidae.engine.friction.hubs`). Free gears, which have no mesh, have no joints.

The contacts of a joint have an age :math:`\theta`, by which its coefficient grows. The law is Dieterich's (J. Geophys.
Res. 84, 1979, doi:10.1029/JB084iB05p02161) with an exponential approach in the place of his logarithm:

.. math::

    \mu = \mu_d + \Delta\mu\,(1 - e^{-\theta/\tau}), \qquad \dot\theta = 1 - |v|\,\theta/D_c .

At rest the age grows as the time, steady sliding has :math:`\theta = D_c/v`. Where the motion is known the age is, too:
with the way s since the last accepted time

.. math::

    \theta(t) = \theta_0\,e^{-s(t)/D_c} + \int_{t_0}^{t} e^{-(s(t) - s(t'))/D_c}\,\mathrm{d}t' .
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

from gearidae.compiled import compiled
from gearidae.formulas.interpolation import cubic
from gearidae.laws.friction_law import Holder
from gearidae.laws.law import REAL, SHAFT_NAMES

if TYPE_CHECKING:
    from gearidae.engine.model.state import Model, Record

JOINT_FIELDS: Final = (
    ("by_load", REAL),  # sliding coefficient times radius over the shaft's base radius [1]
    ("constant", REAL),  # torque of adhesion and axial load over the shaft's base radius [F]
    ("arm", REAL),  # radius over the shaft's base radius [1]
    ("hold", REAL),  # `constant` over the coefficient [F]
    ("coefficient", REAL),  # sliding [1]
    ("rise", REAL),  # of it with the time at rest [1]
    ("ageing_rate", REAL),  # one over the time of that; 0 without a rise [1/tau]
    ("forgetting", REAL),  # one over the way of the base circle that ends it; 0 without a rise [1/sigma]
)
"""Constants of a joint, in ``SCENE.friction.joint``."""
_PIECE: Final = 0.5
"""Memory lengths that one piece of the integral has at most: an error of some 1e-8 of the age is left."""
_FORGOTTEN: Final = 32.0
"""Memory lengths, before which nothing is remembered: 1e-14 of it is left."""
_POINT: Final = 0.5 * (1.0 - 1.0 / math.sqrt(5.0))
"""First inner point of Lobatto's rule of four points on 0..1; its weights are 1, 5, 5 and 1 twelfths."""


@dataclass(frozen=True)
class JointLaw:
    """Kind of joints, one on each shaft that has any.

    Attributes
    ----------
    name : str
    shafts : tuple of int
    words, sampled : str
        What it is in the meaning of its losses, and of its samples; ``{shaft}`` stands for the shaft's name.
    loads : tuple of str
        What its load is, by shaft.
    holders : tuple of Holder
        What holds a gear at rest that friction of its load holds, and of an axial load where it may have one.
    key : str
        That asks for it.
    """

    name: str
    shafts: tuple[int, ...]
    words: str
    sampled: str
    loads: tuple[str, ...]
    holders: tuple[Holder, ...]
    key: str


class ShaftJoint(NamedTuple):
    """A joint of a shaft."""

    law: JointLaw
    shaft: int

    @property
    def name(self) -> str:
        """Name, with the shaft's where several have one."""
        return f"{SHAFT_NAMES[self.shaft]} {self.law.name}" if len(self.law.shafts) > 1 else self.law.name

    @property
    def prefix(self) -> str:
        """What names of its samples and losses begin with."""
        return self.name.replace(" ", "_")

    @property
    def words(self) -> str:
        """What it is in the meaning of its losses."""
        return self.law.words.format(shaft=SHAFT_NAMES[self.shaft])

    @property
    def sampled(self) -> str:
        """What it is in the meaning of its samples."""
        return self.law.sampled.format(shaft=SHAFT_NAMES[self.shaft])

    @property
    def load(self) -> str:
        """What its load is."""
        return self.law.loads[self.law.shafts.index(self.shaft)]


class JointFriction(NamedTuple):
    """What resists a shaft with a load, over its base radius.

    Attributes
    ----------
    by_load : float
        Over the load.
    constant : float
        Without one: of adhesion and axial loads.
    """

    by_load: float
    constant: float


@compiled(inline=True)
def fresh_friction(m: Model, joint: int) -> JointFriction:
    """Friction of a joint whose contacts slide, or do not age."""
    constants = m.scene.friction.joint[joint]
    return JointFriction(constants.by_load, constants.constant)


@compiled(inline=True)
def aged_friction(m: Model, joint: int, rise: float) -> JointFriction:
    """Friction of a joint whose coefficient has risen."""
    constants = m.scene.friction.joint[joint]
    return JointFriction(constants.by_load + rise * constants.arm, constants.constant + rise * constants.hold)


@compiled(inline=True)
def friction_rate(m: Model, joint: int, age: float, speed: float) -> JointFriction:
    """Rate of `aged_friction` for the age of its contacts and the speed of its shaft's base circle."""
    constants = m.scene.friction.joint[joint]
    rate = constants.ageing_rate
    rises = constants.rise * rate * math.exp(-age * rate) * (1.0 - speed * constants.forgetting * age)
    return JointFriction(rises * constants.arm, rises * constants.hold)


@compiled(inline=True)
def rise_at(joint: Record, age: float) -> float:
    """By how much the coefficient of a joint has risen whose contacts have an age."""
    return -joint.rise * math.expm1(-age * joint.ageing_rate)


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
