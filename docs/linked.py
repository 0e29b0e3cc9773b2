"""Names of other libraries that the reference links to: inventories for intersphinx, written from this list.

The libraries' own inventories would have to be fetched in each build, which would need a network and change with their
releases.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple


class Library(NamedTuple):
    """Pages of a library.

    Attributes
    ----------
    url : str
    classes : mapping of str to str
        Page of each class, by its full name; ``$`` stands for the name.
    texts : mapping of str to str, optional
        Page of each term of the glossary and each label, by kind and name: ``"std:term sequence"``.
    """

    url: str
    classes: Mapping[str, str]
    texts: Mapping[str, str] = {}


LIBRARIES: Mapping[str, Library] = {
    "xarray": Library(
        "https://docs.xarray.dev/en/stable/",
        dict.fromkeys(("xarray.Dataset", "xarray.DataArray"), "generated/$.html#$"),
    ),
    "numpy": Library(
        "https://numpy.org/doc/stable/",
        {
            "numpy.ndarray": "reference/generated/$.html#$",
            "numpy.typing.ArrayLike": "reference/typing.html#$",
        },
    ),
    "pandas": Library("https://pandas.pydata.org/docs/", {"pandas.DataFrame": "reference/api/$.html#$"}),
    "matplotlib": Library(
        "https://matplotlib.org/stable/",
        dict.fromkeys(("matplotlib.axes.Axes", "matplotlib.figure.Figure"), "api/_as_gen/$.html#$"),
    ),
    "python": Library(
        "https://docs.python.org/3/",
        {
            "pathlib.Path": "library/pathlib.html#$",
            "concurrent.futures.Executor": "library/concurrent.futures.html#$",
            **dict.fromkeys(("int", "float"), "library/functions.html#$"),
            **dict.fromkeys(("str", "tuple", "list", "dict"), "library/stdtypes.html#$"),
        },
        {  # numpydoc links `bool`, `sequence` and so on to these
            "std:label bltin-boolean-values": "library/stdtypes.html#boolean-type-bool",
            "std:term sequence": "glossary.html#term-sequence",
            "std:term iterable": "glossary.html#term-iterable",
        },
    ),
}

_FULL = [name for library in LIBRARIES.values() for name in library.classes]
SHORT_NAMES = {
    **{name: name for name in _FULL},
    **{name.rpartition(".")[2]: name for name in _FULL},
    "array_like": "numpy.typing.ArrayLike",
    "path-like": "pathlib.Path",
}
"""What docstrings call these classes."""

IN_SIGNATURES = {
    "xr.Dataset": "xarray.Dataset",
    "xr.DataArray": "xarray.DataArray",
    "pd.DataFrame": "pandas.DataFrame",
    "ArrayLike": "numpy.typing.ArrayLike",
    "Axes": "matplotlib.axes.Axes",
    "Figure": "matplotlib.figure.Figure",
}
"""What signatures call them: annotations are not evaluated where a library is imported for types only."""

_HEAD = (
    "# Sphinx inventory version 2\n# Project: {}\n# Version: \n"
    "# The remainder of this file is compressed using zlib.\n"
)


def write_inventories(folder: Path) -> dict[str, tuple[str, str]]:
    """Write the inventories, and return the mapping that intersphinx takes.

    Parameters
    ----------
    folder : Path
        Where to write them.
    """
    folder.mkdir(parents=True, exist_ok=True)
    mapping = {}
    for name, library in LIBRARIES.items():
        pages = {full: page.replace("$", full) for full, page in library.classes.items()}
        pages |= {name: pages[full] for name, full in IN_SIGNATURES.items() if full in pages}
        lines = [f"{entry} py:class 1 {page} -\n" for entry, page in pages.items()]
        for entry, page in library.texts.items():
            kind, _, name_of_text = entry.partition(" ")
            lines.append(f"{name_of_text} {kind} 1 {page} -\n")
        target = folder / f"{name}.inv"
        content = _HEAD.format(name).encode() + zlib.compress("".join(lines).encode())
        if not target.exists() or target.read_bytes() != content:
            target.write_bytes(content)
        mapping[name] = (library.url, str(target))
    return mapping
