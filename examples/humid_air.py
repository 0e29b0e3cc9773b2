"""
What does humid air do to bare teeth?
=====================================

Water condenses between asperities that touch, and holds them. The law of one asperity is that of a meniscus in place of
the adhesion of freshly broken silicon; the humidity of the air is a key of the scene.
"""

import gearidae as gd

humid = gd.preset("teodorescu2009").replace(
    {
        "coating.sam_fraction": 0.0,
        "contact.asperity": "meniscus",
        "contact.bodies": "rigid",
        "surface.humidity": 0.5,
        "run.duration": "60 us",
        "run.samples": 6001,
    }
)
runs = gd.sweep(humid, {"surface.humidity": [0.5, 0.8, 0.9, 0.93, 0.95]})
print(runs.min_gear_speed.to_pandas().round().to_string())  # rad/s

# %%
# Up to 90 % the gears run as coated ones do. Above, menisci pull the teeth together at the first touch: the gear rings,
# and nearly stops. At 95 % leaving teeth hold it back, too.

ax = gd.plot.gear_speed(runs)
