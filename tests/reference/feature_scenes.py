"""A short scene of gears in contact with any of the features that `gearidae.combinations` lists."""

from __future__ import annotations

import math

import numpy as np

import gearidae as gd
from gearidae.laws.frictions import LAWS_OF_SHAFTS
from gearidae.laws.law import SHAFT_NAMES
from gearidae.laws.pairs import MESH_LAWS

__all__ = ["CHANGES", "HALF", "SAMPLES", "scene_with"]

HALF = 2.0**-21
"""Half of the duration [s], so that times of samples of both halves are those of the whole to the last bit."""
SAMPLES = 9
"""Of each half."""

_TABLE = [[1.0, 0.4, 0.8], *[[0.5, 0.9, 0.3]] * 18]
BASE = gd.preset("teodorescu2009").replace(
    {
        "contact.bodies": "rigid",
        "coating.sam_fraction": 0.5,
        "drive.harmonic": None,
        "load.torque": 0.0,
        "initial.gap": 1.5e-8,
        "run.duration": HALF,
        "run.samples": SAMPLES,
        "run.rtol": 1e-8,
    }
)
CHANGES = {
    "elastic bodies": {"contact.bodies": "elastic"},
    "discrete asperities": {"contact.roughness": "discrete"},
    "attraction": {"surface.hamaker": 5e-20, "coating.hamaker": 2e-20},
    "coulomb friction": {"contact.friction": 0.3, "coating.friction": 0.1},
    "shear friction": {
        "contact.friction_law": "shear",
        "contact.shear_strength": 1e8,
        "coating.shear_strength": 2e7,
    },
    "hub friction": {
        "gears.hub_friction": 0.3,
        "gears.pinion_hub_radius": 3e-6,
        "gears.gear_hub_radius": 6e-6,
    },
    "friction that ages": {
        "gears.hub_friction_rise": 0.5,
        "gears.hub_ageing_time": "1 us",
        "gears.hub_memory_length": "20 nm",
        "gears.pinion_hub_radius": 3e-6,
        "gears.gear_hub_radius": 6e-6,
        "initial.rest_time": "1 us",
    },
    "pin friction": {
        "drive.law": {
            "name": "microengine",
            "radius": 1e-5,
            "force": 4e-7,
            "stiffness_x": 1e-4,
            "phase": 0.5,
            "frequency": 0.0,
        },
        "drive.orientation": 0.4,
        "drive.pin_radius": 1.25e-6,
        "drive.pin_friction": 0.3,
    },
    "dry resistance": {"load.torque": 3e-11},
    "maugis asperities": {"contact.asperity": "maugis"},
    "meniscus asperities": {
        "contact.asperity": "meniscus",
        "surface.humidity": 0.8,
        "surface.bridged": 0.5,
    },
    "independent coatings": {"coating.pairing": "independent", "coating.thickness": "1 nm"},
    "coating by place": {"coating.pinion_table": np.array(_TABLE)},
    "radius force": {"mesh.radius_force": True},
    "static error": {"mesh.static_error": [{"order": 19, "amplitude": 2e-9}]},
    "pitch errors": {"mesh.pitch_error_rms": 2e-9, "mesh.pitch_error_seed": 1},
    "runout": {
        "mesh.pinion_runout": {"amplitude": 2e-8, "phase": 0.5},
        "mesh.gear_runout": {"amplitude": 6e-8, "phase": -1.0},
    },
    "orbit": {
        "drive.law": {
            "name": "microengine",
            "radius": 1e-5,
            "force": 4e-7,
            "phase": math.pi / 6.0,  # so that the units of both halves are the same
            "frequency": 2e5,
        },
        "drive.orientation": 0.4,
        "gears.pinion_hub_clearance": 2e-8,
    },
    **{
        law.name: {f"mesh.{constant.name}": constant.key.example for constant in law.constants}
        for law in MESH_LAWS
    },
    "held speed": {"drive.speed": 11592.0, "drive.speed_gain": 1e-15},
    "exposures": {"run.exposures": 4},
    **{
        law.name: {
            f"gears.{shaft}_{constant.name}": constant.key.example
            for shaft in SHAFT_NAMES
            for constant in law.coefficients
        }
        for law in LAWS_OF_SHAFTS
        if any(constant.key for constant in law.coefficients)
    },
}
"""Changes that give the scene a feature."""


def scene_with(*features: str) -> gd.Scene:
    """Return the scene of a duration of `HALF` with some features."""
    return BASE.replace({key: value for name in features for key, value in CHANGES[name].items()})
