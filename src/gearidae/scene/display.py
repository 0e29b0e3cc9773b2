"""How things show themselves: in a line, or as a table in a notebook. Who knows how registers it here."""

from __future__ import annotations

from functools import singledispatch


@singledispatch
def as_line(thing: object) -> str:
    """Write what something is in one line."""
    return f"<{type(thing).__name__}>"


@singledispatch
def as_html(thing: object) -> str:
    """Write what something is as HTML, for a notebook."""
    return f"<p>{type(thing).__name__}</p>"
