"""How worn may the coating be before the train sticks?

The monolayer wears off while the gears run. A sweep over what is left of it finds the fraction below which the train
sticks at this torque, and the same for more torque.
"""

import gearidae as gd
from gearidae.analysis.verdict import outcomes

scene = gd.preset("teodorescu2009_low_speed")  # 4.5e-18 N m on the pinion
fractions = [1.0, 0.8, 0.6, 0.55, 0.5, 0.47, 0.45, 0.4]
torques = [4.5e-18, 9e-18]

runs = gd.sweep(scene, {"drive.torque": torques, "coating.sam_fraction": fractions})
print(runs.gear_speed.min("time").to_pandas().round(2))  # rad/s; below zero it was thrown back

for torque in torques:
    stuck = [
        did.label["sam_fraction"]
        for did in outcomes(runs)
        if did.label["torque"] == torque and did.verdict == "sticks"
    ]
    outcome = f"sticks at {max(stuck):g} and below" if stuck else f"runs down to {min(fractions):g}"
    print(f"{torque:g} N m: {outcome}")

gd.plot.write(gd.plot.overview(runs.sel(torque=4.5e-18)), "worn.png", overwrite=True)
