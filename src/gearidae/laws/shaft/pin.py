"""Pin: the joint by which a drive pushes the pinion whose torque law has a force.

Its keys are those of the table ``drive`` (`gearidae.scene.torque.Drive`). The linkage does not turn, so that the pin
turns with the pinion.
"""

from gearidae.laws.friction_law import Holder
from gearidae.laws.joint_law import JointLaw
from gearidae.laws.law import DRIVE

PIN = JointLaw(
    "pin",
    shafts=(DRIVE,),
    words="the pin",
    sampled="the pin that drives the pinion",
    loads=("size of the force of the torque law",),
    holders=(Holder("pin_friction", 16),),
    key="drive.pin_radius",
)
