"""What is sampled of a scene, and which rows its runs leave."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.laws.joints import JOINTS, PIN
from gearidae.laws.shafts import sampled_laws
from gearidae.records import Events, Impacts, Passages, Rows, sampled_columns
from gearidae.scene.joints import has_pin, joints

if TYPE_CHECKING:
    from gearidae.scene.scene import Scene


def columns_of(scene: Scene) -> tuple[str, ...]:
    """Names of the sampled columns of a scene."""
    contact, there = scene.contact, joints(scene)
    followed = len(JOINTS) if has_pin(scene) else PIN  # the pin is the last
    columns = sampled_columns(
        roller=scene.roller is not None,
        bodies=contact.bodies,
        roughness=contact.roughness,
        joints=followed if there else 0,
        ages=any(joint.rise > 0.0 for joint in there),
    )
    return columns if scene.gears is None else columns + sampled_laws(scene)


def rows_of(scene: Scene) -> tuple[type[Rows], ...]:
    """Kinds of rows that a run of a scene leaves."""
    has_passages = scene.roller is None and scene.run.passages
    impacts: tuple[type[Rows], ...] = (Impacts,) if scene.run.impacts else ()
    return (Events, Passages, *impacts) if has_passages else (Events, *impacts)
