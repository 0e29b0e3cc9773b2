"""Scenes drawn at random over far wider ranges than anyone will run.

`random_scene` has the keys of the paper, `wide_scene` those that came later: other laws, sides and tables of coverage,
drives, stops.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from gearidae.engine.setup.build import make_problem
from gearidae.errors import SceneError
from gearidae.scene import Scene

SCENES_PER_SURFACE = 4
"""Scenes that share a surface, whose force law takes longer to tabulate than most of the runs."""

ELASTIC_EVERY, ELASTIC_AT = 5, 3
"""One scene of this many has elastic bodies."""

RADIUS_FORCE_EVERY = 3
"""In one pair of gears of this many a force pays for the changing radius of curvature."""

_ROLLERS = 0.15
_SILICON = 2330.0  # [kg/m^3], of which the random gears are solid discs
_TRIES = 1000

_SHARE = 0.5
"""Share of the scenes that get any of these keys."""
_PLACES = (1, 2, 5, 64)
_ARGON = 0.165e-9  # [m], the interaction range of the presets

Changes = dict[str, Any]


def random_scene(seed: int, number: int) -> Scene:
    """Draw one scene; the same numbers give the same scene.

    Roughness 1..30 nm, tip radius 20 nm..5 um, 1e12..1e15 asperities per square metre, surface energy 0..3 J/m^2,
    modulus 50..400 GPa, SAM fraction 0..1, torque over twelve decades or none, 12..120 teeth, backlash 0..1 um, speed
    up to 1e4 rad/s either way, tolerance 1e-3..1e-10; special values (nothing, all, a start exactly on a guard) more
    often than chance would have them. Every fifth scene has elastic bodies, of 2..400 GPa; in every third pair of gears
    a force pays for the changing radius.

    Parameters
    ----------
    seed, number : int
        Of the run, and of the scene in it.

    Returns
    -------
    Scene
        Its duration is some 10 to 1000 of the engine's own time units.
    """
    surface, coating = _surface(np.random.default_rng([seed, number // SCENES_PER_SURFACE, 1]))
    rng = np.random.default_rng([seed, number, 2])
    deflecting = "rigid"
    if number % ELASTIC_EVERY == ELASTIC_AT:
        bodies = np.random.default_rng([seed, number, 3])
        surface |= {"youngs_modulus": _log(bodies, 2e9, 400e9)}
        deflecting = str(bodies.choice(["elastic", "auto"]))
    data: dict[str, Any] = {
        "name": f"stress {seed}-{number}",
        "surface": surface | {"asperity_density": _log(rng, 1e12, 1e15)},
        "coating": coating | {"sam_fraction": float(rng.choice([0.0, 1.0, rng.random()], p=[0.2, 0.2, 0.6]))},
        "contact": {
            "bodies": deflecting,
            "asperity": str(rng.choice(["jkr", "dmt", "hertz"], p=[0.8, 0.1, 0.1])),
        },
        "run": {"duration": 1e-6, "samples": 401, "rtol": _log(rng, 1e-10, 1e-3)},
    }
    rolls = rng.random() < _ROLLERS
    scene = Scene.from_dict(data | {"roller": _roller(rng, surface)}) if rolls else _gears(rng, data)
    force = {} if rolls else {"mesh.radius_force": number % RADIUS_FORCE_EVERY == 0}
    return scene.replace({"run.duration": _duration(scene, _log(rng, 10.0, 1000.0)), **force})


def _duration(scene: Scene, units: float) -> float:
    """So many of the engine's time units [s]; of a scene that it refuses, so many nanoseconds."""
    try:
        return units * make_problem(scene).time_unit
    except SceneError:
        return units * 1e-9


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(low * (high / low) ** rng.random())


def _surface(rng: np.random.Generator) -> tuple[dict[str, float], dict[str, float]]:
    energy = float(rng.choice([0.0, 3.0 * rng.random()], p=[0.1, 0.9]))
    surface = {
        "youngs_modulus": _log(rng, 50e9, 400e9),
        "poisson_ratio": float(rng.uniform(0.1, 0.4)),
        "energy": energy,
        "asperity_radius": _log(rng, 20e-9, 5e-6),
        "roughness": _log(rng, 1e-9, 30e-9),
    }
    return surface, {"energy": energy * rng.random()}


