"""
Which torque starts a gear that is worn?
========================================

The study takes a gear at rest and finds the smallest torque that turns it through three mesh exits, for several
fractions of the monolayer. Beside it stands the static estimate: the torque that pulls a leaving tooth off without any
help from inertia.
"""

import gearidae as gd

scene = gd.preset("teodorescu2009_low_speed")
start = gd.studies.starting_torque(scene, [0.6, 0.55, 0.5, 0.45], tolerance=0.2)
table = start[["static_torque", "simulated_torque"]].to_dataframe()
print((table * 1e18).round(2).to_string())  # aN m

# %%
# A gear that moves carries a tooth over its exit with less torque than the static estimate. The torque of the drive is
# dotted: it would start all these gears, but not take all of them further than three exits.

ax = gd.plot.starting_torque(start)
