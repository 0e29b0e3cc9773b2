"""
How worn may the coating be before the gears stick?
===================================================

The monolayer wears off while the gears run. A sweep over what is left of it finds the fraction below which the gears
stick at this torque, and the same for twice the torque.
"""

import gearidae as gd

scene = gd.preset("teodorescu2009_low_speed")  # 4.5e-18 N m on the pinion
fractions = [1.0, 0.8, 0.6, 0.55, 0.5, 0.47, 0.45, 0.4]
torques = [4.5e-18, 9e-18]

runs = gd.sweep(scene, {"drive.torque": torques, "coating.sam_fraction": fractions})
for torque in torques:
    stuck = [
        did.label["sam_fraction"]
        for did in gd.outcomes(runs)
        if did.label["torque"] == torque and did.verdict == "sticks"
    ]
    outcome = f"sticks at {max(stuck):g} and below" if stuck else f"turns down to {min(fractions):g}"
    print(f"{torque:g} N m: {outcome}")

# %%
# Speed and torque of the contacts, for the smaller torque.

figure = gd.plot.overview(runs.sel(torque=4.5e-18))

# %%
# The range of the speed against the fraction. Within these 0.3 s twice the torque helps little: it carries the gear
# over a mesh exit, and presses the next pair deeper.

ax = gd.plot.outcome(runs.sel(torque=4.5e-18))

# %%
# The smallest speed of each run, in rad/s. Where it is negative the gear has been thrown back.

runs.min_gear_speed.to_pandas().round(2)
