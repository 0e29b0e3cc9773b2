"""TOML as it stands in a case file, on a command line or in a cell of a table."""

from __future__ import annotations

import re
import tomllib
from typing import Any, Final

_MOST_PARTS: Final = 32
# The part before each dot of a key, bare or quoted; it begins where no other does, so that the search stays linear.
_PART: Final = r"""(?:(?<![\w-])[\w-]+|"[^"\n]*"|'[^'\n]*')\s*\.\s*"""
_LONG_KEY: Final = re.compile(f"(?:{_PART}){{{_MOST_PARTS}}}")


def read_toml(text: str) -> dict[str, Any]:
    """Read TOML.

    Raises
    ------
    ValueError
        If it is none, or nested too deeply, or a key has so many parts that it would take long to read: `tomllib`
        takes a time that grows with their square.
    """
    if _LONG_KEY.search(text):
        raise ValueError(f"a key of more than {_MOST_PARTS} parts")
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def literal(text: str) -> Any:
    """Read a value as TOML would; what TOML does not know is a text, such as a number with a unit.

    Returns
    -------
    object
        A number, a truth value (also as spreadsheets write it, ``TRUE``), a list, a table or a text.
    """
    text = text.lower() if text.strip().lower() in ("true", "false") else text
    try:
        return read_toml(f"value = {text}")["value"] if "\n" not in text else text
    except ValueError:  # also of integers of thousands of digits
        return text
