"""One row of what ``gearidae check`` prints."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple


class Fact(NamedTuple):
    """A row of the table: for people a text with a remark, for programs a number [SI].

    Attributes
    ----------
    name, text, remark : str
        A row without a text is a heading.
    number : float or tuple of float, optional
        What the text says; several numbers where it says several, none where it is not known or no number.
    unit : str, optional
        Of the number.
    """

    name: str
    text: str = ""
    remark: str = ""
    number: float | tuple[float, ...] | None = None
    unit: str = ""


Facts = Iterator[Fact]
