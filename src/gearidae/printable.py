"""Texts from files and names as a terminal or a page can show them."""

from __future__ import annotations

import unicodedata


def printable(text: str) -> str:
    r"""Write characters that act on a terminal, or that no encoding has, as their escapes: ``\x1b``, ``\udcff``.

    Returns
    -------
    str
        The text without control and format characters other than line feeds and tabs, and without surrogates.
    """
    if text.isprintable():
        return text
    return "".join(
        char.encode("unicode_escape").decode("ascii")
        if char not in "\n\t" and unicodedata.category(char) in ("Cc", "Cf", "Cs")
        else char
        for char in text
    )
