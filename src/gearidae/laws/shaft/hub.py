"""Hub: a gear turns on a post that carries the forces of its teeth, and on the pinion also that of a pin.

Its keys are those of the table ``gears`` (`gearidae.scene.gears`), and of a train those of each shaft.
"""

from gearidae.laws.friction_law import Holder
from gearidae.laws.joint_law import JointLaw
from gearidae.laws.law import DRIVE, LOAD

HUB = JointLaw(
    "hub",
    shafts=(DRIVE, LOAD),
    words="the {shaft}'s hub",
    sampled="the {shaft}'s hub",
    loads=(
        "size of the vector sum of the force of a pin and the mesh forces; of gears at rest without flank friction",
        "size of the vector sum of the mesh forces; of gears at rest without flank friction",
    ),
    holders=(Holder("hub_friction", 2), Holder("axial_load", 32)),
    key="gears.hub_friction",
)
