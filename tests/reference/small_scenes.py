"""A small scene of every kind."""

import numpy as np

import gearidae as gd

__all__ = ["SCENES"]

_GEARS = gd.preset("teodorescu2009").replace(
    {"contact.bodies": "rigid", "initial.gap": 2e-8, "run.duration": 2e-6, "run.samples": 21}
)
_BY_PLACE = _GEARS.replace({"coating.pinion_table": np.full((19, 3), 0.5), "run.exposures": 4})
_ROLLER = gd.preset("roller_slow").replace({"contact.bodies": "rigid", "run.samples": 21})
SCENES = {
    "roller": _ROLLER,
    "two materials": _ROLLER.replace({"coating.sam_fraction": 0.5}),
    "three materials": _GEARS.replace({"coating.sam_fraction": 0.5, "coating.pairing": "independent"}),
    "gears": _GEARS.replace({"coating.sam_fraction": 0.5}),
    "both flanks": _GEARS.replace({"mesh.backlash": 4e-8}),
    "dry resistance": _GEARS.replace({"initial.gear_speed": 0.0, "load.torque": 1e-12, "mesh.damping": 1e-6}),
    "schedule": _GEARS.replace({"drive.schedule": [[0.0, 0.0], [5e-7, 1e-11], [1e-6, 2e-11]]}),
    "static error": _GEARS.replace({"mesh.static_error": [{"order": 19, "amplitude": 2e-9}]}),
    "coverage by place": _BY_PLACE,
    "elastic roller": _ROLLER.replace({"contact.bodies": "elastic", "run.duration": 1e-6}),
    "elastic teeth": _BY_PLACE.replace({"contact.bodies": "elastic", "run.duration": 5e-7}),
}
