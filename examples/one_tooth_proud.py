"""
What does one tooth do that stands out?
=======================================

Lithography has left one tooth of the gear 20 nm ahead of its place; all others are perfect. The load closes the gap of
two rough flanks by about a nanometre, so that this tooth meets its partner alone, and too early.
"""

import gearidae as gd

perfect = gd.preset("teodorescu2009").replace(
    {"coating.sam_fraction": 1.0, "run.duration": "2.3 ms", "run.samples": "1 MHz"}
)
proud = perfect.replace({"mesh.gear_pitch_error": [-20e-9] + 75 * [0.0]})  # negative: stands out
runs = {"perfect": gd.simulate(perfect), "one tooth proud": gd.simulate(proud)}

# %%
# The largest force in a turn of the gear, after the first touch.

for name, run in runs.items():
    turned = run.gearidae.passages().query("time > 0.1e-3")
    print(f"{name}: {turned['largest_force'].max() * 1e6:.2f} uN")

# %%
# Above are the errors of the teeth, and below the largest force that each tooth has carried. The gear has four times as
# many teeth as the pinion, so that the tooth that stands out always meets tooth 0 of the pinion. The pair that follows
# is hit a little harder than the others.

figure = gd.plot.tooth_errors(runs["one tooth proud"])
