"""The own pair of gears of the start-up and braking tests: 18 and 54 teeth of 3 um, under a dry load and a drag."""

import math

OWN_PAIR = {
    "gears": {
        "pinion_teeth": 18,
        "gear_teeth": 54,
        "module": 3e-6,
        "pressure_angle": math.radians(20.0),
        "face_width": 2.5e-6,
        "density": 2330.0,
    },
    "mesh": {"backlash": 0.25e-6, "tip_relief_radius": 10e-6},
    "load": {"torque": 3e-18, "drag": 8e-18},
    "initial": {"gear_speed": 0.0, "gap": 0.1e-6, "mesh_phase": 0.3},
}
