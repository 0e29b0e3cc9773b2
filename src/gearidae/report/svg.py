"""Figures as drawings inside a page, in colours that follow the page's light or dark scheme."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from gearidae.report import html

_ON_DARK = {
    "#0072b2": "#4da6e0",
    "#d55e00": "#f08040",
    "#009e73": "#2fc79b",
    "#cc79a7": "#e39ac2",
    "#e69f00": "#f0b840",
    "#56b4e9": "#8fd0f5",
}
"""The palette of the pictures, as bright as a dark ground needs; the same as in ``common.js``."""
_MOST_CORNERS = 2000
_DPI = 200
_INK_ON_DARK, _DARK_GROUND = (0xE6, 0xE8, 0xEA), (0x15, 0x18, 0x1B)
_COLOUR = re.compile(r"#[0-9a-f]{6}\b")
_OWN_COLOUR = re.compile(r"var\(--c-([0-9a-f]{6})\)")
_ATTRIBUTE = re.compile(r' (fill|stroke)="(#[0-9a-f]{6})"')
_LONG_NUMBER = re.compile(r"(-?\d+\.\d\d)\d+")
_UNWANTED = (
    re.compile(r"<metadata>.*?</metadata>", re.DOTALL),
    re.compile(r"<style[^>]*>.*?</style>", re.DOTALL),
    re.compile(r"<!--.*?-->", re.DOTALL),
)


def drawing(figure: Figure, prefix: str, title: str) -> str:
    """Turn a figure into an SVG element of a page.

    Parameters
    ----------
    prefix : str
        Begins the names of its parts, which must differ from those of other drawings in the page.
    title : str
        What is seen, for those who do not see it.

    Returns
    -------
    str
        Without a ground, with text as text, colours as variables that `colour_rules` defines, and lengths to a
        hundredth of a point.
    """
    for ax in figure.axes:
        for area in ax.collections:
            # filled areas of a whole record are megabytes of corners; their colours are seen on either ground
            corners = sum(np.shape(path.vertices)[0] for path in area.get_paths())
            area.set_rasterized(corners > _MOST_CORNERS)
    stream = io.StringIO()
    # a fixed salt, so that the same archive makes the same page
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": prefix}):
        figure.savefig(stream, format="svg", dpi=_DPI, transparent=True, metadata={"Date": None})
    text = stream.getvalue()
    text = text[text.index("<svg") :]
    for unwanted in _UNWANTED:
        text = unwanted.sub("", text)
    text = re.sub(r'\bid="([^"]*)"', rf'id="{prefix}-\1"', text)
    text = re.sub(r'href="#([^"]*)"', rf'href="#{prefix}-\1"', text)
    text = re.sub(r"url\(#([^)]*)\)", rf"url(#{prefix}-\1)", text)
    text = _ATTRIBUTE.sub(r' style="\1: \2"', text)
    text = _COLOUR.sub(lambda match: f"var(--c-{match[0][1:]})", text)
    text = _LONG_NUMBER.sub(r"\1", text)
    return text.replace("<svg ", f'<svg role="img" aria-label="{html.text(title)}" ', 1).strip()


def colour_rules(drawings: Iterable[str]) -> str:
    """Define the colours of drawings, for a light and for a dark scheme.

    Parameters
    ----------
    drawings : iterable of str
        From `drawing`.

    Returns
    -------
    str
        Rules of a style sheet; on paper the light ones hold.
    """
    used = sorted({colour for text in drawings for colour in _OWN_COLOUR.findall(text)} | {"000000"})
    light = "; ".join(f"--c-{colour}: #{colour}" for colour in used)
    dark = "; ".join(f"--c-{colour}: {_on_dark(f'#{colour}')}" for colour in used)
    return f":root {{ {light} }}\n@media screen and (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n"


def _on_dark(colour: str) -> str:
    """Turn a colour for a light ground into one for a dark ground: greys between ink and ground change sides."""
    red, green, blue = (int(colour[start : start + 2], 16) for start in (1, 3, 5))
    if not red == green == blue:
        return _ON_DARK.get(colour, colour)
    share = red / 255
    mixed = (
        round((1 - share) * ink + share * ground)
        for ink, ground in zip(_INK_ON_DARK, _DARK_GROUND, strict=True)
    )
    return "#" + "".join(f"{part:02x}" for part in mixed)