def _roller(rng: np.random.Generator, surface: dict[str, float]) -> dict[str, float]:
    return {
        "radius": _log(rng, 1e-6, 1e-3),
        "mass": _log(rng, 1e-13, 1e-6),
        "width": _log(rng, 1e-6, 1e-4),
        "speed": float(rng.choice([0.0, _log(rng, 1e-5, 10.0)], p=[0.1, 0.9])),
        "height": float(rng.uniform(1.0, 12.0)) * surface["roughness"],
    }


def _gears(rng: np.random.Generator, data: dict[str, Any]) -> Scene:
    """Draw gears until a pair can mesh; most with few teeth cannot."""
    for _ in range(_TRIES):
        try:
            return Scene.from_dict(data | _gear_tables(rng, data["surface"]))
        except SceneError as error:
            refused = error
    raise refused


def _gear_tables(rng: np.random.Generator, surface: dict[str, float]) -> dict[str, Any]:
    sigma = surface["roughness"]
    teeth = [int(z) for z in rng.integers(12, 121, 2)]
    r1, width = _log(rng, 10e-6, 1e-3), _log(rng, 1e-6, 3e-5)
    radii = r1, r1 * teeth[1] / teeth[0]
    inertias = [0.5 * math.pi * _SILICON * width * r**4 for r in radii]
    torque = float(rng.choice([0.0, _log(rng, 1e-20, 1e-8)], p=[0.1, 0.9]))
    backlash = float(rng.choice([0.0, 1e-6 * rng.random()], p=[0.15, 0.85]))
    speed = float(rng.choice([0.0, _log(rng, 1e-2, 1e4), -_log(rng, 1e-2, 1e4)], p=[0.2, 0.65, 0.15]))
    gap = float(rng.choice([0.5 * backlash, 0.0, sigma * rng.uniform(-1.0, 10.0)], p=[0.2, 0.1, 0.7]))
    drive: dict[str, Any] = {"torque": torque}
    load: dict[str, Any] = {}
    if rng.random() < 0.5:
        load["torque"] = torque * radii[1] / radii[0] * float(rng.uniform(0.0, 1.5))
    if rng.random() < 0.5 and speed != 0.0:
        load["drag"] = torque * radii[1] / radii[0] * float(rng.random()) / speed**2
    if rng.random() < 0.3:
        swing = {"amplitude": torque * float(rng.random()), "frequency": _log(rng, 1e2, 1e6)}
        (drive if rng.random() < 0.7 else load)["harmonic"] = [
            swing | {"phase": float(rng.uniform(0.0, 7.0))}
        ]
    if rng.random() < 0.2:
        times = np.cumsum(rng.random(3)) * _log(rng, 1e-7, 1e-3)
        knots = zip(times, torque * rng.uniform(-1.0, 1.0, 3), strict=True)
        drive["schedule"] = [[float(t), float(value)] for t, value in knots]
    mesh: dict[str, Any] = {"backlash": backlash, "tip_relief_radius": _log(rng, 1e-6, 1e-4)}
    if rng.random() < 0.3:
        mesh["damping"] = math.sqrt(inertias[0] / r1**2 * max(torque / r1, 1e-12) / sigma) * _log(
            rng, 1e-3, 1.0
        )
    if rng.random() < 0.3:
        mesh["static_error"] = [
            {
                "order": int(order),
                "amplitude": sigma * float(rng.uniform(0.0, 5.0)),
                "phase": float(rng.random()),
            }
            for order in (1, teeth[0])
        ]
    return {
        "gears": {
            "pinion_inertia": inertias[0],
            "gear_inertia": inertias[1],
            "pinion_base_radius": r1,
            "pinion_teeth": teeth[0],
            "gear_teeth": teeth[1],
            "pressure_angle": math.radians(float(rng.choice([14.5, 20.0, 25.0, 30.0]))),
            "face_width": width,
        },
        "mesh": mesh,
        "drive": drive,
        "load": load,
        "initial": {
            "gear_speed": speed,
            "gap": gap,
            "mesh_phase": float(rng.choice([0.0, rng.random()], p=[0.1, 0.9])),
        },
    }


# -- later keys --------------------------------------------------------------------------------------------------------


