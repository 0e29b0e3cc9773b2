"""
What do the teeth do while the gear is held back?
=================================================

At the dip of the contact torque a leaving tooth pulls the gear back. ``tooth_contacts`` repeats the run up to that time
and gives the pairs of teeth: their gaps, forces and states.
"""

import gearidae as gd
from gearidae.analysis import tooth_contacts

scene = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.5})
run = gd.simulate(scene, t_end=0.09, samples=9001)
dip = float(run.gear_contact_torque.idxmin())

(state,) = tooth_contacts(run, dip)
print(f"at {state.time * 1e3:.2f} ms all pairs together give {state.mesh_force * 1e12:+.3f} pN")
for pair in state.contacts:
    numbers = f"{pair.gap * 1e9:.1f} nm, {pair.force * 1e12:+.3f} pN, {pair.state.name}"
    print(f"  pair {pair.pair}, {pair.flank.name}: {numbers}")

# %%
# The same as a picture, and as a moving one.

figure = gd.plot.teeth(run, time=dip)
gd.plot.animate_teeth(run, "teeth.gif", start=dip - 2e-3, stop=dip + 2e-3, frames=8, dpi=60, overwrite=True)
