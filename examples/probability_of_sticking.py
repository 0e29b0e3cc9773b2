"""
How likely does a gear of a lot stick?
======================================

Coatings and torques scatter within a lot. An ensemble draws both, runs each member, and gives the probability of
sticking with its interval; the members are computed side by side on all cores.
"""

import gearidae as gd

scene = gd.preset("teodorescu2009_low_speed")
vary = {"coating.sam_fraction": "uniform(0.4, 0.65)", "drive.torque": "normal(4.5e-18 N m, 2e-19 N m)"}
lot = gd.studies.ensemble(scene, vary, 64, seed=1)
whole = gd.studies.sticking_probability(lot)
print(f"{float(whole.probability):.2f}, 95 % between {float(whole.low):.2f} and {float(whole.high):.2f}")

# %%
# Nearly all of it is the coating.

ax = gd.plot.sticking_probability(lot, over="coating.sam_fraction", bins=6)
