"""Pictures as files, written whole or not at all."""

from __future__ import annotations

import os
import secrets
from pathlib import Path

from matplotlib.figure import Figure

from gearidae.errors import SceneError

__all__ = ["write"]


def write(
    figure: Figure, path: str | os.PathLike[str], *, overwrite: bool = False, dpi: float = 200.0
) -> Path:
    """Write a figure to a file.

    Parameters
    ----------
    figure : matplotlib Figure
        From one of the functions of `gearidae.plot` (``ax.figure`` for those that return axes).
    path : path-like
        File to write; its ending tells the format (png, pdf, svg and whatever else matplotlib knows).
    overwrite : bool, optional
        Whether a file that is there may be replaced.
    dpi : float, optional
        Dots per inch of formats that have dots.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    SceneError
        If the file exists and may not be replaced, the format is not known, or it cannot be written.
    """
    target = Path(path)
    known = figure.canvas.get_supported_filetypes()
    kind = target.suffix.removeprefix(".").lower()
    if kind not in known:
        raise SceneError(
            "picture", path, f"must end in one of {', '.join(f'.{each}' for each in sorted(known))}"
        )
    if target.is_dir() or (target.exists() and not overwrite):
        raise SceneError("picture", path, "exists already: name another with -o, or allow --overwrite")
    part = target.with_name(f".{target.name}.{os.getpid()}-{secrets.token_hex(4)}.part")
    try:
        figure.savefig(part, format=kind, dpi=dpi)
        part.replace(target)
    except OSError as error:
        raise SceneError("picture", path, f"cannot be written ({error.strerror})") from error
    finally:
        part.unlink(missing_ok=True)
    return target
