"""Everything compiled ahead of the first run: for a class, an image of a container, or a machine without a rush."""

from __future__ import annotations

from typing import Any, Final

from gearidae.runs.simulation import simulate
from gearidae.scene import Scene, preset

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
    for scene in scenes():
        for backend in ("auto", "sksundae"):
            simulate(scene, backend=backend)
