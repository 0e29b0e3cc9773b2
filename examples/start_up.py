"""
When does a gear start, and what held it?
=========================================

A dry load resists, and the torque of the drive rises from zero in 10 ms. A gear without adhesion would start where the
torque reaches the load, divided by the ratio of the teeth.
"""

import gearidae as gd

scene = gd.preset("start_up").replace({"run.duration": "8 ms", "run.samples": 8001})
run = gd.simulate(scene)

dry = scene.load.torque * scene.gears.pinion_teeth / scene.gears.gear_teeth
print(f"started at {float(run.start_time) * 1e3:.3f} ms, with {float(run.breakaway_torque) * 1e12:.3f} pN m")
print(f"the dry load alone takes {dry * 1e12:.3f} pN m")

# %%
# Until then the gear stands; afterwards its speed follows the torque. Adhesion also held the gear, but against this
# load it is too weak to be seen in the torque.

ax = gd.plot.gear_speed(run)

# %%
# The table names each standstill, and what held the gear.

run.gearidae.standstills().filter(["begin", "end", "held_by"])
