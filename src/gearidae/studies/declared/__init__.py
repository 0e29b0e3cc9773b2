"""The studies, one file each, which is found by itself: no list names it.

A file declares its `Study` as ``STUDY``; its docstring is the help of the command, whose name is that of the file, and
the function of `gearidae.studies` has the file's name too, unless that package says otherwise. Importing it loads
neither the engine nor matplotlib: those who read a file of the study import it too.
"""

from __future__ import annotations

import pkgutil
from functools import cache
from importlib import import_module
from importlib.resources import files
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gearidae.studies.study import Study


@cache
def command_help() -> dict[str, str]:
    """Help of each command, by its name; the files are read and not run, which would take longer."""
    texts = {}
    for module in pkgutil.iter_modules(__path__):
        source = (files(__name__) / f"{module.name}.py").read_text(encoding="utf-8")
        texts[module.name.replace("_", "-")] = source.split('"""')[1].strip()
    return texts


def study_of_command(name: str) -> Study:
    """Return the study that a command runs."""
    study: Study = import_module(f"{__name__}.{name.replace('-', '_')}").STUDY
    return study


@cache
def studies() -> dict[str, Study]:
    """Return all studies by the kinds of their files."""
    from gearidae.studies.study import Study

    by_kind: dict[str, Study] = {}
    for module in pkgutil.iter_modules(__path__):
        declared = vars(import_module(f"{__name__}.{module.name}")).values()
        for study in declared:
            if isinstance(study, Study):
                by_kind.setdefault(study.kind, study)
    return by_kind
