"""
Which surface should the gears have?
====================================

The library has surfaces and monolayers by name, each number with its source or marked as assumed. A scene takes a
surface by its name, with a monolayer behind a comma.
"""

import matplotlib.pyplot as plt
import numpy as np

import gearidae as gd

library = gd.surfaces.library()
library.loc["polysilicon"].filter(["value", "unit", "assumed"])

# %%
# Does a slow gear turn with them?

scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": "0.2 s"})
scenes = {
    name: scene.replace({"surface": name, "coating.sam_fraction": 1.0 if "," in name else 0.0})
    for name in ("silicon", "oxidised silicon", "polysilicon", "silicon, OTS", "polysilicon, FOTS")
}
for name, of_name in scenes.items():
    print(f"{name}: {gd.outcomes(gd.simulate(of_name))[0].words}")

# %%
# The reason: the force of one pair of teeth that has been pressed together to a gap of 15 nm and is parted again. Only
# freshly broken silicon pulls. The others push until they part: their energies are 12 times smaller and less, which no
# longer shows beside the elastic force, so that surfaces with the same asperities share a line.

gap = np.linspace(15e-9, 30e-9, 121)
figure, ax = plt.subplots(layout="constrained")
for name, of_name in scenes.items():
    surface = of_name.coated_surface if "," in name else of_name.surface
    radius, width = 5e-6, of_name.gears.face_width
    force = [gd.contact.line_force(at, at - gap[0], radius, width, surface) for at in gap]
    ax.plot(gap * 1e9, np.array(force) * 1e9, label=name)
ax.set(xlabel="gap (nm)", ylabel="force (nN)", ylim=(-300.0, 1000.0))
ax.legend()
