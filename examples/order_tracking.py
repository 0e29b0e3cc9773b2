"""
Which lines of a run-up belong to the teeth?
============================================

While a gear speeds up, the frequency of its teeth rises, and a power spectrum smears their line. Over turns in place of
time the teeth have one order: their number.
"""

import gearidae as gd

scene = gd.preset("start_up").replace(
    {
        "coating.sam_fraction": 1.0,
        "drive.schedule": [["0 ms", 0.0], ["20 ms", 2.43e-11]],
        "run.duration": "25 ms",
        "run.samples": "ringing",  # enough for the ring of the contacts: no line is an alias
    }
)
run = gd.simulate(scene)
print(f"{run.sizes['time']} samples")

# %%
# The gear starts after 6 ms. The line of the mesh follows the speed of the instant, and its multiples follow it.

ax = gd.plot.spectrogram(run, highest=140e3)

# %%
# The same record over the turns of the gear: a line at each multiple of 76 teeth.

ax = gd.plot.orders(run)
