"""
How much of the coating is left, judged by a measured speed?
============================================================

A map is computed once for a pair of gears at one torque. A signal is then compared with it; here a simulated one with
noise takes the place of a measurement.
"""

import numpy as np

import gearidae as gd

scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": "150 ms", "run.samples": 15001})

# %%
# The rig: 71.3 % of the monolayer, unknown to the assessment, and a sensor that is off by 5 mrad/s.

rig = gd.simulate(scene.replace({"coating.sam_fraction": 0.713}))
measured = rig.gear_speed.values + np.random.default_rng(1).normal(0.0, 5e-3, rig.sizes["time"])
np.savetxt(
    "rig.csv",
    np.column_stack([rig.time, measured]),
    delimiter=",",
    header="time [s], gear_speed [rad/s]",
    comments="",
)

# %%
# The map, and what it says of the record.

chart = gd.analysis.coating_map(scene, np.round(np.arange(1.0, 0.595, -0.02), 4))
assessment = gd.analysis.assess("rig.csv", chart)
print(
    f"{assessment.verdict}: {assessment.sam_fraction:.3f} of the monolayer is left "
    f"({assessment.low:.3f} to {assessment.high:.3f})"
)
ax = gd.plot.coating_map(chart, assessment=assessment)
