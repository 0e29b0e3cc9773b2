"""Case files: one scene each, in TOML."""

from __future__ import annotations

import os
import re
from pathlib import Path

from gearidae.errors import SceneError
from gearidae.scene.group import shorten
from gearidae.scene.literal import read_toml
from gearidae.scene.scene import Scene
from gearidae.scene.schedule_table import in_folder

_LINE = re.compile(r"\(at line (\d+),")
_BARE_UNIT = re.compile(
    r"[=\[,]\s*([+-]?\d[\d_.]*(?:[eE][+-]?\d+)?\s*(?:1\s*/\s*)?(?:[^\W\d]|%)[^,#\]}\"']*)"
)
"""A number with a unit where a value begins, up to where it ends; no text is quoted in it."""
_LARGEST = 1_000_000  # bytes; a scene takes two thousand


def load_case(path: str | os.PathLike[str]) -> Scene:
    """Read a scene from a case file.

    Parameters
    ----------
    path : str or path-like
        A TOML file. Its ``name``, or else the file's own, becomes the scene's.

    Returns
    -------
    Scene

    Raises
    ------
    SceneError
        If there is no such file, it cannot be read, is no TOML, or describes no scene.
    """
    if not isinstance(path, (str, os.PathLike)):
        raise SceneError("case file", shorten(path), "must be a path")
    text = _read(path)
    try:
        data = read_toml(text)
    except ValueError as error:  # not TOMLDecodeError alone: integers of thousands of digits fail otherwise
        raise SceneError(
            "case file", shorten(os.fspath(path)), f"is not TOML: {error}{_unquoted(text, error)}"
        ) from error
    if not data:
        raise SceneError("case file", shorten(os.fspath(path)), "is empty")
    data.pop("$schema", None)  # for editors: where the schema of case files is
    data.setdefault("name", _stem(path))
    _find_files(data, Path(path).parent)
    return Scene.from_dict(data)


def _unquoted(text: str, error: ValueError) -> str:
    """Advise to quote a number with its unit, where that is what TOML does not understand; else nothing."""
    found = _LINE.search(str(error))
    bare = found and _BARE_UNIT.search(text.splitlines()[int(found[1]) - 1])
    return f': quote a number with its unit, "{bare[1].strip()}"' if bare else ""


def _find_files(data: dict[str, object], folder: Path) -> None:
    """Let files that schedules and lists name lie beside the case file."""
    for name in ("drive", "load", "contact", "mesh"):
        table = data.get(name)
        if isinstance(table, dict):
            for key in ("schedule", "speed", "asperities", "pinion_pitch_error", "gear_pitch_error"):
                if key in table:
                    table[key] = in_folder(table[key], folder)


def _read(path: str | os.PathLike[str]) -> str:
    """Read a file's text, no more of it than a case file may be long."""

    def refuse(reason: str) -> SceneError:
        return SceneError("case file", shorten(os.fspath(path)), reason)

    try:
        if Path(path).exists() and not (Path(path).is_file() or Path(path).is_dir()):
            raise refuse("is a pipe or a device, which may have no end: write it to a file first")
        with Path(path).open("rb") as file:
            content = file.read(_LARGEST + 1)
    except SceneError:
        raise
    except FileNotFoundError as error:
        raise refuse("no such file") from error
    except IsADirectoryError as error:
        raise refuse("is a folder, not a file") from error
    except (OSError, ValueError, TypeError) as error:
        raise refuse(f"cannot be read: {getattr(error, 'strerror', None) or error}") from error
    if len(content) > _LARGEST:
        raise refuse(f"is longer than {_LARGEST} bytes: not a case file")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise refuse("is not a text file in UTF-8") from error


def _stem(path: str | os.PathLike[str]) -> str:
    """Name a scene after its file, without what could not stand in a title."""
    stem = "".join(char if char.isprintable() else "_" for char in Path(path).stem)
    return stem.strip()[:200] or "scene"
