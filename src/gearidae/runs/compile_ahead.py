"""Everything compiled ahead of the first run: for a class, an image of a container, or a machine without a rush."""

from __future__ import annotations

from typing import Any, Final

from gearidae.engine.beside import LOOP, compile_side_by_side
from gearidae.engine.compiling import (
    ELASTIC,
    EXPOSURES,
    FRICTION,
    IMPACTS,
    POPULATION,
    SOLVER,
    compiling,
)
from gearidae.engine.train import solve_train
from gearidae.runs.simulation import simulate
from gearidae.scene import Scene, TrainScene, preset, require_gears

_GEARS: Final = "teodorescu2009_low_speed"
SCENES: Final[tuple[tuple[str, dict[str, Any]], ...]] = (
    (_GEARS, {}),
    (_GEARS, {"contact.bodies": "elastic"}),
    (_GEARS, {"contact.roughness": "discrete"}),
    (_GEARS, {"contact.friction": 0.1, "gears.hub_friction": 0.1, "gears.gear_hub_radius": 5e-6}),
    (_GEARS, {"contact.roughness": "discrete", "contact.friction": 0.1}),
    (_GEARS, {"run.exposures": 2, "surface.hamaker": 1e-21, "run.impacts": True}),
    ("roller_slow", {"contact.bodies": "rigid"}),
    ("roller_slow", {"contact.bodies": "elastic"}),
)
"""Presets and changes that together need every part of the engine."""


def scenes() -> list[Scene]:
    """Return the scenes that together need every part of the engine, each with a moment to run."""
    moment = {"run.duration": 1e-6, "run.samples": 3}
    return [preset(name).replace({**changes, **moment}) for name, changes in SCENES]


def train() -> TrainScene:
    """Return a train of two meshes with a moment to run."""
    pair = require_gears(preset(_GEARS).replace({"run.duration": 1e-8, "run.samples": 3}))
    data, gears, geometry = pair.to_dict(), pair.gears, pair.geometry
    del data["gears"]
    sizes = {"pressure_angle": gears.pressure_angle, "face_width": gears.face_width}
    teeth = gears.pinion_teeth, gears.gear_teeth, gears.pinion_teeth
    data["shafts"] = {f"shaft_{i}": {"teeth": z, "inertia": gears.gear_inertia} for i, z in enumerate(teeth)}
    data["meshes"] = {
        f"mesh_{i}": {
            "driver": f"shaft_{i}",
            "driven": f"shaft_{i + 1}",
            "driver_base_radius": radius,
            **sizes,
        }
        for i, radius in enumerate((geometry.base_radius_pinion, geometry.base_radius_gear))
    }
    scene = Scene.from_dict(data)
    assert isinstance(scene, TrainScene)
    return scene


def compile() -> None:  # noqa: A001
    """Compile the whole engine for this machine, or nothing of what has been kept from before.

    Runs compile what they need the first time, which takes about a minute for the first one and some ten seconds for
    elastic contacts, discrete asperities, friction and exposures. This does all of it, with both drivers.
    What is compiled is kept, also for other processes and environments with the same versions. Torque laws of a user
    are compiled in each process.

    Examples
    --------
    >>> import gearidae as gd
    >>> gd.compile()  # doctest: +SKIP
    """
    with compiling("the engine", "for a minute or two"):
        compile_side_by_side((SOLVER, LOOP, ELASTIC, FRICTION, POPULATION, EXPOSURES, IMPACTS))
    for backend in ("auto", "sksundae"):
        for scene in scenes():
            simulate(scene, backend=backend)
        solve_train(train(), backend=backend)
