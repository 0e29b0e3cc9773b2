"""What the shell offers on the tab key beside commands and options: cases, presets, keys, pictures.

The shell asks the program itself each time, and gets what this version of it knows.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cyclopts.completion import CompletionContext


def presets(context: CompletionContext) -> Iterable[str]:
    """Offer the presets."""
    from gearidae.scene import PRESETS

    return list(PRESETS)


def cases(context: CompletionContext) -> Iterable[str]:
    """Offer presets, shipped cases, and the case files and folders that begin like the word.

    Parameters
    ----------
    context : CompletionContext
        Its ``incomplete`` is the word so far.
    """
    from gearidae.cli.case import shipped_cases

    folder, slash, begun = str(context.incomplete).rpartition("/")
    return [
        *_cases_in(Path(folder or slash or "."), f"{folder}{slash}", begun),
        *presets(context),
        *shipped_cases(),
    ]


def _cases_in(folder: Path, prefix: str, begun: str) -> Iterator[str]:
    """Go through case files and folders, and what is in those: a folder alone would be followed by a blank."""
    try:
        paths = sorted(path for path in folder.iterdir() if path.name.startswith(begun))
    except OSError:
        return
    for path in paths:
        if path.suffix == ".toml":
            yield f"{prefix}{path.name}"
        elif path.is_dir() and (begun or not path.name.startswith(".")):
            yield f"{prefix}{path.name}/"
            if len(paths) == 1:
                yield from _cases_in(path, f"{prefix}{path.name}/", "")


def keys(context: CompletionContext) -> Iterable[str]:
    """Offer the keys of a scene, ready for their value."""
    from gearidae.scene import describe_keys

    return [f"{info.key}=" for info in describe_keys()]


def pictures(context: CompletionContext) -> Iterable[str]:
    """Offer the pictures."""
    from gearidae.cli.pictures import picture_names

    return picture_names()
