"""A chain of two meshes in contact with any features that shafts and meshes may have."""

from __future__ import annotations

from itertools import combinations

from tests.reference.trains import HUBS, chain

from gearidae.scene import Scene

SHAFTS = ("input", "idler", "output")
_TABLE = [[0.9, 0.7, 0.4, 0.6], [0.5, 0.8, 0.6, 1.0]] * 9 + [[0.3, 0.9, 0.5, 0.7]]
"""Coverage of the 19 teeth of the driver at four places."""
_LAWS = {"dmt asperities", "maugis asperities", "meniscus asperities"}
_APART = (_LAWS, {"meniscus asperities", "attraction"})
"""Of these no two go together: a contact has one law, and a meniscus attracts already."""


def _each(**values: float | str | tuple[float, ...]) -> dict[str, float | str]:
    """Keys of all shafts; a tuple has a value for each."""
    return {
        f"shafts.{name}.{key}": value[k] if isinstance(value, tuple) else value
        for k, name in enumerate(SHAFTS)
        for key, value in values.items()
    }


CHANGES = {
    "dmt asperities": {"contact.asperity": "dmt"},
    "maugis asperities": {"contact.asperity": "maugis"},
    "meniscus asperities": {
        "contact.asperity": "meniscus",
        "surface.humidity": 0.8,
        "surface.bridged": 0.5,
    },
    "discrete asperities": {
        "contact.roughness": "discrete",
        # in 20 us without damping two runs of a tolerance of 1e-8 come to differ by 1 %
        "mesh.damping": 3e-6,
        "run.duration": 1e-5,
        "run.rtol": 1e-11,
        # each surface has its mesh, in whichever order these are listed
        "meshes.first.contact.seed": 1,
        "meshes.second.contact.seed": 2,
    },
    "attraction": {"surface.hamaker": 1e-19},
    "independent coatings": {"coating.pairing": "independent"},
    "coating by place": {"meshes.first.coating.pinion_table": _TABLE},
    "a worn mesh": {"meshes.second.coating.sam_fraction": 0.1},
    "radius force": {"mesh.radius_force": True},
    "static error": {"mesh.static_error": [{"order": 3, "amplitude": "5 nm", "phase": 0.5}]},
    "pitch errors": {"mesh.pitch_error_rms": "1 nm", "mesh.pitch_error_seed": 3},
    "runout": {
        "mesh.pinion_runout": {"amplitude": "20 nm", "phase": 0.4},
        "mesh.gear_runout": {"amplitude": "30 nm", "phase": 1.4},
    },
    "offset": {"meshes.second.offset": "4 nm"},
    "mesh damping": {"mesh.damping": 3e-6},
    "film of gas": {"mesh.film_damping": 2e-4, "mesh.film_gap": 2e-8},
    "held speed": {"drive.speed": 3500.0, "drive.speed_gain": 2e-14},
    "schedules": {
        "drive.schedule": [[0.0, 0.0], [5e-6, 4e-12], [1e-5, -4e-12]],
        "load.schedule": [[0.0, 0.0], [3e-6, 3e-12], [8e-6, 0.0]],
    },
    "harmonics": {"drive.harmonic": [{"amplitude": 4e-12, "frequency": "60 kHz"}]},
    "microengine": {
        "drive.law": {
            "name": "microengine",
            "radius": "10 um",
            "force": "10 uN",
            "frequency": "600 Hz",
            "phase": 1.4,
        },
        "drive.orientation": 0.3,
        "drive.pin_radius": "1.25 um",
        "drive.pin_friction": 0.2,
    },
    "hub friction": _each(hub_friction=0.3, hub_radius=HUBS),
    "friction that ages": _each(
        hub_friction=0.2,
        hub_friction_rise=0.3,
        hub_ageing_time="1 us",
        hub_memory_length="50 nm",
        hub_radius=HUBS,
    ),
    "axial loads": _each(hub_friction=0.3, axial_load=1e-8, dimple_radius=1e-6),
    "hub adhesion": _each(hub_friction=0.3, hub_radius=HUBS, hub_adhesion=2e-8),
    "dry resistance": {"load.torque": 3e-11, "shafts.idler.resistance": 5e-13},
    "drags": _each(viscous=(1e-17, 1e-17, 1e-16), drag=(1e-20, 1e-20, 1e-19)),
}
"""Changes that give the chain a feature."""

BASE = Scene.from_dict(chain()).replace(
    {
        "contact.asperity": "jkr",
        "coating.thickness": 0.0,
        "coating.sam_fraction": 0.6,
        "mesh.damping": 0.0,
        "load.torque": 0.0,
        "initial.gap": "20 nm",
        "run.duration": 2e-5,
        "run.samples": 9,
        "run.rtol": 1e-8,
    }
)
PAIRS = [(a, b) for a, b in combinations(CHANGES, 2) if not any({a, b} <= those for those in _APART)]
TRIPLES = [
    ("maugis asperities", "attraction", "hub friction"),
    ("coating by place", "independent coatings", "radius force"),
    ("static error", "pitch errors", "runout"),
    ("hub friction", "dry resistance", "schedules"),
    ("friction that ages", "microengine", "dry resistance"),
    ("microengine", "hub adhesion", "dry resistance"),
    ("film of gas", "mesh damping", "a worn mesh"),
    ("held speed", "harmonics", "drags"),
    ("axial loads", "meniscus asperities", "offset"),
]


def train_with(*features: str) -> Scene:
    """Return the chain with some features."""
    return BASE.replace({key: value for name in features for key, value in CHANGES[name].items()})
