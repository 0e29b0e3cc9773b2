"""Friction of a train's joints that grows at rest and is forgotten by sliding: of the hubs of all shafts, and the pin.

Ages are what they are in a pair (`gearidae.engine.friction.ageing`), functions of the state and of that at the last
accepted time, with the angle of each shaft in place of the way of a base circle.
"""

from __future__ import annotations

from gearidae.arrays import Floats
from gearidae.compiled import compiled
from gearidae.engine.train.layout import TrainModel
from gearidae.laws.joint_law import later_age, rise_at


@compiled
def age_of(tm: TrainModel, j: int, t: float, y: Floats) -> float:
    """Age [s] of the contacts of a joint at a time [s] and a state behind the accepted ones."""
    train, n, joint = tm.train[0], len(tm.shafts), tm.joints[j]
    i = joint.shaft
    slip, turned = (
        tm.shafts[i].slip,
        tm.shafts[i].ratio * (y[train.load] - tm.y[train.load]) / train.per_radian,
    )
    if i != train.load:
        turned += y[i] - tm.y[i]
    speeds = slip * tm.y[n + i], slip * y[n + i]
    return later_age(joint.age, t - train.time, slip * turned, speeds[0], speeds[1], joint.forgetting)


@compiled
def set_joint_friction(tm: TrainModel, t: float, y: Floats) -> None:
    """Set the friction of all joints at a time [s] and a state."""
    for j in range(len(tm.joints)):
        joint = tm.joints[j]
        if joint.rise != 0.0:
            joint.friction = joint.fresh + rise_at(joint, age_of(tm, j, t, y))
            joint.by_load, joint.constant = joint.friction * joint.radius, joint.friction * joint.hold


@compiled
def follow_ageing(tm: TrainModel, t: float, y: Floats) -> None:
    """Take the ages over at the end of a step, before its state is accepted."""
    for j in range(len(tm.joints)):
        if tm.joints[j].rise != 0.0:
            tm.joints[j].age = age_of(tm, j, t, y)
