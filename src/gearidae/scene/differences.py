"""The first key in which two scenes differ."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final

MAY_CHANGE: Final = ("name", "drive", "load", "coating", "initial", "run")
"""What may differ between a run and the one that it goes on from, whose end is its start."""


def first_difference(
    one: Mapping[str, Any], other: Mapping[str, Any], ignored: Iterable[str] = ()
) -> tuple[str, Any, Any] | None:
    """Name the first key in which two scenes differ.

    Parameters
    ----------
    one, other : mapping
        As `Scene.to_dict` gives them, or an archive holds them.
    ignored : iterable of str, optional
        Dotted keys, or names of tables, in which they may differ.

    Returns
    -------
    key : str
        Dotted, with the numbers of list entries.
    value, other_value : object
        What both hold there; None where one lacks it. The whole is None if there is no difference.
    """
    allowed = [_plain(key) for key in ignored]
    for key, mine, theirs in _differences(one, other, ""):
        plain = _plain(key)
        if not any(plain == each or plain.startswith(f"{each}.") for each in allowed):
            return key, mine, theirs
    return None


def _plain(key: str) -> str:
    """Leave out the numbers of list entries."""
    return ".".join(part for part in key.split(".") if not part.isdecimal())


def _differences(one: Any, other: Any, key: str) -> Iterator[tuple[str, Any, Any]]:
    if isinstance(one, dict) and isinstance(other, dict):
        for name in sorted({*one, *other}):
            yield from _differences(one.get(name), other.get(name), f"{key}.{name}".lstrip("."))
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        for number, (mine, theirs) in enumerate(zip(one, other, strict=True)):
            yield from _differences(mine, theirs, f"{key}.{number}")
    elif one != other:
        yield key, one, other
