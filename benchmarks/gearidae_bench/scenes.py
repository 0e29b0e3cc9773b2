"""The scenes of the benchmark.

Most use the asperity model, whose equations are ordinary ones: only those can be solved by every contender. Those of
real asperities are for contenders that begin anew where forces jump.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from gearidae.errors import SceneError
from gearidae.scene import Scene, preset

__all__ = ["SCENES", "BenchScene", "find_scenes"]

SAMPLES: Final = 201


@dataclass(frozen=True, slots=True)
class BenchScene:
    """A scene that run time against error is measured on.

    Attributes
    ----------
    name : str
        Short name: what ``--scenes`` takes, and part of file names.
    title : str
        For tables and pictures.
    scene : Scene
        With `SAMPLES` samples.
    """

    name: str
    title: str
    scene: Scene


def _scene(
    name: str, title: str, start: str, changes: Mapping[str, float], roughness: str = "statistical"
) -> BenchScene:
    scene = preset(start).replace(
        {**changes, "contact.bodies": "rigid", "contact.roughness": roughness, "run.samples": SAMPLES}
    )
    return BenchScene(name, title, scene)


def _population(name: str, words: str, fraction: float) -> BenchScene:
    """Real asperities at high speed, with 5 % of critical damping: without it, motions of worn teeth are chaotic."""
    changes = {"run.duration": 0.06e-3, "mesh.damping": 7e-6, "coating.sam_fraction": fraction}
    title = f"real asperities at high speed, {words}, damped, 0.06 ms"
    return _scene(name, title, _HIGH, changes, "discrete")


_LOW, _HIGH = "teodorescu2009_low_speed", "teodorescu2009"

SCENES: Final[Mapping[str, BenchScene]] = {
    s.name: s
    for s in (
        _scene("low_sam", "low speed, full coverage, 50 ms", _LOW, {"run.duration": 0.05}),
        _scene(
            "low_worn",
            "low speed, 60 % coverage, 50 ms",
            _LOW,
            {"run.duration": 0.05, "coating.sam_fraction": 0.6},
        ),
        _scene("high_sam", "high speed, full coverage, 0.5 ms", _HIGH, {"run.duration": 0.5e-3}),
        _scene(
            "high_bare",
            "high speed, bare silicon, 0.5 ms",
            _HIGH,
            {"run.duration": 0.5e-3, "coating.sam_fraction": 0.0},
        ),
        _scene(
            "roller_slow_sam",
            "roller at 0.01 m/s, full coverage",
            "roller_slow",
            {"coating.sam_fraction": 1.0},
        ),
        _scene("roller_slow_bare", "roller at 0.01 m/s, bare silicon", "roller_slow", {}),
        _scene(
            "roller_fast_sam",
            "roller at 0.1 m/s, full coverage",
            "roller_fast",
            {"coating.sam_fraction": 1.0},
        ),
        _scene("roller_fast_bare", "roller at 0.1 m/s, bare silicon", "roller_fast", {}),
        _population("population_sam", "full coverage", 1.0),
        _population("population_worn", "50 % coverage", 0.5),
        _population("population_bare", "bare silicon", 0.0),
    )
}
"""All scenes by name, in the order of the tables."""


def find_scenes(names: tuple[str, ...]) -> tuple[BenchScene, ...]:
    """Look scenes up; no names mean all.

    Raises
    ------
    SceneError
        If there is no scene of that name.
    """
    for name in names:
        if name not in SCENES:
            raise SceneError("scenes", name, f"no such benchmark scene; known are {', '.join(SCENES)}")
    return tuple(SCENES[name] for name in names or SCENES)
