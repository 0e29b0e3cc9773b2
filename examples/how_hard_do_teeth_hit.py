"""
How hard do the teeth hit each other?
=====================================

A torque that turns round 4,000 times a second throws the gears through the backlash, so that the teeth hit with both
flanks. With ``run.impacts`` the solver keeps each contact, with its force, impulse and loss.
"""

import matplotlib.pyplot as plt

import gearidae as gd

scene = gd.preset("alternating").replace(
    {
        "coating.sam_fraction": 1.0,
        "drive.harmonic": [{"amplitude": "60 pN m", "frequency": "2 kHz"}],
        "mesh.radius_force": True,
        "run.duration": "4 ms",
        "run.samples": "off",
        "run.impacts": True,
    }
)
rattle = gd.simulate(scene)
hits = rattle.gearidae.impacts()
forces = hits["largest_force"] * 1e6
print(f"{len(hits)} impacts: median {forces.median():.1f} uN, largest {forces.max():.1f} uN")
ax = gd.plot.impact_forces(rattle)

# %%
# Of fast impacts the force grows with the speed at which the flanks come together. A slow one ends in a push of about
# 1 µN: the pair goes on to carry the torque. Impacts far below that met while another pair held the flanks apart.

figure, ax = plt.subplots(layout="constrained")
for flank, rows in hits.groupby("flank", observed=True):
    ax.loglog(rows["approach_speed"] * 1e3, rows["largest_force"] * 1e6, ".", label=f"{flank} flank")
ax.set(xlabel="speed of approach (mm/s)", ylabel="largest force (µN)")
ax.legend()

# %%
# The five hardest impacts are the first ones: the run begins with the gears apart.

hits.nlargest(5, "largest_force").filter(["begin", "flank", "approach_speed", "largest_force", "energy_lost"])
