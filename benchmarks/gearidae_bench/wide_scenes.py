"""Random scenes with the keys that came after the paper: other laws, sides and tables of coverage, drives, stops."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gearidae.scene import Scene
from gearidae_bench.random_scenes import random_scene

__all__ = ["wide_scene"]

_SHARE = 0.5
"""Share of the scenes that get any of these keys."""
_PLACES = (1, 2, 5, 64)
_ARGON = 0.165e-9  # [m], the interaction range of the presets

Changes = dict[str, Any]


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
        If the keys do not go together; the stress run lists such a scene as refused.
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
