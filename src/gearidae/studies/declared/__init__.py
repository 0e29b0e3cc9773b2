"""The studies, one file each, which is found by itself: no list names it.

A file declares its `Study` as ``STUDY``; its docstring is the help of the command, whose name is that of the file, and
the function of `gearidae.studies` has the file's name too, unless that package says otherwise. Importing it loads
neither the engine nor matplotlib: those who read a file of the study import it too.

Files stand in this folder, and in those of the packages that use the core (`FOLDERS`), which are not imported before a
study is asked for.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Final

import gearidae

if TYPE_CHECKING:
    from gearidae.studies.study import Study

FOLDERS: Final = (
    "gearidae.studies.declared",
    "gearidae.monitor.declared",
    "gearidae.wear.declared",
    "gearidae.calibration.declared",
)
"""Packages whose files declare studies."""


def _files() -> list[tuple[str, str, Path]]:
    """Name, package and path of each file, in the order of the names; no package is imported."""
    root = Path(gearidae.__path__[0])
    return sorted(
        (path.stem, folder, path)
        for folder in FOLDERS
        for path in root.joinpath(*folder.split(".")[1:]).glob("*.py")
        if path.stem != "__init__"
    )


@cache
def command_help() -> dict[str, str]:
    """Help of each command, by its name; the files are read and not run, which would take longer."""
    return {
        name.replace("_", "-"): path.read_text(encoding="utf-8").split('"""')[1].strip()
        for name, _, path in _files()
    }


def study_of_command(command: str) -> Study:
    """Return the study that a command runs.

    Raises
    ------
    KeyError
        If there is no such command.
    """
    name = command.replace("-", "_")
    folders = {name: folder for name, folder, _ in _files()}
    study: Study = import_module(f"{folders[name]}.{name}").STUDY
    return study


@cache
def studies() -> dict[str, Study]:
    """Return all studies by the kinds of their files."""
    from gearidae.studies.study import Study

    by_kind: dict[str, Study] = {}
    for name, folder, _ in _files():
        for study in vars(import_module(f"{folder}.{name}")).values():
            if isinstance(study, Study):
                by_kind.setdefault(study.kind, study)
    return by_kind
