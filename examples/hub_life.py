"""
Which joint of a microengine wears out first?
=============================================

The pin of the drive and the hubs of both gears slide under their loads. By Archard's law each loses a volume in
proportion to load and path, and the joint whose volume is gone first ends the life. Wear coefficient and volume are
examples: neither has been measured on such joints.
"""

import matplotlib.pyplot as plt

import gearidae as gd

engine = gd.load_case("cases/microengine.toml").replace({"load.schedule": None, "run.duration": "6 ms"})
lives = gd.studies.hub_life(engine, coefficient="1e-16 m^2/N", threshold="1e-21 m^3", length="2 um")
turns = lives.turns.isel(frequency=0)
print(turns.to_series().map("{:.3g}".format).to_string())

# %%
# What a joint slides in a turn of the pinion, times its load, decides. The hub of the gear carries the smallest load
# and turns four times as slowly.

figure, ax = plt.subplots(layout="constrained")
ax.semilogx(turns, lives.joint.values, "o")
ax.set(xlabel="turns of the pinion until the volume is gone", ylim=(-0.5, 2.5))
ax.grid(axis="x")
