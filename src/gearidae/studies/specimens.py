"""Gears of one design: a scene with the seeds of one gear after the other."""

from __future__ import annotations

from collections.abc import Sequence
from operator import attrgetter
from typing import TYPE_CHECKING, Final

from gearidae.errors import SceneError
from gearidae.scene import require_meshes
from gearidae.scene.quantity import whole

if TYPE_CHECKING:
    from gearidae.scene import Scene
    from gearidae.scene.train import TrainMesh

MOST_SEEDS: Final = 10_000
POPULATION: Final = "contact.seed"
TEETH: Final = "mesh.pitch_error_seed"
NEEDS: Final = {
    POPULATION: 'needs contact.roughness = "discrete": statistical ones draw nothing',
    TEETH: "needs mesh.pitch_error_rms above 0: nothing is drawn else",
}
"""Of each key of seeds, what it takes that something is drawn by it."""


def gears_text(count: int) -> str:
    """Write a number of gears."""
    return "1 gear" if count == 1 else f"{count} gears"


def seeds_that_draw(scene: Scene) -> tuple[str, ...]:
    """Keys of seeds by which something is drawn: a population, errors of teeth, of a train in any of its meshes."""
    draws = {
        POPULATION: scene.contact.is_discrete,
        TEETH: any(mesh.mesh.pitch_error_rms > 0.0 for mesh in _meshes(scene)),
    }
    return tuple(key for key, is_drawn in draws.items() if is_drawn)


def _meshes(scene: Scene) -> Sequence[TrainMesh]:
    return () if scene.roller is not None else require_meshes(scene).train.meshes


def seed_of(scene: Scene) -> int:
    """Number by which a gear is called: its first seed of those that draw."""
    return int(attrgetter((*seeds_that_draw(scene), POPULATION)[0])(scene))


def gear_of(scene: Scene, number: int) -> dict[str, int]:
    """Seeds of a gear, counted from 0 for the one of the scene itself, by their keys."""
    return {key: attrgetter(key)(scene) + number for key in seeds_that_draw(scene)}


def gears_of(scene: Scene, count: int) -> Sequence[dict[str, int]]:
    """Seeds of as many gears of one design, all of them numbered from the scene's own on.

    Raises
    ------
    SceneError
        If the number is not allowed, or nothing is drawn by a seed.
    """
    count = whole("seeds", count, 1, MOST_SEEDS)
    if not seeds_that_draw(scene):
        allowed = (
            'needs contact.roughness = "discrete", or mesh.pitch_error_rms above 0: others do not differ by '
            "their seeds"
        )
        raise SceneError("seeds", count, allowed)
    return [gear_of(scene, number) for number in range(count)]
