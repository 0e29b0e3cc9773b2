"""The attributes that readers rely on: looked at once, when an archive is opened, so that no reader trips over them."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from gearidae.archive.dataset import dimension_names
from gearidae.archive.variables import RUN, by_name
from gearidae.errors import SceneError
from gearidae.scene import Scene
from gearidae.scene.validity_row import ATTRIBUTE, holds_rows

__all__ = ["complete_scene", "readable_scene", "wrong_attribute"]

_LONGEST_TEXT = 100_000
"""Characters of a title, a history or the like."""
_LONGEST_SHOWN = 60
"""Characters of a wrong value that are repeated in the message."""
_TEXTS = ("title", "history", "source", "status", "message", "backend")
_NUMBERS = ("rtol", "t_end", "wall_time")
_COUNTS = tuple(name for name, variable in RUN.items() if variable.dtype is np.int64)
_NEEDED = (*_TEXTS, *_NUMBERS, *_COUNTS)
_MORE_TEXTS = (
    "method",
    "summary",
    "references",
    "license",
    "date_created",
    "product_version",
    "tabor_regime_bare",
    "tabor_regime_coated",
    "zipped",
)
_MORE_NUMBERS = ("tabor_parameter_bare", "tabor_parameter_coated")
_OF_VARIABLES = ("units", "long_name", "comment")


def wrong_attribute(ds: xr.Dataset) -> str:
    """Look for an attribute that is missing or that is not what gearidae writes there.

    Parameters
    ----------
    ds : xarray.Dataset
        As read from a file.

    Returns
    -------
    str
        What is wrong, in one line; empty if nothing is. Attributes that gearidae does not know are left alone.
    """
    missing = [name for name in _NEEDED if name not in ds.attrs]
    if missing:
        return f"it lacks {', '.join(missing)}"
    for name in (*_TEXTS, *_MORE_TEXTS):
        if name in ds.attrs and not _is_text(ds.attrs[name]):
            return _told(name, ds.attrs[name], f"a text of at most {_LONGEST_TEXT} characters")
    for name in (*_NUMBERS, *_COUNTS, *_MORE_NUMBERS):
        if name in ds.attrs and not _is_number(ds.attrs[name]):
            return _told(name, ds.attrs[name], "a number")
    for name, is_sound, allowed in _TABLES:
        if name in ds.attrs and not is_sound(_table(ds.attrs[name])):
            return _told(name, ds.attrs[name], allowed)
    if ATTRIBUTE in ds.attrs and not holds_rows(ds.attrs[ATTRIBUTE]):
        return _told(ATTRIBUTE, ds.attrs[ATTRIBUTE], "a list of the limits of the model as JSON")
    for name in dimension_names(_table(ds.attrs.get("swept", "{}")) or {}).values():
        if name not in ds.coords:
            return (
                f"its attribute swept is of {_shortened(name, _LONGEST_SHOWN)!r}, which it has no values of"
            )
    for variable in (one for one in ds.variables if one in _KNOWN):
        for name in _OF_VARIABLES:
            value = ds[variable].attrs.get(name, "")
            if not _is_text(value):
                return _told(f"{variable}:{name}", value, "a text")
    try:
        Scene.from_dict(readable_scene(ds.attrs["scene"]) or {})
    except SceneError as error:
        return f"its scene is no scene of this version ({_shortened(str(error), 300)})"
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


def _names_file(table: object) -> bool:
    """Whether a table of a scene would read a file; archives hold numbers, and must not make a reader open others."""
    return isinstance(table, dict) and any(isinstance(one, dict) and "file" in one for one in table.values())


def _is_text(value: object) -> bool:
    return isinstance(value, str) and len(value) <= _LONGEST_TEXT


def _is_number(value: object) -> bool:
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


def _table(text: object) -> dict[str, Any] | None:
    """Read a table from JSON; None if it is none."""
    try:
        table = json.loads(text) if isinstance(text, str) else None
    except (ValueError, RecursionError):
        return None
    return table if isinstance(table, dict) else None


def _of_numbers(table: Mapping[str, Any] | None) -> bool:
    return table is not None and all(map(_is_number, table.values()))


def _of_values(table: Mapping[str, Any] | None) -> bool:
    plain = (int, float, str, type(None))
    return table is not None and all(isinstance(value, plain) for value in table.values())


def _of_lists(table: Mapping[str, Any] | None) -> bool:
    return table is not None and all(isinstance(value, list) for value in table.values())


_TABLES = (
    ("energy_balance", _of_numbers, "a table of numbers as JSON"),
    ("ledger", _of_numbers, "a table of numbers as JSON"),  # its name in archives of version 0.1
    ("account", _of_values, "a table of numbers and words as JSON"),
    ("swept", _of_lists, "a table of lists as JSON"),
)
_KNOWN = frozenset(by_name())


def _told(name: str, value: object, allowed: str) -> str:
    return f"its attribute {name} must be {allowed}, and is {_described(value)}"


def _described(value: object) -> str:
    if isinstance(value, str):
        return f"a text of {len(value)} characters, {_shortened(value, _LONGEST_SHOWN)!r}"
    shape = np.shape(value) if isinstance(value, np.ndarray | list) else ()
    if shape:
        return f"an array of {math.prod(shape)} values"
    return f"{_shortened(repr(value), _LONGEST_SHOWN)} ({type(value).__name__})"


def _shortened(text: str, length: int) -> str:
    return text if len(text) <= length else f"{text[:length]}..."
