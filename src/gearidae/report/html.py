"""Pieces of HTML; every text that comes from outside is escaped here and nowhere else."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearidae.printable import printable


def text(value: object) -> str:
    """Escape a value for use between tags or in a quoted attribute."""
    return escape(printable(str(value)), quote=True)


def paragraph(words: object, css: str = "") -> str:
    """Write one paragraph."""
    return f"<p{_class(css)}>{text(words)}</p>"


def section(anchor: str, title: str, *content: str) -> str:
    """Write a section with its heading; one without content vanishes."""
    body = "\n".join(part for part in content if part)
    if not body:
        return ""
    heading = f'<h2 id="{text(anchor)}-title">{text(title)}</h2>'
    return (
        f'<section id="{text(anchor)}" aria-labelledby="{text(anchor)}-title">\n{heading}\n{body}\n</section>'
    )


def table(
    headings: Sequence[str],
    rows: Iterable[Sequence[object]],
    *,
    caption: str = "",
    numeric: Sequence[int] = (),
) -> str:
    """Write a table that scrolls sideways where it is too wide.

    Parameters
    ----------
    rows : iterable of sequence
        Cells as they shall read.
    numeric : sequence of int, optional
        Columns to set to the right.
    """
    heads = "".join(
        f'<th scope="col"{_class("number" if column in numeric else "")}>{text(name)}</th>'
        for column, name in enumerate(headings)
    )
    lines = []
    for row in rows:
        cells = "".join(
            f"<td{_class('number' if column in numeric else '')}>{text(cell)}</td>"
            for column, cell in enumerate(row)
        )
        lines.append(f"<tr>{cells}</tr>")
    title = f"<caption>{text(caption)}</caption>" if caption else ""
    body = "\n".join(lines)
    # A focusable region, so that a wide table can be scrolled from the keyboard.
    return (
        f'<div class="wide" role="region" tabindex="0" aria-label="{text(caption or "table")}"><table>{title}'
        f"<thead><tr>{heads}</tr></thead>\n<tbody>\n{body}\n</tbody></table></div>"
    )


def folded(summary: str, content: str) -> str:
    """Write something long that is shown on demand."""
    return f"<details><summary>{text(summary)}</summary>\n{content}\n</details>"


def definitions(pairs: Iterable[tuple[str, object]]) -> str:
    """Write names and their values as a list."""
    items = "".join(f"<div><dt>{text(name)}</dt><dd>{text(value)}</dd></div>\n" for name, value in pairs)
    return f"<dl>\n{items}</dl>"


def json_block(identity: str, data: Any) -> str:
    """Embed data for a script; no text in it can end the element that holds it."""
    content = json.dumps(data, allow_nan=False, separators=(",", ":"))
    for char, escaped in (("<", "\\u003c"), (">", "\\u003e"), ("&", "\\u0026")):
        content = content.replace(char, escaped)
    return f'<script type="application/json" id="{text(identity)}">{content}</script>'


def numbers(values: NDArray[Any]) -> str:
    """Write numbers of any shape as base64 text of little-endian float32 numbers, row by row."""
    return base64.b64encode(np.asarray(values).astype("<f4").tobytes()).decode("ascii")


def _class(css: str) -> str:
    return f' class="{text(css)}"' if css else ""
