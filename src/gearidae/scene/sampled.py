"""What is sampled of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.records import sampled_columns
from gearidae.scene.joints import has_pin, joints

if TYPE_CHECKING:
    from gearidae.scene.scene import Scene


def columns_of(scene: Scene) -> tuple[str, ...]:
    """Names of the sampled columns of a scene."""
    contact, hubs = scene.contact, bool(joints(scene))
    return sampled_columns(
        roller=scene.roller is not None,
        bodies=contact.bodies,
        roughness=contact.roughness,
        hubs=hubs,
        pin=hubs and has_pin(scene),
    )
