"""
Which torque suits which coating?
=================================

More torque pulls a leaving tooth off, and presses the next one deeper. A map over torque and coating shows where the
gear turns, and where it sticks.
"""

import gearidae as gd

scene = gd.preset("teodorescu2009_low_speed")
over = {
    "drive.torque": [3e-18, 4.5e-18, 9e-18, 1.8e-17],
    "coating.sam_fraction": [0.65, 0.6, 0.55, 0.5, 0.45, 0.4],
}
chart = gd.studies.operating_map(scene, over)
ax = gd.plot.outcome_map(chart)

# %%
# The verdicts in full.

chart.verdict.to_pandas()
