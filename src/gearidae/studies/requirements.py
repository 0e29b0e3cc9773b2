"""What studies need of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.errors import SceneError

if TYPE_CHECKING:
    from gearidae.scene import Scene


def require_constant(scene: Scene, study: str, why: str, keys: tuple[str, ...] = ("drive", "load")) -> None:
    """Refuse torques and speeds that follow a schedule.

    Parameters
    ----------
    scene : Scene
        With gears.
    study : str
        What needs constant ones.
    why : str
        The reason.
    keys : tuple of str, optional
        Tables that may not have schedules.

    Raises
    ------
    SceneError
        If there is a schedule, with the way out.
    """
    tables = scene.to_dict()
    for table in keys:
        content = tables.get(table) or {}
        if content.get("schedule"):
            allowed = (
                f"{study} needs constant torques ({why}): set {table}.torque and take the schedule away "
            )
            raise SceneError(
                f"{table}.schedule", "a schedule", f"{allowed}({table}.schedule=[]), or use sweep"
            )
        if isinstance(content.get("speed"), dict | list):
            allowed = f"{study} needs a constant speed ({why}): set {table}.speed to a number, or use sweep"
            raise SceneError(f"{table}.speed", "a schedule", allowed)
