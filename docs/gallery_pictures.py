"""Pictures of the gallery: the figures that a script of `examples` has drawn with `gd.plot`.

Sphinx-Gallery finds figures of pyplot by itself. Those of `gd.plot` are made without it, and are found by their names
in the script.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from weakref import WeakSet

from matplotlib.artist import Artist
from sphinx_gallery.scrapers import figure_rst

from gearidae.drawing.picture import Picture

_SHOWN: WeakSet[Picture] = WeakSet()
"""Figures that an earlier block has shown."""


def copy_scripts(source: Path, target: Path) -> str:
    """Copy the scripts with the case files, since they leave their files where they stand.

    Parameters
    ----------
    source, target : Path
        The root of the tree, and a folder to be made.

    Returns
    -------
    str
        The folder of the scripts.
    """
    folder = target / "examples"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(source / "examples", folder)
    shutil.copytree(source / "cases", folder / "cases")
    return str(folder)


def pictures(block: object, block_vars: Mapping[str, Any], gallery_conf: Mapping[str, Any]) -> str:
    """Save the figures that a block of a script has drawn, and return what shows them.

    Parameters
    ----------
    block : Block
        Of code; its text tells nothing here.
    block_vars, gallery_conf : mapping
        As Sphinx-Gallery hands them to a scraper.

    Returns
    -------
    str
        Text in reStructuredText.
    """
    paths = []
    for figure, path in zip(
        _new(block_vars["example_globals"]), block_vars["image_path_iterator"], strict=False
    ):
        figure.savefig(path, format="png")
        paths.append(path)
    return figure_rst(paths, gallery_conf["src_dir"])


def _new(names: Mapping[str, Any]) -> Iterator[Picture]:
    """Yield the figures that names of a script stand for, itself or by their axes, and that have not been shown."""
    for value in list(names.values()):
        figure = value.get_figure(root=True) if isinstance(value, Artist) else None
        if isinstance(figure, Picture) and figure not in _SHOWN:
            _SHOWN.add(figure)
            yield figure
