"""The own pair of gears of the start-up and braking tests: 18 and 54 teeth of 3 um, under a dry load and a drag.

And another that rings, as changes of a scene: 27 and 50 teeth.
"""

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

TEETH_27_50 = {"gears.pinion_teeth": 27, "gears.gear_teeth": 50, "gears.module": 3.09e-6}
RINGING = {
    **TEETH_27_50,
    "contact.bodies": "rigid",
    "coating.sam_fraction": 0.5,
    "drive.torque": 5.9e-18,
    "drive.schedule": [],
    "load.torque": 1e-21,
    "run.samples": "off",
}
"""Changes of a scene: gears that ring in their adhesion, under a dry load of some 1e-4 of the drive's torque."""