def wide_scene(seed: int, number: int) -> Scene:
    """Draw a scene of `random_scene`, and give half of them some of the later keys.

    Maugis asperities with a range over two and a half decades; a monolayer of 0 to 3 roughnesses; sides paired
    independently, each with its own fraction or a table of it by tooth and up to 64 places; exposures; a drive that
    holds a constant or scheduled speed with a gain over six decades; viscous drag; a cubic schedule of up to 60 knots;
    and conditions to stop.

    Parameters
    ----------
    seed, number : int
        Of the run, and of the scene in it.

    Raises
    ------
    SceneError
        If the keys do not go together.
    """
    scene, rng = random_scene(seed, number), np.random.default_rng([seed, number, 4])
    if rng.random() >= _SHARE:
        return scene
    changes = _contact(rng, scene) | _coating(rng, scene)
    if scene.roller is None:
        changes |= _drive(rng, scene)
        if rng.random() < 0.8:
            changes["run.exposures"] = int(rng.choice([1, 7, 40]))
        if rng.random() < 0.2:
            changes["run.stop"] = str(rng.choice(["sticks", "turns 0.01", "time"]))
    return scene.replace(changes)


def _fraction(rng: np.random.Generator) -> float:
    return float(rng.choice([0.0, 1.0, rng.random()]))


def _contact(rng: np.random.Generator, scene: Scene) -> Changes:
    changes: Changes = {}
    if rng.random() < 0.4:
        changes["contact.asperity"] = "maugis"
        changes["surface.interaction_range"] = _ARGON * float(
            rng.choice([1.0, 10.0 ** rng.uniform(-1.0, 1.5)])
        )
    if rng.random() < 0.4:
        changes["coating.thickness"] = float(rng.uniform(0.0, 3.0)) * scene.surface.roughness
    return changes


def _coating(rng: np.random.Generator, scene: Scene) -> Changes:
    sides = ["pinion"]
    changes: Changes = {}
    if rng.random() < 0.5:
        changes["coating.pairing"] = "independent"
        sides.append("gear")
    for side in sides:
        if scene.gears is not None and rng.random() < 0.3:
            teeth = scene.gears.pinion_teeth if side == "pinion" else scene.gears.gear_teeth
            changes[f"coating.{side}_table"] = _table(rng, teeth)
        elif len(sides) == 2 and rng.random() < 0.5:
            changes[f"coating.{side}_fraction"] = _fraction(rng)
    return changes


def _table(rng: np.random.Generator, teeth: int) -> Sequence[Sequence[float]]:
    rows, places = int(rng.choice([1, teeth])), int(rng.choice(_PLACES))
    return [[_fraction(rng) for _ in range(places)] for _ in range(rows)]


def _drive(rng: np.random.Generator, scene: Scene) -> Changes:
    """Draw a held speed, viscous drag and a cubic schedule, of the size that the scene's speed and torque have."""
    assert scene.gears
    assert scene.drive
    assert scene.initial
    torque, speed = max(abs(scene.drive.torque), 1e-20), scene.initial.gear_speed
    changes: Changes = {}
    if rng.random() < 0.4:
        pinion = speed * scene.gears.gear_teeth / scene.gears.pinion_teeth
        goal = pinion * rng.uniform(-1.0, 2.0) if pinion else 10.0 ** rng.uniform(-2.0, 3.0)
        changes["drive.speed_gain"] = torque / max(abs(goal), 1e-3) * 10.0 ** rng.uniform(-2.0, 4.0)
        times = np.cumsum(rng.random(4)) * 10.0 ** rng.uniform(-8.0, -3.0)
        knots = [[float(t), float(goal * rng.uniform(-1.0, 1.0))] for t in times]
        changes["drive.speed"] = float(goal) if rng.random() < 0.5 else knots
    if rng.random() < 0.3:
        changes["load.viscous"] = torque / max(abs(speed), 1e-2) * float(rng.random())
    if rng.random() < 0.25:
        count = int(rng.choice([2, 5, 60]))
        times = np.cumsum(rng.random(count) + 1e-3) * 10.0 ** rng.uniform(-8.0, -4.0)
        changes["drive.schedule"] = {
            "time": times.tolist(),
            "value": (scene.drive.torque * rng.uniform(-1.0, 1.0, count)).tolist(),
            "interpolation": "cubic",
        }
    return changes
