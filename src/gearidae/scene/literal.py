"""A value as it stands on a command line or in a cell of a table."""

from __future__ import annotations

import tomllib
from typing import Any

__all__ = ["literal"]


def literal(text: str) -> Any:
    """Read a value as TOML would; what TOML does not know is a text, such as a number with a unit.

    Parameters
    ----------
    text : str

    Returns
    -------
    object
        A number, a truth value, a list, a table or a text.
    """
    try:
        return tomllib.loads(f"value = {text}")["value"] if "\n" not in text else text
    except tomllib.TOMLDecodeError:
        return text
