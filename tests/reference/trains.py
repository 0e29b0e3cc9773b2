"""Trains of the reference numbers: a chain, a split path and a compound reduction, as tables of a case file.

Rough silicon gears of a microengine (wheels of 64 um and more, summits of 130 nm), asperities by Hertz, rigid bodies.
"""

import math

from gearidae.scene import Scene, preset

MODULE = 2.0 * 34.715e-6 / (19 * math.cos(math.radians(20.0)))
SPLIT = 0.9022140061705, 0.4031857360488
"""Angles of the split path, at which its loop closes: the sum of the teeth's turns is 31 half pitches."""


def tables(**changed):
    """Everything but shafts and meshes."""
    return {
        "name": "train",
        "mesh": {
            "module": MODULE,
            "pressure_angle": "20 deg",
            "face_width": "2.25 um",
            "backlash": "0.5 um",
            "damping": 3e-6,
            "tip_relief_radius": "10 um",
            "radius_force": False,
        },
        "surface": {
            "youngs_modulus": "161 GPa",
            "poisson_ratio": 0.23,
            "energy": "1.2 J/m^2",
            "asperity_density": "169 / um^2",
            "asperity_radius": "130 nm",
            "roughness": "6 nm",
        },
        "coating": {"sam_fraction": 1.0, "energy": "0.02 J/m^2", "thickness": "1 nm"},
        "contact": {"bodies": "rigid", "asperity": "hertz"},
        "drive": {"torque": 1.2e-11},
        "load": {"torque": 3e-11, "drag": 8e-18},
        "initial": {"gear_speed": 940.0, "gap": "36 nm", "mesh_phase": 0.3},
        "run": {"duration": "150 us"},
        **changed,
    }


HUBS = (3e-6, 4e-6, 6e-6)


def chain(angle="40 deg", *, hubs=0.0, **changed):
    """19, 38 and 76 teeth, with a coefficient of friction of the hubs."""
    sizes = zip(("input", "idler", "output"), (19, 38, 76), (9.6e-21, 1.536e-19, 4.2e-18), HUBS, strict=True)
    shafts = {}
    for name, teeth, inertia, radius in sizes:
        shafts[name] = {"teeth": teeth, "inertia": inertia}
        if hubs:
            shafts[name] |= {"hub_friction": hubs, "hub_radius": radius}
    meshes = {
        "first": {"driver": "input", "driven": "idler"},
        "second": {"driver": "idler", "driven": "output", "angle": angle},
    }
    return tables(shafts=shafts, meshes=meshes, **changed)


def split(angles=SPLIT, **changed):
    """19 teeth, two idlers of 38, and 76: the last mesh closes the loop."""
    theta, closing = angles
    shafts = {
        "input": {"teeth": 19, "inertia": 9.6e-21},
        "upper": {"teeth": 38, "inertia": 1.536e-19},
        "lower": {"teeth": 38, "inertia": 1.536e-19},
        "output": {"teeth": 76, "inertia": 4.2e-18},
    }
    meshes = {
        "one": {"driver": "input", "driven": "upper", "angle": theta},
        "two": {"driver": "input", "driven": "lower", "angle": -theta},
        "three": {"driver": "upper", "driven": "output", "angle": -closing},
        "four": {"driver": "lower", "driven": "output"},
    }
    return tables(shafts=shafts, meshes=meshes, **changed)


def compound(angles=(0.0, "60 deg", "-30 deg"), **changed):
    """19:76, 19:57 and 19:76, which is 48:1."""
    shafts = {
        "engine": {"teeth": 19, "inertia": 9.6e-21},
        "first": {"gears": {"wheel": 76, "small": 19}, "inertia": 4.2096e-18},
        "second": {"gears": {"wheel": 57, "small": 19}, "inertia": 1.33851e-18},
        "output": {"teeth": 76, "inertia": 1e-15},
    }
    ways = (("engine", "first.wheel"), ("first.small", "second.wheel"), ("second.small", "output"))
    meshes = {
        f"m{number}": {"driver": driver, "driven": driven, "angle": angle}
        for number, ((driver, driven), angle) in enumerate(zip(ways, angles, strict=True), 1)
    }
    return tables(shafts=shafts, meshes=meshes, **changed)


def bare(teeth, meshes, **changed):
    """A train of bare gears of the paper, by the teeth of its shafts and by its meshes: teeth that adhere strongly."""
    paper = preset("teodorescu2009")
    data = paper.to_dict()
    gears = data.pop("gears")
    data["mesh"] |= {
        "module": paper.geometry.module,
        "pressure_angle": gears["pressure_angle"],
        "face_width": gears["face_width"],
        "radius_force": False,
    }
    data["coating"]["sam_fraction"] = 0.0
    data["shafts"] = {
        name: {"gears" if isinstance(count, dict) else "teeth": count, "inertia": 1e-20}
        for name, count in teeth.items()
    }
    return Scene.from_dict(data | {"meshes": meshes, "load": {"torque": 0.0}} | changed)
