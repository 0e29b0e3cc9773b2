"""
How does a transmission turn, and where does its work go?
=========================================================

Three shafts with two meshes, of which the second is worn. Before anything runs, the statics say how the shafts are
placed, how fast they turn, and how far the model holds for each mesh.
"""

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
# What ``gearidae check`` says of each mesh: here how many asperities touch, and how far they are from JKR's limit.

rows = gd.studies.validity(train)
print(rows.filter(regex="expected_asperities|tabor", axis=0).filter(["what", "value"]))

# %%
# The run, and the whole train at its end. An arrow is the load of a hub: that of the idler is the vector sum of two
# forces.

run = gd.simulate(train)
figure = gd.plot.train(run)

# %%
# Where the work of the drive goes.

run.gearidae.work()
