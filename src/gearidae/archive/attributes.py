"""The attributes that every archive has, and its scene."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from gearidae.archive.variables import RUN
from gearidae.errors import SceneError
from gearidae.scene import Scene
from gearidae.scene.older_names import with_new_names

_TEXTS = ("title", "history", "source", "status", "message", "backend")
_MORE_TEXTS = ("method", "summary", "references", "license", "date_created", "product_version", "zipped")
_NUMBERS = ("rtol", "t_end", "wall_time", *(n for n, variable in RUN.items() if variable.dtype is np.int64))


def wrong_attribute(ds: xr.Dataset) -> str:
    """Look for an attribute that is missing, or of another kind than gearidae writes.

    Parameters
    ----------
    ds : xarray.Dataset
        As read from a file.

    Returns
    -------
    str
        What is wrong, in one line; empty if nothing is.
    """
    missing = [name for name in (*_TEXTS, *_NUMBERS) if name not in ds.attrs]
    if missing:
        return f"it lacks {', '.join(missing)}"
    texts, numbers = {*_TEXTS, *_MORE_TEXTS}, {*_NUMBERS}
    for name, value in ds.attrs.items():
        if name in texts and not isinstance(value, str):
            return f"its attribute {name} must be a text"
        if name in numbers and not isinstance(value, int | float | np.number):
            return f"its attribute {name} must be a number"
    try:
        Scene.from_dict(readable_scene(ds.attrs["scene"]) or {})
    except SceneError as error:
        return f"its scene is no scene of this version ({str(error)[:300]})"
    return ""


def readable_scene(text: object) -> dict[str, Any] | None:
    """Read a scene as plain tables; None if it is not what a scene can look like."""
    scene = _table(text)
    if not scene:
        return None
    complete_scene(scene)
    if any(_names_file(table) for table in scene.values()):
        return None
    return scene if all(isinstance(table, dict) or key == "name" for key, table in scene.items()) else None


def complete_scene(scene: dict[str, Any]) -> None:
    """Put into a scene of an older archive, in place, what went without saying then."""
    if isinstance(scene.get("mesh"), dict):
        scene["mesh"].setdefault("radius_force", False)
    if isinstance(scene.get("contact"), dict):
        scene["contact"] = with_new_names(scene["contact"], quiet=True)


def _names_file(table: object) -> bool:
    """Whether a table of a scene would read a file; archives hold numbers, and must not make a reader open others."""
    return isinstance(table, dict) and any(
        isinstance(entry, dict) and "file" in entry for entry in table.values()
    )


def _table(text: object) -> dict[str, Any] | None:
    """Read a table from JSON; None if it is none."""
    try:
        table = json.loads(text) if isinstance(text, str) else None
    except (ValueError, RecursionError):
        return None
    return table if isinstance(table, dict) else None
