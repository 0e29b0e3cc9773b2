"""
Does my gear pair start, and does it go on?
===========================================

Teeth that cling to each other hold a gear each time a pair leaves the mesh, and a worn contact is pressed deeper by
each exit. How far does the gear come with how much torque?
"""

import matplotlib.pyplot as plt

import gearidae as gd

scene = gd.preset("teodorescu2009_low_speed").replace(
    {
        "coating.sam_fraction": 0.6,
        "initial.gear_speed": 0.0,
        "initial.gap": "34 nm",  # at rest, just in touch
        "run.duration": "2 s",
        "run.samples": 20001,
    }
)

# %%
# The static estimate is the torque that pulls the leaving tooth off at the first exits, without any help from inertia.

needed = gd.analysis.static_starting_torque(scene, impacts=3)
print(f"three exits take {needed:.3g} N m on the pinion")

torques = [0.3 * needed, needed, 4.0 * needed, 28.0 * needed]
runs = gd.sweep(scene, {"drive.torque": torques})
pitch = scene.geometry.base_pitch / scene.geometry.base_radius_gear
pitches = (runs.gear_angle - runs.gear_angle.isel(time=0)) / pitch
for torque in torques:
    travel = pitches.sel(torque=torque)
    come, lately = float(travel[-1]), abs(float(travel[-1] - travel.sel(time=1.5, method="nearest")))
    print(f"{torque:.3g} N m: {come:.1f} pitches in 2 s, {lately:.1f} of them in the last half second")

# %%
# A torque below the static estimate is enough for the first mesh exits. But even four times the estimate fails at the
# ninth: at each exit the adhesion of the leaving pair presses the next pair deeper.

figure, ax = plt.subplots(layout="constrained")
for torque in torques:
    ax.plot(runs.time, pitches.sel(torque=torque), label=f"{torque / needed:.2g} of the estimate")
ax.set(xlabel="time (s)", ylabel="pitches that the gear has turned", ylim=(-0.5, 12.0))
ax.legend()
