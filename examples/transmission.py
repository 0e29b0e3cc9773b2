"""
How is a train of gears laid out?
=================================

Three shafts with two meshes, of which the second is worn. Before anything runs, the statics say how the shafts are
placed, how fast they turn, and how far the model holds for each mesh.
"""

import matplotlib.pyplot as plt

import gearidae as gd

train = gd.Scene.from_dict(
    {
        "name": "transmission",
        "shafts": {
            "engine": {"teeth": 19, "inertia": "9.6e-21 kg m^2"},
            "idler": {"teeth": 38, "inertia": "1.536e-19 kg m^2"},
            "output": {"teeth": 76, "inertia": "4.2e-18 kg m^2"},
        },
        "mesh": {
            "module": "3.8887 um",
            "pressure_angle": "20 deg",
            "face_width": "2.25 um",
            "backlash": "0.5 um",
        },
        "meshes": {
            "first": {"driver": "engine", "driven": "idler"},
            "second": {
                "driver": "idler",
                "driven": "output",
                "angle": "40 deg",
                "coating": {"sam_fraction": 0.6},
            },
        },
        "surface": {
            "youngs_modulus": "161 GPa",
            "poisson_ratio": 0.23,
            "energy": "1.2 J/m^2",
            "asperity_density": "169 / um^2",
            "asperity_radius": "130 nm",
            "roughness": "6 nm",
        },
        "coating": {"sam_fraction": 1.0, "energy": "0.02 J/m^2"},
        "drive": {"torque": "1.2e-11 N m"},
        "load": {"torque": "3e-11 N m", "drag": "8e-18 N m s^2/rad^2"},
        "initial": {"gear_speed": "940 rad/s", "gap": "36 nm"},
        "run": {"duration": "150 us"},
    }
)
for shaft in train.train.shafts:
    print(f"{shaft.name}: turns at {shaft.sense * shaft.ratio} of the speed of the drive")

# %%
# The pitch circles, to scale.

figure, ax = plt.subplots(layout="constrained")
for shaft in train.train.shafts:
    x, y = (1e6 * part for part in shaft.centre)
    teeth = train.shafts[shaft.name].teeth
    ax.add_patch(plt.Circle((x, y), 1e6 * train.mesh.module * teeth / 2, fill=False))
    ax.annotate(f"{shaft.name}\n{teeth} teeth", (x, y), ha="center", va="center")
ax.set(xlabel="x (µm)", ylabel="y (µm)", aspect="equal")
ax.autoscale_view()

# %%
# What ``gearidae check`` says of each mesh: here how many asperities touch, and how far they are from JKR's limit.

rows = gd.studies.validity(train)
rows.filter(regex="expected_asperities|tabor", axis=0).filter(["what", "value"])
