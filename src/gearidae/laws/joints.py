"""All joints of the shafts of a pair: the hubs, which have the numbers of their shafts, and the pin of the drive."""

from __future__ import annotations

from typing import Final

from gearidae.laws.joint_law import JointLaw, ShaftJoint
from gearidae.laws.shaft.hub import HUB
from gearidae.laws.shaft.pin import PIN as PIN_LAW

JOINT_LAWS: Final[tuple[JointLaw, ...]] = (HUB, PIN_LAW)
JOINTS: Final = tuple(ShaftJoint(law, shaft) for law in JOINT_LAWS for shaft in law.shafts)
"""In the order of their numbers."""
SHAFT_OF_JOINT: Final = tuple(joint.shaft for joint in JOINTS)
PIN: Final = len(HUB.shafts)
"""Number of the pin."""
