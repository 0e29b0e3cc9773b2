"""What is sampled of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.records import sampled_columns

if TYPE_CHECKING:
    from gearidae.scene.scene import Scene


def columns_of(scene: Scene) -> tuple[str, ...]:
    """Names of the sampled columns of a scene."""
    roller, contact = scene.roller is not None, scene.contact
    return sampled_columns(roller=roller, bodies=contact.bodies, roughness=contact.roughness)
