"""
How long does a gear take to stop?
==================================

The torque of the drive goes within 0.1 us, at a speed of 2898 rad/s. Drag slows the gear at first, the dry load at the
end.
"""

import gearidae as gd
from gearidae.testing import solutions

full = 2.43e-11  # N m: holds 2898 rad/s
scene = gd.preset("braking").replace(
    {"drive.schedule": [["50 us", full], ["50.1 us", 0.0]], "run.duration": "0.1 ms", "run.samples": 20001}
)
run = gd.simulate(scene)
ax = gd.plot.gear_speed(run)

# %%
# The teeth keep both gears together while they slow down. Seen from the gear, the inertia of the pinion counts with the
# square of the ratio, and the time to rest has a closed form.

(stands,) = run.gearidae.standstills().itertuples()
gears, off = scene.gears, 50.05e-6
inertia = gears.gear_inertia + gears.pinion_inertia * (gears.gear_teeth / gears.pinion_teeth) ** 2
speed = float(run.gear_speed.sel(time=off, method="nearest"))
stop = solutions.dry_stop(speed, inertia, scene.load.torque, drag=scene.load.drag)
print(f"closed form: {stop.time * 1e6:.2f} us; the run: {(stands.begin - off) * 1e6:.2f} us")
print(f"held by {stands.held_by}")
