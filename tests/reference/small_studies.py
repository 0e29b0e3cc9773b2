"""Every study in its smallest form that computes something: a function of the path of its archive."""

from __future__ import annotations

import gearidae as gd

__all__ = ["LOW", "STUDIES"]

LOW = gd.preset("teodorescu2009_low_speed").replace(
    {
        "run.duration": 4e-3,
        "run.samples": 401,
        "run.rtol": 1e-4,
    }  # whose runs from rest take a tenth of the steps
)
HIGH = gd.preset("teodorescu2009")
LAW = gd.wear.loss_law("adhesion_work", energy=1e-6)
WINDOWS = {"cycles": 2, "settle": 1, "starts": 1, "places": 2, "fraction": 0.695, "tolerance": 0.1}
AGEING = {
    "gears.hub_friction": 0.2,
    "gears.hub_friction_rise": 0.1,
    "gears.hub_ageing_time": 1e-3,
    "gears.hub_memory_length": 50e-9,
    "gears.pinion_hub_radius": 3e-6,
    "gears.gear_hub_radius": 6e-6,
}
DRAWN = {"drive.torque": "uniform(4e-18, 5e-18)", "coating.sam_fraction": "uniform(0.5, 1)"}


def campbell(path, scene=LOW, **more):
    return gd.studies.campbell(scene, [4.0, 6.0, 8.0], archive=path, **more)


def coating_map(path, scene=LOW, **more):
    return gd.studies.coating_map(scene, [1.0, 0.8], archive=path, **more)


def convergence(path, scene=LOW, **more):
    figures = ["gear_angle", "adhesion_loss"]
    return gd.studies.convergence(scene, figures, rtols=[1e-4, 1e-5, 1e-6], archive=path, **more)


def ensemble(path, scene=LOW, **more):
    return gd.studies.ensemble(scene, DRAWN, 4, of="min_gear_speed", archive=path, **more)


def hub_life(path, scene=HIGH, **more):
    joints = {"gears.pinion_hub_radius": 3e-6, "gears.gear_hub_radius": 6e-6, "run.duration": 0.1e-3}
    wear = {"coefficient": 1e-16, "threshold": "2 sigma", "spread": 2.0, "seeds": 5, "clearance": True}
    return gd.studies.hub_life(scene.replace(joints), **wear, turns=1, tolerance=0.1, archive=path, **more)


def life(path, scene=LOW, **more):
    worn = scene.replace({"coating.sam_fraction": 0.7})
    return gd.studies.life(worn, LAW, **WINDOWS, resolved="place", frequency=False, archive=path, **more)


def lives(path, scene=LOW, **more):
    worn, vary = scene.replace({"coating.sam_fraction": 0.7}), {"law.energy": "uniform(1e-6, 2e-6)"}
    return gd.studies.lives(worn, LAW, vary, 2, **WINDOWS, archive=path, **more)


def operating_map(path, scene=LOW, **more):
    over = {"drive.torque": [4e-18, 5e-18], "coating.sam_fraction": [1.0, 0.5]}
    return gd.studies.operating_map(scene, over, archive=path, **more)


def posterior(path, scene=LOW, **more):
    seen = [gd.studies.Observation(value=False)]
    priors = {"drive.torque": "normal(4.5e-18, 2e-19)"}
    return gd.studies.calibrate(scene, priors, seen, points=3, archive=path, **more)


def pull_off(path, scene=LOW, **more):
    return gd.studies.pull_off(scene, 5, archive=path, **more)


def start_probability(path, scene=LOW, **more):
    rest = scene.replace({"initial.gear_speed": 0.0})
    starts = {"size": 3, "by": ["2 ms", "50 ms"]}
    return gd.studies.start_probability(
        rest, {"drive.torque": DRAWN["drive.torque"]}, **starts, archive=path, **more
    )


def starting_torque(path, scene=LOW, **more):
    bare = scene.replace({"coating.sam_fraction": 0.45})
    return gd.studies.starting_torque(bare, "own", impacts=1, tolerance=1.0, archive=path, **more)


def starting_rests(path, scene=LOW, **more):
    bare = scene.replace({**AGEING, "coating.sam_fraction": 0.45})
    options = {"impacts": 1, "tolerance": 1.0, "rest_time": [0.0, 1.0]}
    return gd.studies.starting_torque(bare, "own", **options, archive=path, **more)


def starting_torques(path, scene=HIGH, **more):
    gears = scene.replace({"contact.roughness": "discrete", "load.torque": 0.0})
    return gd.studies.starting_torque(gears, seeds=2, archive=path, **more)


def starting_torques_rests(path, scene=HIGH, **more):
    gears = scene.replace({**AGEING, "contact.roughness": "discrete", "load.torque": 0.0})
    return gd.studies.starting_torque(gears, seeds=1, rest_time=[0.0, 1.0], archive=path, **more)


def starting_teeth(path, scene=LOW, **more):
    teeth = scene.replace({"coating.sam_fraction": 0.45, "mesh.pitch_error_rms": "3 nm"})
    options = {"impacts": 1, "tolerance": 1.0, "seeds": 2}
    return gd.studies.starting_torque(teeth, "own", **options, archive=path, **more)


def sticking_thresholds(path, scene=LOW, **more):
    teeth, ends = scene.replace({"mesh.pitch_error_rms": "3 nm"}), (0.3, 0.8)
    options = {"between": ends, "exits": 2, "width": 0.2, "seeds": 2}
    return gd.studies.sticking_threshold(teeth, **options, archive=path, **more)


def sticking_threshold(path, scene=LOW, **more):
    return gd.studies.sticking_threshold(scene, between=(0.4, 0.7), exits=5, width=0.05, archive=path, **more)


STUDIES = {
    study.__name__: study
    for study in (
        campbell,
        coating_map,
        convergence,
        ensemble,
        hub_life,
        life,
        lives,
        operating_map,
        posterior,
        pull_off,
        start_probability,
        starting_rests,
        starting_teeth,
        starting_torque,
        starting_torques,
        starting_torques_rests,
        sticking_threshold,
        sticking_thresholds,
    )
}
"""By the kinds of their files; keyword arguments are the scene and the options of every study."""
