"""Pictures as files, written whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure, SubFigure

from gearidae.archive import target
from gearidae.drawing.picture import is_set
from gearidae.errors import SceneError

_DPI = 200.0
BY_FFMPEG = ("mp4", "webm")
"""Endings of moving pictures that need ffmpeg."""
_NOTE = {"png": {"Comment": target.MADE_BY}}
"""What a picture says of itself, of the ending that the command line gives by itself."""
MOVING = ("gif", "webp", *BY_FFMPEG)
"""Endings of moving pictures."""


def write(
    figure: Figure | SubFigure,
    path: str | os.PathLike[str],
    *,
    overwrite: bool = False,
    dpi: float | None = None,
) -> Path:
    """Write a figure to a file.

    Parameters
    ----------
    figure : matplotlib Figure or SubFigure
        From one of the functions of `gearidae.plot` (``ax.figure`` for those that return axes).
    path : path-like
        File to write; its extension determines the format (png, pdf, svg and whatever else matplotlib knows).
    overwrite : bool, optional
        Whether a file that is there may be replaced.
    dpi : float, optional
        Dots per inch of formats that have dots; by default ``savefig.dpi`` of matplotlib's settings, or 200.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    SceneError
        If the file exists and may not be replaced, the format is not known, or it cannot be written.
    """
    root = figure.get_figure(root=True)
    assert root is not None
    with whole_file(path, root.canvas.get_supported_filetypes(), overwrite=overwrite) as part:
        if dpi is None:
            dpi = float(mpl.rcParams["savefig.dpi"]) if is_set("savefig.dpi") else _DPI
        with mpl.rc_context({"svg.fonttype": "none"}):  # text stays text
            root.savefig(part, format=_kind(part), dpi=dpi, metadata=_NOTE.get(_kind(part)))
    return Path(path)


@contextmanager
def whole_file(
    path: str | os.PathLike[str], known: Collection[str], *, overwrite: bool = False
) -> Iterator[Path]:
    """Let a file be written that appears whole or not at all.

    Parameters
    ----------
    path : path-like
        File to write.
    known : collection of str
        Endings allowed, without the dot.
    overwrite : bool, optional
        Whether a file that is there may be replaced.

    Yields
    ------
    Path
        Where to write it, a file beside with the same ending.

    Raises
    ------
    SceneError
        If the file exists and may not be replaced, its ending is not known, or it cannot be written.
    """
    ending = _kind(Path(path))
    if ending not in known:
        endings = ", ".join(f".{suffix}" for suffix in sorted(known))
        raise SceneError("picture", path, f"must end in one of {endings}")
    with target.whole_file(path, overwrite=overwrite, name="picture", ending=f".{ending}") as part:
        yield part


def note_in_gif(path: Path) -> None:
    """Say in a GIF of several pictures that this program made it, as a comment behind the colours of all pictures."""
    content = path.read_bytes()
    has_colours, colours = content[10] & 0x80, content[10] & 0x07
    at = 13 + (3 << (colours + 1) if has_colours else 0)
    text = target.MADE_BY.encode()
    comment = b"\x21\xfe" + bytes([len(text)]) + text + b"\x00"
    path.write_bytes(content[:at] + comment + content[at:])


def _kind(path: Path) -> str:
    return path.suffix.removeprefix(".").lower()
