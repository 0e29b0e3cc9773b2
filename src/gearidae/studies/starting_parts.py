r"""What takes the torque that starts a gear from rest: dry resistance, teeth, hubs, pin, axial loads, in closed form.

With all dry friction at its limit, and the force F of the teeth,

.. math::

    F\,(R_2 + \Sigma f r_2 - \mu r_{h2} c) = M_{20} + H + m_2, \qquad
    M_1 = F\,(R_1 + \Sigma f r_1 + \mu r_{h1} c) + m_1,

where friction of the joints is that after ``initial.rest_time``, H is what adhesion of the teeth holds at the gear,
f the friction of the flanks over the force of the teeth, :math:`c = \sqrt{1 + (\Sigma f)^2}`, and m what the joints of
a shaft take without a force of the teeth: adhesion and axial loads, and the force of a pin. The torque is taken at the
worst place of the mesh (`gearidae.mesh.friction.starting_ratio`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from gearidae.arrays import Floats
from gearidae.mesh.friction import starting_ratio
from gearidae.runs.estimates import mean_force
from gearidae.runs.rubbing import flank_coefficient, hub_arms, joint_loads, rested

if TYPE_CHECKING:
    from gearidae.scene import GearScene

PARTS: Final = ("dry resistance", "adhesion of teeth", "friction of flanks", "hubs", "pin", "axial loads")
"""What takes a starting torque, in the order in which it is added up."""
_ELEMENTS: Final = ("flanks", "hubs", "pin", "axial")
"""Elements with friction, in the order of their parts."""
WITHOUT_FLANKS: Final = frozenset(_ELEMENTS[1:])


@dataclass(frozen=True)
class Starting:
    """What resists the start of a scene.

    Attributes
    ----------
    scene : Scene
        With gears.
    elements : frozenset of str, optional
        Those of `_ELEMENTS` that have friction.
    """

    scene: GearScene
    elements: frozenset[str] = frozenset(_ELEMENTS)

    @cached_property
    def ratio(self) -> float:
        """Torque of the pinion over the resistance of the gear that the teeth carry; infinite where it locks."""
        arms = hub_arms(rested(self.scene)) if "hubs" in self.elements else (0.0, 0.0)
        return starting_ratio(self.scene.geometry, self._flanks, 1.0, arms)

    @property
    def _flanks(self) -> float:
        if "flanks" not in self.elements:
            return 0.0
        coefficient = flank_coefficient(self.scene, mean_force(self.scene))
        return 0.0 if math.isnan(coefficient) else coefficient

    @cached_property
    def joint_torques(self) -> tuple[float, float]:
        """What the joints of pinion and gear take without a force of the teeth [N m]."""
        shafts = [0.0, 0.0]
        age = self.scene.initial.rest_time
        for joint, load in joint_loads(self.scene, 0.0):
            joint = joint.of_age(age)
            kind = "pin" if joint.name == "pin" else "hubs"
            taken = joint.arm * (load + joint.adhesion) if kind in self.elements else 0.0
            taken += joint.axial_torque if "axial" in self.elements else 0.0
            shafts[joint.name == "gear hub"] += taken
        return shafts[0], shafts[1]

    def torque(self) -> float:
        """Torque of the pinion that starts the gears while teeth do not hold the gear [N m]."""
        pinion, gear = self.joint_torques
        return self.ratio * (self.scene.load.torque + gear) + pinion


def parts_of(scene: GearScene, torques: ArrayLike) -> Floats:
    """Divide starting torques of the pinion into `PARTS`.

    Parameters
    ----------
    scene : Scene
        With gears.
    torques : array_like
        [N m].

    Returns
    -------
    ndarray, shape (..., parts)
        What each adds to those before it [N m]; the sum is the torque. What is left for adhesion of the teeth may be a
        little below 0 of a simulated torque, as inertia helps over the worst place. NaN without a finite torque.
    """
    whole = Starting(scene)
    torque = np.asarray(torques, dtype=np.float64)
    torque = np.where(np.isfinite(torque) & math.isfinite(whole.ratio), torque, math.nan)
    hold = (torque - whole.torque()) / whole.ratio
    nothing = 0.0 * hold
    more = [Starting(scene, frozenset(_ELEMENTS[:count])) for count in range(len(_ELEMENTS) + 1)]
    steps = [
        nothing,
        more[0].torque() + nothing,
        *(element.torque() + element.ratio * hold for element in more),
    ]
    return np.diff(np.stack(steps, axis=-1), axis=-1)
