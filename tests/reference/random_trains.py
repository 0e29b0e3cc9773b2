"""Trains drawn at random: trees and split paths of two to five meshes, with compound shafts, over wide ranges."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
from tests.reference.trains import tables

from gearidae.engine.train import solve_train
from gearidae.engine.train.build import make_train
from gearidae.errors import SceneError
from gearidae.scene import Scene

_SILICON = 2330.0  # [kg/m^3], of which the gears are solid discs
_TRIES = 200
STEPS = 3_000
"""Steps of a run, about."""


@cache  # of one process; short runs say how long one may be
def random_train(seed: int, number: int) -> Scene:
    """Draw one train; the same numbers give the same train.

    Every fourth is a split path with idlers of its own sizes. Teeth 16 to 80; angles of all meshes; roughness 1 to 15
    nm, coverage of each mesh 0 to 1; torque over two decades, either way; hubs, dry resistances, drags,
    damping, film, harmonics and errors in a part of them.

    Returns
    -------
    Scene
        Its duration is some 10 to 100 of the engine's own time units, or what `STEPS` steps last if that is less.
    """
    rng = np.random.default_rng([seed, number, 11])
    split = number % 4 == 3
    for _ in range(_TRIES):
        try:
            scene = Scene.from_dict(_split(rng) if split else _tree(rng))
            unit = float(make_train(scene).model.train[0].tau)
        except SceneError as error:
            refused = error
            continue
        scene = scene.replace({"run.duration": unit * _log(rng, 10.0, 100.0)})
        return scene.replace({"run.duration": _within(scene)})
    raise refused


def _within(scene: Scene) -> float:
    """Duration [s] of a scene that takes some `STEPS` steps at most: teeth that ring in an adhesive well need many."""
    part = 0.02
    while part < 1.0:
        steps = solve_train(scene, t_end=part * scene.run.duration, samples=2).statistics.steps
        if steps > 0.3 * STEPS:
            return part * scene.run.duration * min(STEPS / steps, 3.0)
        part *= 3.0
    return scene.run.duration


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(low * (high / low) ** rng.random())


def _tree(rng: np.random.Generator) -> dict[str, Any]:
    """Shafts that are each driven by a gear of one before, half of them by a gear of their own there."""
    sizes, gears, shafts, meshes = [_teeth(rng)], [{"g0": 0}], {}, {}
    gears[0]["g0"] = sizes[0]
    for k in range(1, int(rng.integers(3, 6))):
        above = int(rng.integers(max(k - 2, 0), k))
        if rng.random() < 0.5:
            gears[above][f"g{len(gears[above])}"] = _teeth(rng)
        driver = f"g{len(gears[above]) - 1}"
        gears.append({"g0": _teeth(rng)})
        meshes[f"m{k}"] = {
            "driver": (above, driver),
            "driven": (k, "g0"),
            "angle": float(rng.uniform(-3.0, 3.0)),
        }
    width, module = _log(rng, 1e-6, 5e-6), _log(rng, 2e-6, 2e-5)
    for k, own in enumerate(gears):
        inertia = sum(0.5 * math.pi * _SILICON * width * (0.5 * module * z) ** 4 for z in own.values())
        shafts[f"s{k}"] = {"inertia": inertia, "gears": own}
    for mesh in meshes.values():
        for side in ("driver", "driven"):
            shaft, gear = mesh[side]
            mesh[side] = f"s{shaft}.{gear}"
    return _rest(rng, shafts, meshes, module, width)


def _teeth(rng: np.random.Generator) -> int:
    return int(rng.integers(16, 81))


def _split(rng: np.random.Generator) -> dict[str, Any]:
    """Two idlers alike between an input and an output, at an angle at which the phases nearly close."""
    first, idler, last = _teeth(rng), _teeth(rng), _teeth(rng)
    upper, lower = first + idler, idler + last
    whole = int(rng.integers(1, first + idler))
    low, high = 0.05, 1.5
    for _ in range(60):  # [(z_a + z_b) theta_1 + (z_b + z_d) theta_2] / pi is to be whole
        theta = 0.5 * (low + high)
        turns = (upper * theta + lower * math.asin(min(upper * math.sin(theta) / lower, 1.0))) / math.pi
        low, high = (theta, high) if turns < whole else (low, theta)
    sine = upper * math.sin(theta) / lower
    if sine >= 1.0 or abs(turns - whole) > 1e-3:
        raise SceneError("angle", theta, "does not close")
    closing = math.asin(sine)
    width, module = _log(rng, 1e-6, 5e-6), _log(rng, 2e-6, 2e-5)
    shafts = {
        name: {"inertia": 0.5 * math.pi * _SILICON * width * (0.5 * module * z) ** 4, "teeth": z}
        for name, z in (("s0", first), ("s1", idler), ("s2", idler), ("s3", last))
    }
    ways = (("s0", "s1", theta), ("s0", "s2", -theta), ("s1", "s3", -closing), ("s2", "s3", None))
    meshes = {
        f"m{k}": {"driver": a, "driven": b} | ({} if angle is None else {"angle": angle})
        for k, (a, b, angle) in enumerate(ways, 1)
    }
    meshes["m2"]["offset"] = float(rng.choice([0.0, rng.uniform(-5e-9, 5e-9)]))
    return _rest(rng, shafts, meshes, module, width)


def _rest(
    rng: np.random.Generator,
    shafts: dict[str, Any],
    meshes: dict[str, Any],
    module: float,
    width: float,
) -> dict[str, Any]:
    """Everything but the graph."""
    sigma, names = _log(rng, 1e-9, 15e-9), list(shafts)
    torque = _log(rng, 1e-12, 1e-10) * rng.choice([1.0, 1.0, -1.0])
    speed = float(rng.choice([0.0, _log(rng, 1.0, 1e3), -_log(rng, 1.0, 1e3)], p=[0.3, 0.5, 0.2]))
    mesh: dict[str, Any] = {
        "module": module,
        "pressure_angle": math.radians(float(rng.choice([20.0, 25.0]))),
        "face_width": width,
        "backlash": float(0.04 * module * rng.random()),
        "tip_relief_radius": _log(rng, 3e-6, 3e-5),
        "radius_force": bool(rng.random() < 0.3),
        "damping": float(rng.choice([0.0, 1e-6])),
    }
    if rng.random() < 0.3:
        mesh["static_error"] = [{"order": int(rng.integers(1, 20)), "amplitude": sigma * rng.random()}]
    if rng.random() < 0.3:
        mesh |= {"pitch_error_rms": float(sigma * rng.random()), "pitch_error_seed": int(rng.integers(9))}
    if rng.random() < 0.2:
        mesh |= {"film_damping": _log(rng, 1e-6, 1e-4), "film_gap": 3.0 * sigma}
    for one in meshes.values():
        one["coating"] = {"sam_fraction": float(rng.choice([0.0, 1.0, rng.random()]))}
    drive: dict[str, Any] = {"torque": float(torque)}
    load: dict[str, Any] = {"shaft": names[-1]}
    if rng.random() < 0.4:
        load["torque"] = float(abs(torque) * rng.random())
    if rng.random() < 0.3:
        drive["harmonic"] = [{"amplitude": float(abs(torque)), "frequency": _log(rng, 1e3, 1e6)}]
    if rng.random() < 0.4:
        for shaft in shafts.values():
            shaft |= {"hub_friction": float(0.4 * rng.random()), "hub_radius": 0.5 * module}
    if rng.random() < 0.3:
        shafts[names[1]]["resistance"] = float(abs(torque) * 0.3 * rng.random())
    return tables(
        shafts=shafts,
        meshes=meshes,
        mesh=mesh,
        surface={
            "youngs_modulus": _log(rng, 50e9, 400e9),
            "poisson_ratio": 0.23,
            "energy": float(1.5 * rng.random()),
            "asperity_density": _log(rng, 1e13, 1e15),
            "asperity_radius": _log(rng, 5e-8, 1e-6),
            "roughness": sigma,
        },
        coating={
            "sam_fraction": 1.0,
            "energy": float(0.1 * rng.random()),
            "thickness": float(sigma * rng.choice([0.0, 0.3])),
        },
        contact={
            "bodies": "rigid",
            "asperity": str(rng.choice(["jkr", "dmt", "hertz", "maugis"], p=[0.6, 0.15, 0.15, 0.1])),
        },
        drive=drive,
        load=load,
        initial={
            "gear_speed": speed,
            "gap": float(rng.choice([0.5 * mesh["backlash"], sigma * rng.uniform(1.0, 8.0)])),
            "mesh_phase": float(rng.random()),
        },
        run={"duration": 1e-6, "samples": 41, "rtol": _log(rng, 1e-10, 1e-5)},
    )
